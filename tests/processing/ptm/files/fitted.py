"""Fits of the relief in any basis, by NumPy's least squares, and how well a material gives its pictures back."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from processing.ptm.basis import Basis
from processing.ptm.model import Colour, Ptm, Space
from processing.ptm.relighting.relight import relight
from tests.processing.ptm.relief import dome, relief_pictures

SIZE = 64
LIGHTS = dome(24)


@cache
def pictures() -> NDArray[np.float64]:
    """Pictures (N, S, S, 3) of the relief, a corner of which is black under every light."""
    return relief_pictures(LIGHTS, SIZE)


@cache
def fitted(basis: Basis, colour: Colour) -> Ptm:
    design = basis.evaluate(LIGHTS)
    flat = pictures().reshape(len(LIGHTS), -1)
    coefficients = np.linalg.lstsq(design, flat, rcond=None)[0].reshape(basis.terms, SIZE, SIZE, 3)
    if colour == "rgb":
        return Ptm(coefficients.astype(np.float32), None, "srgb", "rgb relief", basis)
    mean = np.maximum(pictures().mean(axis=0), 0)
    largest = mean.max(axis=-1, keepdims=True)
    colours = np.where(largest > 0, mean / np.where(largest > 0, largest, 1), 1)
    luminance = np.sum(coefficients * colours, axis=-1) / np.sum(colours**2, axis=-1)
    return Ptm(luminance[..., None].astype(np.float32), colours.astype(np.float32), "srgb", "lrgb relief", basis)


def psnr_db(material: Ptm) -> float:
    """Compare with the pictures; values are cut to 0..1 first, as a display shows them."""
    errors = [
        np.mean((np.clip(relight(material, light), 0, 1) - picture) ** 2)
        for light, picture in zip(LIGHTS, pictures(), strict=True)
    ]
    return float(-10 * np.log10(np.mean(errors)))


def small(basis: Basis, colour: Colour, space: Space = "srgb") -> Ptm:
    """A material of noise, three by five pixels."""
    random = np.random.default_rng(basis.terms)
    coefficients = random.uniform(-1, 1, (basis.terms, 3, 5, 1 if colour == "lrgb" else 3)).astype(np.float32)
    colours = random.uniform(0, 1, (3, 5, 3)).astype(np.float32) if colour == "lrgb" else None
    return Ptm(coefficients, colours, space, "abc123", basis)


def black(basis: Basis, colour: Colour) -> Ptm:
    """A material that was black in every picture."""
    lrgb = colour == "lrgb"
    coefficients = np.zeros((basis.terms, 8, 9, 1 if lrgb else 3), np.float32)
    return Ptm(coefficients, np.ones((8, 9, 3), np.float32) if lrgb else None, basis=basis)
