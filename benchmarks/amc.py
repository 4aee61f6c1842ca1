"""Building an AMC, beside merely decoding the pictures."""

from dataclasses import replace
from pathlib import Path
from unittest import mock

import numpy as np
import simplejpeg

from benchmarks.measure import Comparison, compare
from litrig.base.capture_folder.capture import Capture, CapturedFrame
from litrig.base.pictures import read_codes
from processing.amc.build import build
from processing.amc.settings import Settings
from processing.outline.circle import Circle
from processing.outline.orbit import find_outline
from processing.stack import Stack

SLICES = 128


def comparisons(folder: Path) -> list[Comparison]:
    """Compare the build."""
    folder = folder / "amc"
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
