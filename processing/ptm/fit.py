"""Fitting coefficients to pictures: every pixel by itself, in strips, so that no result need be held whole."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.progress import Progress, Report, silent
from processing.decoded import DEFAULT_BUDGET_BYTES, Decoded, decoded, spread
from processing.ptm.basis import PTM, Basis
from processing.ptm.colour_split import split_colour
from processing.ptm.conditioning import check_lights, fitting_matrix, ridge_weights
from processing.ptm.least_squares import solve
from processing.ptm.model import Colour, Ptm, Space, Strip
from processing.ptm.near_lights import NearLights, brighten
from processing.ptm.robust import Robust, fit_weighted
from processing.stack import Stack

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

# What is made for a strip, per pixel: values of all pictures, coefficients, weights.
_BLOCK_PIXELS = 4096
_STRIP_ROWS = 64
_ELSEWHERE = 0.01


@dataclass(frozen=True)
class FitSettings:
    """What is fitted, and how.

    Attributes
    ----------
    basis : the functions of the light's direction
    colour : "rgb" for coefficients of each channel, "lrgb" for those of luminance and a fixed colour
    space : what is fitted: display values, as the field does, or linear light
    robust : whether shadows and highlights are held back
    ridge : how much large coefficients are held down; 0 is least squares
    near : where the lights stood, if their directions differ over the picture
    light_gains : (N, 3) by what linear R, G, B are multiplied, to make unequal lamps equal; None if they are
    memory_bytes : decoded pictures of more than this go to a file
    spool : folder for that file
    """

    basis: Basis = PTM
    colour: Colour = "lrgb"
    space: Space = "srgb"
    robust: Robust = "no"
    ridge: float = 0.0
    near: NearLights | None = None
    light_gains: F64 | None = None
    memory_bytes: int = DEFAULT_BUDGET_BYTES
    spool: Path | None = None


class Fit:
    """A fit of decoded pictures, whose coefficients come into being when they are asked for (a `Material`).

    Attributes
    ----------
    settings : what is fitted
    light_dirs : (N, 3) unit, view frame
    design : (N, T) terms at each light, at the picture's centre
    gram : (T, T) mean of the products of the terms over the lights
    """

    def __init__(self, pictures: Decoded, light_dirs: F64, settings: FitSettings, source: str) -> None:
        self.settings = settings
        self.light_dirs = light_dirs
        self.source = source
        self.design = settings.basis.evaluate(light_dirs)
        self._pictures = pictures
        self._solver = fitting_matrix(settings.basis, light_dirs, settings.ridge)
        # A little of all the other lights: they are used too, and the matrix has a square root whatever the lights.
        self.gram: F64 = (1 - _ELSEWHERE) * self.design.T @ self.design / len(self.design)
        self.gram += _ELSEWHERE * settings.basis.gram

    @property
    def shape(self) -> tuple[int, int]:
        return self._pictures.shape

    @property
    def kind(self) -> Colour:
        return self.settings.colour

    @property
    def space(self) -> Space:
        return self.settings.space

    @property
    def basis(self) -> Basis:
        return self.settings.basis

    def strip(self, rows: slice) -> Strip:
        """Fit some rows (Synthesis and Rendering of 3D Textures, equation 8)."""
        height, width = self.shape
        top, bottom, _ = rows.indices(height)
        coefficients = np.zeros((self.basis.terms, (bottom - top) * width, 3), np.float32)
        start, stop = top * width, bottom * width
        if self._least_squares and self._pictures.proportional and self.settings.light_gains is None:
            solver = (self._solver / self._pictures.white).astype(np.float32)
            values, first = self._pictures.window(start, stop)
            solve(solver, values, first, first + 3 * (stop - start), coefficients.reshape(len(coefficients), -1))
        else:
            for first in range(start, stop, _BLOCK_PIXELS):
                pixels = np.arange(first, min(stop, first + _BLOCK_PIXELS))
                values = self._pictures.pixels(int(pixels[0]), int(pixels[-1]) + 1)
                coefficients[:, pixels - start] = self._fitted(values, pixels)[0]
        return self.split(coefficients.reshape(-1, bottom - top, width, 3))

    def sample(self, count: int) -> Strip:
        """Fit about so many pixels from all over, as one row."""
        return self.split(self.at(spread(self.shape, count))[1][:, None])

    def at(self, pixels: NDArray[np.int64]) -> tuple[F32, F32, F32, F64]:
        """Fit chosen pixels, and tell what there is to know.

        Parameters
        ----------
        pixels : (n,) indices into the picture row by row

        Returns
        -------
        values : (N, n, 3) what the pictures show, as it is fitted
        coefficients : (T, n, 3)
        weights : (N, n) of the pictures; 1 in least squares
        design : (N, 1, T), or (N, n, T) with near lights
        """
        values = self._pictures.at(pixels)
        coefficients, weights, design = self._fitted(values, pixels)
        return self._brightened(values, pixels), coefficients, weights, design

    def split(self, coefficients: F32) -> Strip:
        """Take luminance and colour of coefficients (T, ..., 3) apart if that is what is asked for."""
        if self.settings.colour == "rgb":
            return Strip(coefficients, None)
        return Strip(*split_colour(coefficients, self.gram))

    @property
    def held(self) -> F64:
        """What is added to the diagonal of the normal equations, (T,)."""
        return ridge_weights(self.design, self.settings.ridge)

    @property
    def _least_squares(self) -> bool:
        """Whether all pixels have one fitting matrix."""
        return self.settings.near is None and self.settings.robust == "no"

    def _brightened(self, values: F32, pixels: NDArray[np.int64]) -> F32:
        near, lamps = self.settings.near, self.settings.light_gains
        if near is None and lamps is None:
            return values
        gains = np.ones((len(values), 1, 1), np.float32)
        if near is not None:
            gains = gains * near.at(pixels, self.shape)[1][..., None]
        if lamps is not None:
            gains = gains * lamps[:, None].astype(np.float32)
        return brighten(values, gains, self.space)

    def _fitted(self, values: F32, pixels: NDArray[np.int64]) -> tuple[F32, F32, F64]:
        values = self._brightened(values, pixels)
        flat = np.ascontiguousarray(values.reshape(len(values), -1))
        plain = (self._solver.astype(np.float32) @ flat).reshape(self.basis.terms, -1, 3)
        design = self.design[:, None]
        if self._least_squares:
            return plain, np.ones(values.shape[:2], np.float32), design
        if self.settings.near is not None:
            design = self.basis.evaluate(self.settings.near.at(pixels, self.shape)[0])
        return *fit_weighted(values, design, self.held, plain, self.settings.robust), design


def start_fit(
    stack: Stack,
    light_dirs: NDArray[np.floating],
    settings: FitSettings | None = None,
    *,
    source: str = "",
    lights_source: str = "",
    report: Report = silent,
) -> Fit:
    """Read the pictures and return their fit, which holds them.

    Parameters
    ----------
    stack : N pictures
    light_dirs : (N, 3) unit, view frame, sample to light, in the order of the pictures
    source : digest of the frames, to be kept
    lights_source : names the lights in errors; by default the pictures' folder

    Raises
    ------
    InputError, FormatError
        The lights cannot carry the basis, one is not above the horizon, or they are not as many as the pictures; a
        picture is missing, damaged, or of another size or depth than the first.
    """
    settings = settings or FitSettings()
    directions: F64 = np.asarray(light_dirs, np.float64)
    if len(directions) != len(stack):
        raise InputError(f"{stack.paths[0].parent}: {len(stack)} pictures but {len(directions)} lights; mend the .lp")
    for path, (_, _, z) in zip(stack.paths, directions, strict=True):
        if z <= 0:
            raise InputError(f"{path}: its light is not above the horizon (z = {z:g}); mend its line in the .lp")
    check_lights(settings.basis, directions, settings.ridge, lights_source or str(stack.paths[0].parent))
    pictures = decoded(stack, settings.space, budget_bytes=settings.memory_bytes, spool=settings.spool, report=report)
    return Fit(pictures, directions, settings, source)


def fit(
    stack: Stack,
    light_dirs: NDArray[np.floating],
    *,
    basis: Basis = PTM,
    colour: Colour = "lrgb",
    space: Space = "srgb",
    robust: Robust = "no",
    ridge: float = 0.0,
    near: NearLights | None = None,
    source: str = "",
    report: Report = silent,
) -> Ptm:
    """Fit every pixel and hold the result whole; parameters and errors are those of `FitSettings` and `start_fit`."""
    settings = FitSettings(basis, colour, space, robust, ridge, near)
    return gathered(start_fit(stack, light_dirs, settings, source=source, report=report), report)


def gathered(fitted: Fit, report: Report = silent) -> Ptm:
    """Hold a fit whole."""
    height, width = fitted.shape
    channels = 3 if fitted.kind == "rgb" else 1
    coefficients = np.zeros((fitted.basis.terms, height, width, channels), np.float32)
    colour = None if fitted.kind == "rgb" else np.zeros((height, width, 3), np.float32)
    for top in range(0, height, _STRIP_ROWS):
        rows = slice(top, min(height, top + _STRIP_ROWS))
        strip = fitted.strip(rows)
        coefficients[:, rows] = strip.coefficients
        if colour is not None and strip.colour is not None:
            colour[rows] = strip.colour
        report(Progress("fitting", rows.stop, height))
    return Ptm(coefficients, colour, fitted.space, fitted.source, fitted.basis, fitted.gram)
