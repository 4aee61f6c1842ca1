"""Building materials, beside merely decoding the pictures and beside the plain NumPy way."""

import math
from dataclasses import replace
from pathlib import Path
from unittest import mock

import numpy as np
import simplejpeg
from numpy.typing import NDArray

from benchmarks.measure import Comparison, compare
from litrig.base.capture_folder.capture import Capture, CapturedFrame
from litrig.base.directions import direction_from_angles
from litrig.base.pictures import read_codes
from processing.amc.build import build
from processing.amc.outline.circle import Circle
from processing.amc.outline.orbit import find_outline
from processing.amc.settings import Settings
from processing.ptm.fit import fit
from processing.ptm.relight import relight
from processing.stack import Stack

F64 = NDArray[np.float64]
LIGHTS = 50
SLICES = 128


def comparisons(folder: Path) -> list[Comparison]:
    """Compare fit and build."""
    return [*_ptm(folder / "ptm"), *_amc(folder / "amc")]


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


def _amc(folder: Path) -> list[Comparison]:
    capture = turn_of(folder, SLICES, (480, 640))
    circle = Circle(320.0, 240.0, 180.0)
    plain = Settings(circle=circle, depth=SLICES, defects="ignore")
    near = replace(plain, distance_radii=8.0)
    if build(capture, plain).amc.invariance != 2:
        raise AssertionError("the streak repeats at half a turn")
    paths = [frame.path for frame in capture.frames]
    decoded = {path: read_codes(path) for path in paths}

    def compute(settings: Settings) -> None:
        with mock.patch("processing.stack.read_codes", decoded.__getitem__):
            build(capture, settings)

    def decode() -> None:
        for path in paths:
            read_codes(path)

    angles_rad = np.radians([frame.angle_deg or 0.0 for frame in capture.frames])
    what = f"AMC, {SLICES} JPEGs of 640 × 480 to 128³"
    beside = ("decoding alone", decode)
    goal = "≤ 0.25 s"
    return [
        compare(what, ("compute, orthographic", lambda: compute(plain)), beside, rounds=9, goal=goal),
        compare(what, ("compute, in perspective", lambda: compute(near)), beside, rounds=9, goal=goal),
        compare(what, ("all of the build, decoding too", lambda: build(capture, plain)), beside, rounds=9),
        compare(
            what,
            ("the same with flaws looked for", lambda: build(capture, replace(plain, defects="find"))),
            beside,
            rounds=5,
        ),
        compare(what, ("finding the sphere", lambda: find_outline(Stack(paths), angles_rad)), beside, rounds=5),
    ]


def turn_of(folder: Path, slices: int, shape: tuple[int, int]) -> Capture:
    """Write a turn of a sphere with a streak that repeats at half a turn."""
    folder.mkdir()
    angles = [360 * s / slices for s in range(slices)]
    frames = (
        CapturedFrame(_sphere(folder / f"{s:03d}.jpg", angle, shape), angle_deg=angle) for s, angle in enumerate(angles)
    )
    return Capture(folder, "sphere", tuple(frames))


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


def _sphere(path: Path, angle_deg: float, shape: tuple[int, int]) -> Path:
    height, width = shape
    y, x = np.mgrid[0:height, 0:width] + 0.5
    radius = 0.375 * height
    across, up = (x - width / 2) / radius, (height / 2 - y) / radius
    inside = across**2 + up**2 < 1
    turn = np.radians(angle_deg)
    streak = np.exp(-(((across - 0.2) * np.cos(turn) + (up - 0.1) * np.sin(turn)) ** 2) / 0.02)
    light = np.where(inside, 0.15 + 0.7 * streak, 0.02)
    path.write_bytes(simplejpeg.encode_jpeg(np.repeat((light * 255).astype(np.uint8)[..., None], 3, -1), 92))
    return path
