"""Fitting a polynomial texture map: least squares a pixel, one pass over the frames, no stack in memory."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.progress import Progress, Report, silent
from processing.ptm.basis import PTM
from processing.ptm.conditioning import fitting_matrix
from processing.ptm.model import Colour, Ptm, Space
from processing.stack import Stack

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
TERMS = PTM.terms
_ROUNDS = 3


def fit(
    stack: Stack,
    light_dirs: NDArray[np.floating],
    *,
    colour: Colour = "lrgb",
    space: Space = "srgb",
    source: str = "",
    report: Report = silent,
) -> Ptm:
    """Fit the six coefficients of every pixel (Synthesis and Rendering of 3D Textures, equation 8).

    Parameters
    ----------
    stack : N pictures
    light_dirs : (N, 3) unit, view frame, sample to light, in the order of the pictures
    colour : "rgb" for a polynomial a channel, "lrgb" for one of luminance and a fixed colour
    space : what is fitted: display values, as the field does, or linear light
    source : digest of the frames, to be kept

    Raises
    ------
    InputError
        The lights cannot carry six terms, one is not above the horizon, or they are not as many as the pictures.
    """
    if len(light_dirs) != len(stack):
        raise InputError(f"{stack.paths[0].parent}: {len(stack)} pictures but {len(light_dirs)} lights; mend the .lp")
    _check_above_horizon(stack, light_dirs)
    solver = fitting_matrix(PTM, light_dirs).astype(np.float32)
    coefficients = np.zeros((TERMS, *stack.shape, 3), np.float32)
    for index in range(len(stack)):
        picture = stack.frame(index, space)
        for term in range(TERMS):
            coefficients[term] += solver[term, index] * picture
        report(Progress("fitting", index + 1, len(stack), stack.paths[index].name))
    if colour == "rgb":
        return Ptm(coefficients, None, space, source)
    design = PTM.evaluate(light_dirs)
    return Ptm(*_split_in_strips(coefficients, design.T @ design / len(design)), space, source)


def _check_above_horizon(stack: Stack, light_dirs: NDArray[np.floating]) -> None:
    for path, (_, _, z) in zip(stack.paths, light_dirs, strict=True):
        if z <= 0:
            raise InputError(f"{path}: its light is not above the horizon (z = {z:g}); mend its line in the .lp")


def split_colour(coefficients: F32, gram: F64) -> tuple[F32, F32]:
    """Split RGB polynomials into luminance times colour, with the least squared error over the lights.

    For the polynomials A (6, 3) of a pixel and G the mean of design·designᵀ over the lights, the best colour is the
    first eigenvector of AᵀGA; a few rounds of power iteration from the mean colour reach it and keep it positive.

    Parameters
    ----------
    coefficients : (6, ..., 3)
    gram : (6, 6)

    Returns
    -------
    luminance : (6, ..., 1), and colour : (..., 3) with its largest channel 1; neutral where the pixel is black
    """
    columns = np.moveaxis(coefficients, 0, -2).astype(np.float64)
    products = np.swapaxes(columns, -1, -2) @ gram @ columns
    # 1 is a term, so that the fit's mean over the lights is the pictures' mean.
    colour = _positive(np.einsum("t,...tc->...c", gram[TERMS - 1], columns))
    for _ in range(_ROUNDS):
        colour = _positive(np.einsum("...cd,...d->...c", products, colour))
    luminance = np.einsum("...tc,...c->...t", columns, colour) / np.sum(colour**2, axis=-1, keepdims=True)
    return np.moveaxis(luminance, -1, 0)[..., None].astype(np.float32), colour.astype(np.float32)


def _split_in_strips(coefficients: F32, gram: F64, rows: int = 64) -> tuple[F32, F32]:
    _, height, width, _ = coefficients.shape
    luminance = np.zeros((TERMS, height, width, 1), np.float32)
    colour = np.zeros((height, width, 3), np.float32)
    for top in range(0, height, rows):
        strip = slice(top, top + rows)
        luminance[:, strip], colour[strip] = split_colour(coefficients[:, strip], gram)
    return luminance, colour


def _positive(colour: F64) -> F64:
    """Scale to a largest channel of 1; white where there is no colour."""
    colour = np.maximum(colour, 0)
    largest = colour.max(axis=-1, keepdims=True)
    return np.where(largest > 1e-12, colour / np.where(largest > 1e-12, largest, 1), 1.0)
