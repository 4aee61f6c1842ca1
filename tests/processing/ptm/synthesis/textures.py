"""Materials to synthesise from: noise with structure, made by formulas."""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from processing.ptm.basis import PTM, Basis
from processing.ptm.model import Colour, Ptm


def rough(side_px: int, colour: Colour = "lrgb", seed: int = 0, basis: Basis = PTM, blur_px: float = 1.5) -> Ptm:
    """A rough surface whose coefficients hang together as those of a relief do."""
    random = np.random.default_rng(seed)
    height = ndimage.gaussian_filter(random.standard_normal((side_px, side_px)), blur_px, mode="wrap")
    slope_y, slope_x = np.gradient(height / height.std())
    mixed = np.stack([-(slope_x**2), -(slope_y**2), -slope_x * slope_y, -slope_x, slope_y, height / height.std()])
    weights = np.array([0.05, 0.05, 0.05, 0.12, 0.12, 0.06])[:, None, None]
    terms = (np.array([-0.2, -0.2, 0, 0, 0, 0.6])[:, None, None] + weights * mixed)[-min(6, basis.terms) :]
    terms = np.concatenate([terms, np.zeros((basis.terms - len(terms), side_px, side_px))])
    grey = terms[..., None].astype(np.float32)
    tint = np.array([0.9, 0.7, 0.5]) * (1 + 0.1 * mixed[5][..., None])
    if colour == "lrgb":
        return Ptm(grey, tint.astype(np.float32), source=f"rough {seed}", basis=basis)
    return Ptm((grey * tint).astype(np.float32), None, source=f"rough {seed}", basis=basis)


def flat(side_px: int, value: float = 0.5) -> Ptm:
    """A surface that is the same everywhere: all blocks tie."""
    coefficients = np.zeros((6, side_px, side_px, 1), np.float32)
    coefficients[5] = value
    return Ptm(coefficients, np.ones((side_px, side_px, 3), np.float32))


def bits(material: Ptm) -> NDArray[np.uint32]:
    """All numbers of a material, to be compared bit by bit."""
    parts = [material.coefficients.ravel(), *([] if material.colour is None else [material.colour.ravel()])]
    return np.concatenate(parts).view(np.uint32)
