"""Pictures of discs to take apart."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.radiometry import decode_srgb_codes, encode_srgb, to_u8
from processing.matcap.disc import disc_normals

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]


def lambert(size: int, light: tuple[float, float, float], colour: tuple[float, float, float] = (0.9, 0.5, 0.2)) -> F64:
    """A matt ball under one distant light; black on its night side and around it."""
    normals, inside = disc_normals(size)
    shaded: F64 = np.maximum(normals @ np.array(light), 0)[..., None] * np.array(colour) * inside[..., None]
    return shaded


def glossy(size: int) -> F64:
    """A matt ball with a highlight and some light from all sides."""
    normals, inside = disc_normals(size)
    towards = np.array([-0.3, 0.2, 0.93]) / np.linalg.norm([-0.3, 0.2, 0.93])
    shine = np.exp(40 * (normals @ towards - 1))[..., None] * np.array([0.6, 0.6, 0.5])
    shaded: F64 = (0.5 * lambert(size, (0.3, 0.5, 0.8)) + shine + 0.03) * inside[..., None]
    return shaded


def noise(size: int, seed: int) -> F64:
    """Noise of many kinds by seed: with black pixels, flat regions, and steps."""
    draw = np.random.default_rng(seed)
    picture = draw.random((size, size, 3)) ** draw.integers(1, 4)
    if seed % 4 == 1:
        picture[draw.random((size, size)) < 0.02] = 0
    if seed % 4 == 2:
        picture[size // 3 :, : size // 2] = 0.25
    if seed % 4 == 3:
        picture = glossy(size) + 0.02 * np.round(4 * picture)
        picture[: size // 8] = 0
    return picture


def hard_edged(size: int) -> F32:
    """What an artist might paint, of 8 bits: patches and bands with hard edges, black and white next to each other."""
    draw = np.random.default_rng(1)
    _, inside = disc_normals(size)
    picture = 0.4 * lambert(size, (0.3, 0.5, 0.8)) + 0.02
    rows, columns = np.mgrid[:size, :size] / size
    for _ in range(12):
        across, down, width, height = draw.random(4)
        picture[(np.abs(columns - across) < 0.15 * width) & (np.abs(rows - down) < 0.15 * height)] = draw.random(3)
    picture[np.abs(rows + columns - 0.9) < 0.02] = 0
    picture[np.abs(columns - rows - 0.2) < 0.01] = 1
    return decode_srgb_codes(to_u8(encode_srgb(picture * inside[..., None])))
