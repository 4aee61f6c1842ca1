"""Pictures that the gallery lays on and hangs up: patches, face paint, a flame."""

import numpy as np
from numpy.typing import NDArray
from shapes import Part

F64 = NDArray[np.float64]
HIDE, PATCH, MUZZLE = (0.98, 0.96, 0.92), (0.44, 0.24, 0.16), (0.93, 0.62, 0.58)
HORN, IVORY = (0.45, 0.40, 0.33), (0.93, 0.88, 0.74)
SKIN, LIPS, INK, GREEN = (0.80, 0.86, 0.55), (0.75, 0.16, 0.14), (0.10, 0.10, 0.12), (0.35, 0.60, 0.25)
ID_COLOURS = ((0.13, 0.17, 0.42), (0.20, 0.62, 0.55), (0.98, 0.80, 0.35))
"""Darkest first: that is how material IDs are counted."""


def cow_patches(places: F64, part: int) -> F64:
    """Return display colours: a hide with dark patches, a pink muzzle, horns."""
    if part == 2:
        return _all(places, MUZZLE)
    if part in (5, 6):
        return _all(places, HORN)
    return _mix(HIDE, PATCH, patches(places))


def cow_rough(places: F64, part: int) -> F64:
    """Return grey, white outside the patches: where the hide is to be rough."""
    smooth = np.zeros(places.shape[:-1]) if part in (2, 5, 6) else patches(places)
    return np.repeat(1.0 - (smooth > 0.5)[..., None], 3, axis=-1)


def patches(places: F64, size: float = 0.62, seed: int = 7) -> F64:
    """Return (…) from 0 to 1: patches in space with edges that are not quite hard, by a sum of random waves."""
    rng = np.random.default_rng(seed)
    ways = rng.normal(size=(24, 3))
    ways *= rng.uniform(0.6, 1.3, (24, 1)) / np.linalg.norm(ways, axis=1, keepdims=True) * 2 * np.pi / size
    waves = np.cos(places @ ways.T + rng.uniform(0, 2 * np.pi, 24)).sum(axis=-1) / np.sqrt(12)
    return np.asarray(np.clip(0.5 + (waves - 0.2) * 6, 0, 1))


def face_paint(places: F64, part: int) -> F64:
    """Return display colours for the mask: greenish skin, red lips, bands on the cheeks, white eyes, ivory horns."""
    x, y = np.abs(places[..., 0]), places[..., 1]
    if part in (1, 2):
        middle = np.array([0.27 if part == 2 else -0.27, 0.15])
        off = np.linalg.norm(places[..., :2] - middle, axis=-1)
        return _mix((0.96, 0.95, 0.90), INK, (_below(off, 0.05, 0.008)) * (places[..., 2] > 0.66))
    if part >= 5:
        return _mix(IVORY, HORN, 0.5 - 0.5 * np.cos(y * 60))
    colours = _mix(SKIN, GREEN, 0.5 + 0.5 * np.tanh((y - 0.2 + 0.5 * patches(places, 0.5)) * 3))
    if part == 0:
        front = places[..., 2] > 0
        colours = _over(colours, LIPS, _below(np.hypot(x / 0.27, (y + 0.50) / 0.115), 1.0, 0.12) * front)
        for band in range(3):
            slant = y + 0.17 + 0.10 * band - 0.25 * (x - 0.5)
            colours = _over(colours, INK, _below(np.abs(slant), 0.022, 0.006) * (x > 0.33) * (x < 0.68) * front)
    return colours


def material_ids(parts: list[Part]) -> "F64":
    """Return one column a part, in the colour of its material."""
    columns = [np.tile(np.array(ID_COLOURS[part.material]), (16, 16, 1)) for part in parts]
    return np.concatenate(columns, axis=1)


def flame(side: int = 256) -> F64:
    """Return a flame (side, side, 4), display colours and alpha: tongues that narrow upwards, hotter inside."""
    x, y = np.meshgrid(np.linspace(-1, 1, side), np.linspace(1, -1, side))
    up = (y + 1) / 2
    heat = np.zeros_like(x)
    for middle, wide, tall, lean in ((0.0, 0.42, 0.95, 0.10), (-0.36, 0.24, 0.62, -0.10), (0.38, 0.22, 0.55, 0.12)):
        share = np.clip(up / tall, 0, 1)
        centre = middle + lean * np.sin(3.2 * share + 2 * middle) * share
        half = wide * np.sqrt(np.clip(share, 0, 1) ** 0.5 * (1 - share)) * 1.5 + 1e-3
        tongue = np.clip(1 - ((x - centre) / half) ** 2, 0, 1) * (up < tall)
        heat = np.maximum(heat, tongue * (1 - 0.55 * share))
    colours = _mix((0.85, 0.12, 0.02), (1.0, 0.62, 0.10), np.clip(heat * 1.8, 0, 1))
    colours = _over(colours, (1.0, 0.96, 0.72), np.clip(heat * 2.4 - 1.2, 0, 1))
    return np.concatenate([colours, np.clip(heat * 3.0, 0, 1)[..., None]], axis=-1)


def _all(places: F64, colour: tuple[float, float, float]) -> F64:
    return np.broadcast_to(np.array(colour), places.shape)


def _below(value: F64, edge: float, soft: float) -> F64:
    return np.asarray(np.clip((edge - value) / soft + 0.5, 0, 1))


def _mix(first: tuple[float, float, float], second: tuple[float, float, float], share: F64) -> F64:
    return _over(np.broadcast_to(np.array(first), (*share.shape, 3)), second, share)


def _over(below: F64, colour: tuple[float, float, float], share: F64) -> F64:
    return np.asarray(below + (np.array(colour) - below) * share[..., None])
