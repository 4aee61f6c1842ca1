"""Building materials, beside merely decoding the pictures and beside the plain NumPy way."""

import math
from pathlib import Path

import numpy as np
import simplejpeg
from numpy.typing import NDArray

from benchmarks.measure import Comparison, compare
from litrig.base.capture_folder.capture import Capture, CapturedFrame
from litrig.base.directions import direction_from_angles
from litrig.base.pictures import read_codes
from processing.amc.build import build
from processing.amc.circle import Circle
from processing.ptm.fit import fit
from processing.ptm.relight import relight
from processing.stack import Stack

F64 = NDArray[np.float64]
LIGHTS = 50
SLICES = 128


def comparisons(folder: Path) -> list[Comparison]:
    """Compare fit and build."""
    return [*_ptm(folder / "ptm"), _amc(folder / "amc")]


def _ptm(folder: Path) -> list[Comparison]:
    folder.mkdir()
    lights = np.array([direction_from_angles(137.5 * i, 20 + 60 * i / LIGHTS) for i in range(LIGHTS)])
    paths = [_relief(folder / f"{i:03d}.jpg", light) for i, light in enumerate(lights)]
    stack = Stack(paths)
    ours, plain = fit(stack, lights), _lstsq(paths, lights)
    light = np.array([0.3, 0.4, math.sqrt(0.75)])
    design = np.array([light[0] ** 2, light[1] ** 2, light[0] * light[1], light[0], light[1], 1.0])
    np.testing.assert_allclose(relight(ours, light).mean(-1), np.tensordot(design, plain, 1).mean(-1), atol=0.02)
    what = f"PTM fit, LRGB, {LIGHTS} JPEGs of 1 MP"
    return [
        compare(
            what,
            ("fit", lambda: fit(stack, lights)),
            ("decoding alone", lambda: [read_codes(p) for p in paths]),
            rounds=5,
        ),
        compare(
            what,
            ("fit", lambda: fit(stack, lights)),
            ("numpy.linalg.lstsq on the whole stack", lambda: _lstsq(paths, lights)),
            rounds=3,
        ),
    ]


def _amc(folder: Path) -> Comparison:
    folder.mkdir()
    angles = [360 * s / SLICES for s in range(SLICES)]
    frames = tuple(
        CapturedFrame(_sphere(folder / f"{s:03d}.jpg", angle), angle_deg=angle) for s, angle in enumerate(angles)
    )
    capture = Capture(folder, "sphere", frames)
    circle = Circle(320.0, 240.0, 180.0)
    if build(capture, circle=circle).amc.invariance != 2:
        raise AssertionError("the streak repeats at half a turn")
    return compare(
        f"AMC build, {SLICES} JPEGs of 640 × 480 to 128² × 64",
        ("build", lambda: build(capture, circle=circle)),
        ("decoding alone", lambda: [read_codes(frame.path) for frame in frames]),
        rounds=5,
    )


def _lstsq(paths: list[Path], lights: F64) -> F64:
    stack = np.stack([read_codes(path) for path in paths]).astype(np.float64) / 255
    u, v = lights[:, 0], lights[:, 1]
    design = np.stack([u * u, v * v, u * v, u, v, np.ones_like(u)], 1)
    coefficients, *_ = np.linalg.lstsq(design, stack.reshape(len(paths), -1), rcond=None)
    return np.asarray(coefficients.reshape(6, *stack.shape[1:]), np.float64)


def _relief(path: Path, light: F64) -> Path:
    y, x = np.mgrid[0:864, 0:1152] / 40.0
    slope = np.stack([np.cos(x) * 0.4, np.sin(y + x) * 0.3, np.ones_like(x)], -1)
    normals = slope / np.linalg.norm(slope, axis=-1, keepdims=True)
    shade = np.clip(normals @ light, 0, 1)[..., None] * np.array([0.9, 0.7, 0.5])
    path.write_bytes(simplejpeg.encode_jpeg((shade * 255).astype(np.uint8), 92))
    return path


def _sphere(path: Path, angle_deg: float) -> Path:
    y, x = np.mgrid[0:480, 0:640] + 0.5
    across, up = (x - 320) / 180, (240 - y) / 180
    inside = across**2 + up**2 < 1
    turn = np.radians(angle_deg)
    streak = np.exp(-(((across - 0.2) * np.cos(turn) + (up - 0.1) * np.sin(turn)) ** 2) / 0.02)
    light = np.where(inside, 0.15 + 0.7 * streak, 0.02)
    path.write_bytes(simplejpeg.encode_jpeg(np.repeat((light * 255).astype(np.uint8)[..., None], 3, -1), 92))
    return path
