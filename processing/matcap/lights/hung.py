"""Pictures that hang in the light, as maps of all directions."""

import numpy as np
from numpy.typing import NDArray

from processing.matcap.lights.footprints import unit
from processing.matcap.lights.model import Direction, Hung
from processing.paraboloid.blur import blurred
from processing.paraboloid.maps import texel_directions

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
_FINER = 3


def hung_maps(hung: Hung, size: int, variance: float) -> tuple[F32, F32]:
    """Return a picture's light as front and back maps (size, size, 3), blurred by a material's filter.

    Each texel is the mean of some places in it; angles from the picture's middle are laid out straight (the azimuthal
    equidistant projection).
    """
    front, back = (_mean(_seen(hung, side)) for side in texel_directions(size * _FINER))
    return blurred(front, back, variance)


def frame_at(direction: Direction) -> tuple[F64, F64, F64]:
    """Return unit vectors right, up and outwards at a direction, as it is seen on the ball; up is towards y."""
    outwards = unit(direction)
    reference = np.array([0.0, 1.0, 0.0]) if abs(outwards[1]) < 1 - 1e-9 else np.array([0.0, 0.0, -outwards[1]])
    up = reference - outwards * (reference @ outwards)
    up /= np.linalg.norm(up)
    return np.asarray(np.cross(up, outwards)), up, outwards


def _seen(hung: Hung, directions: F64) -> F64:
    """Read the picture in unit directions (S, S, 3): light times coverage, black beside it."""
    picture, texels = hung.picture, hung.texels
    right, up, outwards = frame_at(picture.direction)
    x, y, z = (directions @ axis for axis in (right, up, outwards))
    across = np.hypot(x, y)
    stretch = np.arctan2(across, z) / np.maximum(across, 1e-12)
    a, b = x * stretch, y * stretch
    turn = np.radians(picture.turn_deg)
    a, b = a * np.cos(turn) + b * np.sin(turn), b * np.cos(turn) - a * np.sin(turn)
    height, width = texels.shape[:2]
    texel = np.radians(picture.size_deg) / width
    columns, rows = a / texel + width / 2 - 0.5, height / 2 - 0.5 - b / texel
    light = (texels[..., :3] * texels[..., 3:]).astype(np.float64)
    seen = _bilinear(np.pad(light, ((1, 1), (1, 1), (0, 0))), columns + 1, rows + 1)
    return np.asarray(seen * np.asarray(picture.colour))


def _bilinear(texels: F64, columns: F64, rows: F64) -> F64:
    height, width = texels.shape[:2]
    x, y = np.clip(columns, 0, width - 1), np.clip(rows, 0, height - 1)
    left, top = np.minimum(x.astype(int), width - 2), np.minimum(y.astype(int), height - 2)
    along, down = (x - left)[..., None], (y - top)[..., None]
    above = texels[top, left] * (1 - along) + texels[top, left + 1] * along
    below = texels[top + 1, left] * (1 - along) + texels[top + 1, left + 1] * along
    return np.asarray(above * (1 - down) + below * down)


def _mean(fine: F64) -> F32:
    size = fine.shape[0] // _FINER
    return np.asarray(fine.reshape(size, _FINER, size, _FINER, -1).mean(axis=(1, 3)), np.float32)
