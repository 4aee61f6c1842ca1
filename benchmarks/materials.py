"""Three materials to synthesise from: a relief, a fabric and grains, lit by the simulator and fitted like any capture.

Heights and colours are made by formulas; light, gloss and cast shadows are those of the simulated coin
(`firmware_sim.scene.relief`), which shares no code with the fit.
"""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from firmware_sim.scene.relief import shade
from litrig.base.directions import direction_from_angles
from litrig.base.lights import Lights
from litrig.base.lp import write_lp
from litrig.base.pictures import write_picture
from processing.ptm.fit import FitSettings, start_fit
from processing.ptm.model import Colour, Ptm
from processing.stack import Stack

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
LIGHTS = 50
EXPOSURE = 0.8


class Sample(NamedTuple):
    """Heights in pixels (H, W) and linear albedo (H, W, 3)."""

    heights: F32
    albedo: F32


def relief(side_px: int, seed: int = 0) -> Sample:
    """Stamped leather: cells with rounded backs between creases, and pores."""
    random = np.random.default_rng(seed)
    points = _scattered(random, side_px, 11.0)
    nearest, second = _two_nearest(points, side_px)
    crease = np.clip((second - nearest) / 7, 0, 1)
    heights = 3.4 * np.sqrt(crease) + 0.5 * _noise(random, side_px, 1.2) + 0.8 * _noise(random, side_px, 6)
    brown = (
        np.array([0.36, 0.17, 0.08])
        * (0.55 + 0.45 * crease[..., None])
        * (1 + 0.1 * _noise(random, side_px, 9))[..., None]
    )
    return Sample(heights.astype(np.float32), np.clip(brown, 0.01, 1).astype(np.float32))


def fabric(side_px: int, seed: int = 0) -> Sample:
    """Plain weave of two threads of uneven thickness."""
    random = np.random.default_rng(seed)
    y, x = np.mgrid[:side_px, :side_px].astype(np.float64)
    x, y = x + 1.3 * _noise(random, side_px, 14), y + 1.3 * _noise(random, side_px, 14)
    period = 12.0
    across, along = np.cos(2 * np.pi * x / period), np.cos(2 * np.pi * y / period)
    over = np.sin(np.pi * x / period) * np.sin(np.pi * y / period)
    warp = 1.6 * np.sqrt(np.abs(np.sin(np.pi * x / period))) + 1.5 * np.sign(over) * np.abs(over) ** 0.7
    weft = 1.6 * np.sqrt(np.abs(np.sin(np.pi * y / period))) - 1.5 * np.sign(over) * np.abs(over) ** 0.7
    heights = np.maximum(warp, weft) + 0.15 * (across + along) + 0.22 * _noise(random, side_px, 0.9)
    is_warp = (warp > weft)[..., None]
    colour = (
        np.where(is_warp, [0.13, 0.24, 0.44], [0.55, 0.52, 0.46]) * (1 + 0.12 * _noise(random, side_px, 2))[..., None]
    )
    return Sample(
        cv2.GaussianBlur(heights, (0, 0), 0.7).astype(np.float32), np.clip(colour, 0.01, 1).astype(np.float32)
    )


def grains(side_px: int, seed: int = 0) -> Sample:
    """Peas in two layers, each of its own colour."""
    random = np.random.default_rng(seed)
    heights, albedo = np.full((side_px, side_px), -4.0), np.full((side_px, side_px, 3), 0.03)
    for spacing, ground in ((12.0, -4.0), (13.0, 0.0)):
        points = _scattered(random, side_px, spacing)
        radii = random.uniform(5.6, 7.4, len(points))
        hues = np.array([0.52, 0.40, 0.17]) * random.uniform(0.65, 1.25, (len(points), 1)) + random.normal(
            0, 0.02, (len(points), 3)
        )
        y, x = np.mgrid[:side_px, :side_px]
        distance, index = cKDTree(points).query(np.stack([y, x], axis=-1))
        cap = radii[index] ** 2 - distance**2
        height = ground + np.sqrt(np.maximum(cap, 0))
        above = (cap > 0) & (height > heights)
        heights = np.where(above, height, heights)
        albedo = np.where(above[..., None], hues[index], albedo)
    heights += 0.12 * _noise(random, side_px, 0.9)
    return Sample(heights.astype(np.float32), np.clip(albedo, 0.01, 1).astype(np.float32))


SAMPLES: dict[str, Callable[[int, int], Sample]] = {"relief": relief, "fabric": fabric, "grains": grains}


def capture(sample: Sample, folder: Path) -> Path:
    """Write what a camera above would see under many lamps: a plain folder of linear EXR pictures with its .lp."""
    folder.mkdir(parents=True, exist_ok=True)
    angles = [(137.508 * i % 360, 25 + 60 * i / LIGHTS) for i in range(LIGHTS)]
    names = tuple(f"light_{index:03d}.exr" for index in range(LIGHTS))
    for name, (azimuth_deg, elevation_deg) in zip(names, angles, strict=True):
        write_picture(folder / name, EXPOSURE * shade(sample.heights, sample.albedo, azimuth_deg, elevation_deg))
    write_lp(folder / "lights.lp", Lights(names, np.array([direction_from_angles(*each) for each in angles])))
    return folder


def fitted(name: str, side_px: int, folder: Path, colour: Colour = "lrgb", seed: int = 0) -> Ptm:
    """Capture one of the materials and fit a PTM to it, as `litrig ptm fit` does."""
    place = capture(SAMPLES[name](side_px, seed), folder / f"{name}-{side_px}-{seed}")
    pictures = sorted(place.glob("*.exr"))
    directions = np.array([direction_from_angles(137.508 * i % 360, 25 + 60 * i / LIGHTS) for i in range(LIGHTS)])
    material = start_fit(Stack(pictures), directions, FitSettings(colour=colour), source=f"{name} {side_px} {seed}")
    strip = material.strip(slice(0, side_px))
    return Ptm(strip.coefficients, strip.colour, material.space, material.source, material.basis)


def _scattered(random: np.random.Generator, side_px: int, spacing_px: float) -> F64:
    """Scatter points (N, 2) on a jittered grid of triangles, some way over the ends."""
    count = int(side_px / spacing_px) + 4
    i, j = np.mgrid[-2:count, -2:count].astype(np.float64)
    points = np.stack([i * spacing_px * 0.87, (j + 0.5 * (i % 2)) * spacing_px], axis=-1).reshape(-1, 2)
    return np.asarray(points + random.normal(0, 0.22 * spacing_px, points.shape), np.float64)


def _two_nearest(points: F64, side_px: int) -> tuple[F64, F64]:
    y, x = np.mgrid[:side_px, :side_px]
    distances, _ = cKDTree(points).query(np.stack([y, x], axis=-1), k=2)
    return distances[..., 0], distances[..., 1]


def _noise(random: np.random.Generator, side_px: int, blur_px: float) -> F64:
    noise = cv2.GaussianBlur(random.standard_normal((side_px, side_px)), (0, 0), blur_px, borderType=cv2.BORDER_REFLECT)
    return np.asarray(noise / noise.std(), np.float64)
