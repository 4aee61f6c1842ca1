"""One picture that shows how well environments were reconstructed (the Shape paper, figures 2, 5 and 8)."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.contact_sheet import BACKGROUND, contact_sheet
from litrig.base.radiometry import encode_srgb, to_u8
from processing.paraboloid.read import lookup
from processing.shape import harmonics
from processing.shape.lit_sphere import ball_normals, lit_sphere
from processing.shape.model import ShadingBuffers, SurfaceEnvironment
from processing.shape.reconstruct import Reconstruction, sound_pixels

F32 = NDArray[np.float32]
U8 = NDArray[np.uint8]
COLUMNS = 6
CELL_PX = 240
_UNKNOWN = np.array([230, 0, 0], np.uint8)
_FULL = 0.25
"""Of the brightest shading: a residual whose colour is pure."""
_WHITE_PERCENTILE = 99.5


def reconstruction_sheet(buffers: ShadingBuffers, found: Reconstruction) -> U8:
    """Draw a row for each surface.

    From left to right: the diffuse shading scattered over the Gauss map; the diffuse environment on a ball; what it
    leaves of the shading, blue where the shading is darker and red where it is brighter; the reflections that are seen,
    on a ball, red where nothing is; the reflection environment; both environments together.

    Returns
    -------
    sheet : (h, w, 3) uint8 RGB
    """
    cells: list[U8] = []
    for number, environment in found.environments.items():
        here = (buffers.surfaces == number) & sound_pixels(buffers)
        reflected, ball = lit_sphere(environment, CELL_PX, "reflection")
        cells += [
            gauss_map(buffers.normals[here], buffers.diffuse[here]),
            _shown(lit_sphere(environment, CELL_PX, "diffuse")[0], ball),
            residual_picture(buffers, environment, here),
            np.where((ball & ~_seen_on_ball(found.known[number]))[..., None], _UNKNOWN, _shown(reflected, ball)),
            _shown(reflected, ball),
            _shown(lit_sphere(environment, CELL_PX)[0], ball),
        ]
    return contact_sheet(cells, COLUMNS, CELL_PX)


def gauss_map(normals: F32, shading: F32) -> U8:
    """Scatter shading (N, 3) over the normals (N, 3) that look to the viewer; what meets is averaged.

    The fewer pixels, the larger their dots.
    """
    good = normals[:, 2] >= 0
    dot = int(np.clip(CELL_PX / (0.8 * np.sqrt(max(good.sum(), 1))), 1, CELL_PX / 24))
    size = CELL_PX // dot
    column, row = (
        np.clip(((1 + side) / 2 * size).astype(np.int64), 0, size - 1) for side in (normals[good, 0], -normals[good, 1])
    )
    sums, counts = np.zeros((size, size, 3)), np.zeros((size, size, 1))
    np.add.at(sums, (row, column), shading[good])
    np.add.at(counts, (row, column), 1)
    shown = _shown((sums / np.maximum(counts, 1)).astype(np.float32), counts[..., 0] > 0)
    return shown.repeat(dot, axis=0).repeat(dot, axis=1)


def residual_picture(buffers: ShadingBuffers, environment: SurfaceEnvironment, here: NDArray[np.bool_]) -> U8:
    """Colour what the diffuse environment leaves of the shading, the mean of the channels, in the surface's window."""
    fitted = harmonics.evaluate(buffers.normals[here]) @ environment.diffuse
    if environment.diffuse_is_illumination and buffers.albedo is not None:
        fitted = fitted * buffers.albedo[here]
    shading = buffers.diffuse[here]
    largest = float(np.max(np.abs(shading))) or 1.0
    strength = np.zeros(here.shape)
    strength[here] = np.clip(np.mean(shading - fitted, axis=1) / (_FULL * largest), -1, 1)
    away = np.abs(strength)[..., None]
    colour = np.where(strength[..., None] < 0, [0.1, 0.25, 0.8], [0.85, 0.1, 0.1])
    picture = np.where(here[..., None], 1 - away * (1 - colour), np.array(BACKGROUND) / 255)
    rows, columns = np.flatnonzero(here.any(axis=1)), np.flatnonzero(here.any(axis=0))
    window = to_u8(picture[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1])
    side = max(window.shape[:2])
    square = np.full((side, side, 3), BACKGROUND, np.uint8)
    top, left = (side - window.shape[0]) // 2, (side - window.shape[1]) // 2
    square[top : top + window.shape[0], left : left + window.shape[1]] = window
    dot = max(1, CELL_PX // side)
    return square.repeat(dot, axis=0).repeat(dot, axis=1)


def _seen_on_ball(known: NDArray[np.bool_]) -> NDArray[np.bool_]:
    normals, _ = ball_normals(CELL_PX)
    mirrored = 2 * normals[..., 2:] * normals - np.array([0.0, 0.0, 1.0])
    length = np.linalg.norm(mirrored, axis=-1, keepdims=True)
    front, back = known.astype(np.float32)[..., None]
    shares = lookup(front, back, mirrored / np.where(length > 0, length, 1))
    # Corners beyond the circle count as unknown, and must not draw the seam.
    return shares[..., 0] > 0


def _shown(linear: F32, here: NDArray[np.bool_]) -> U8:
    """Encode for display, brighter than white brought down to it, on the sheet's background."""
    white = max(1.0, float(np.percentile(linear[here], _WHITE_PERCENTILE))) if here.any() else 1.0
    return np.where(here[..., None], to_u8(encode_srgb(linear / white)), np.array(BACKGROUND, np.uint8))
