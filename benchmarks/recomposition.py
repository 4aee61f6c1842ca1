"""Shading a picture of a megapixel again, beside plain NumPy and reading what is read; and what edits take."""

from dataclasses import fields

import numpy as np
from numpy.typing import NDArray

from benchmarks.measure import Comparison, compare
from processing.paraboloid.maps import texel_directions
from processing.reference.recompose import recompose as in_numpy
from processing.shape.editing.edit import edit
from processing.shape.editing.operations import Noise, Recipe, Smooth
from processing.shape.model import Environments, ShadingBuffers, SurfaceEnvironment
from processing.shape.recompose import Recomposer

F32 = NDArray[np.float32]
SIDE, MAP = 1000, 512
GOAL = "≤ 70 ms"


def comparisons() -> list[Comparison]:
    """Compare with every normal changed, and with one in ten."""
    buffers, light = _buffers(), _light()
    changed = edit(buffers, Recipe(steps=(Noise(height=2, scale=30),))).normals
    some = np.where((np.arange(SIDE) < SIDE // 10)[:, None, None], changed, buffers.normals)
    recomposer = Recomposer(buffers, light)
    _check(buffers, light, changed, recomposer)
    planes = [plane for one in fields(buffers) if isinstance(plane := getattr(buffers, one.name), np.ndarray)]

    def copy() -> None:
        for plane in (*planes, changed, buffers.picture):
            plane.copy()

    what = "Recomposition of 1 MP"
    ours = (f"every normal changed, environments of 2 × {MAP}²", lambda: recomposer.picture(changed))
    smooth, noise = Recipe(steps=(Smooth(radius=3),)), Recipe(steps=(Noise(height=2, scale=30),))
    return [
        compare(what, ours, ("the same in NumPy, double", lambda: in_numpy(buffers, light, changed)), goal=GOAL),
        compare(what, ours, ("copying all buffers", copy), goal=GOAL),
        compare(what, ("one normal in ten changed", lambda: recomposer.picture(some)), ("copying all buffers", copy)),
        compare(
            "From buffers to the picture, 1 MP",
            ("opened, then shaded once", lambda: Recomposer(buffers, light).picture(changed)),
            ("shaded once more", ours[1]),
        ),
        compare(
            "Edits of 1 MP",
            ("noise of three octaves", lambda: edit(buffers, noise)),
            ("recomposition", ours[1]),
            rounds=3,
        ),
        compare(
            "Edits of 1 MP",
            ("smoothing, radius 3", lambda: edit(buffers, smooth)),
            ("recomposition", ours[1]),
            rounds=3,
        ),
    ]


def _buffers() -> ShadingBuffers:
    """A wavy surface of two materials that fills the picture, seen in perspective."""
    random = np.random.default_rng(6)
    rows, columns = np.indices((SIDE, SIDE)).astype(np.float32)
    slopes = np.stack(np.broadcast_arrays(0.9 * np.sin(columns / 70 + 1), 0.9 * np.cos(rows / 55), np.float32(1)), -1)
    normals = slopes / np.linalg.norm(slopes, axis=-1, keepdims=True)
    positions = np.stack([columns / SIDE - 0.5, 0.5 - rows / SIDE, np.full_like(rows, -2)], axis=-1)
    diffuse, reflection = (random.uniform(0, 1, normals.shape).astype(np.float32) for _ in range(2))
    open_d, open_r = (random.uniform(0, 1, rows.shape).astype(np.float32) for _ in range(2))
    return ShadingBuffers(
        picture=diffuse + reflection,
        coverage=np.ones_like(rows),
        diffuse=diffuse,
        reflection=reflection,
        normals=normals.astype(np.float32),
        positions=positions.astype(np.float32),
        surfaces=np.where(columns < SIDE / 2, 1, 2).astype(np.uint32),
        ambient_occlusion=open_d,
        reflection_occlusion=open_r,
    )


def _light() -> Environments:
    random = np.random.default_rng(7)
    front, back = (np.sin(9 * d).astype(np.float32) + 1 for d in texel_directions(MAP))
    return {number: SurfaceEnvironment(random.normal(size=(9, 3)).astype(np.float32), front, back) for number in (1, 2)}


def _check(buffers: ShadingBuffers, light: Environments, changed: F32, recomposer: Recomposer) -> None:
    if not np.array_equal(recomposer.picture(buffers.normals), buffers.picture):
        raise AssertionError("untouched pixels do not keep their bits")
    apart = np.abs(recomposer.picture(changed) - in_numpy(buffers, light, changed)).max()
    if not apart < 1e-3 or not np.any(recomposer.picture(changed) != buffers.picture):
        raise AssertionError(f"{apart:g} from the reference, or nothing changed")
