"""A polynomial texture map, or its kin in another basis."""

from dataclasses import dataclass
from typing import Literal, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from processing.decoded import spread
from processing.ptm.basis import PTM, Basis

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Space = Literal["srgb", "linear"]
Colour = Literal["lrgb", "rgb"]


@dataclass(frozen=True)
class Ptm:
    """A few coefficients a pixel, so that any light direction gives a picture (Texture paper, equation 8).

    Attributes
    ----------
    coefficients : (T, H, W, C) float32, one for each term of the basis, in units where 1 is white; row 0 on top.
        C = 3 where each channel has its own (RGB). C = 1 where they give the luminance alone (LRGB)
    colour : (H, W, 3) float32, the factor of the luminance in an LRGB material; None in an RGB one
    space : "srgb" if the fitted values were display-encoded (the field's habit), "linear" if they were light
    source : digest of the frames that it was fitted to
    basis : what the coefficients belong to
    light_gram : (T, T) mean of the products of the terms over the lights of the fit; None where they are not known
    """

    coefficients: F32
    colour: F32 | None
    space: Space = "srgb"
    source: str = ""
    basis: Basis = PTM
    light_gram: F64 | None = None

    def __post_init__(self) -> None:
        if len(self.coefficients) != self.basis.terms:
            raise ValueError(f"{len(self.coefficients)} coefficients a pixel do not make a {self.basis}")

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width."""
        _, height, width, _ = self.coefficients.shape
        return height, width

    @property
    def kind(self) -> Colour:
        """Whether colour and luminance are apart."""
        return "rgb" if self.colour is None else "lrgb"

    @property
    def gram(self) -> F64:
        """What an error in one coefficient costs beside one in another: in the mean over the lights, or over all."""
        return self.basis.gram if self.light_gram is None else self.light_gram

    def strip(self, rows: slice) -> "Strip":
        """Return some rows."""
        return Strip(self.coefficients[:, rows], None if self.colour is None else self.colour[rows])

    def sample(self, count: int) -> "Strip":
        """Return about so many pixels from all over, as one row."""
        columns = spread(self.shape, count)
        terms, channels = self.coefficients.shape[0], self.coefficients.shape[3]
        coefficients = self.coefficients.reshape(terms, 1, -1, channels)[:, :, columns]
        return Strip(coefficients, None if self.colour is None else self.colour.reshape(1, -1, 3)[:, columns])


class Strip(NamedTuple):
    """Some rows of a material: `coefficients` (T, h, W, C) and `colour` (h, W, 3) or None, as in `Ptm`."""

    coefficients: F32
    colour: F32 | None


class Material(Protocol):
    """What can be written to a file: a `Ptm`, or a fit whose coefficients come into being row by row.

    A fit of pictures that are larger than memory is never held whole; a writer takes it a strip at a time.
    """

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width."""

    @property
    def kind(self) -> Colour:
        """Whether colour and luminance are apart."""

    @property
    def space(self) -> Space:
        """Which values were fitted."""

    @property
    def source(self) -> str:
        """Digest of the frames."""

    @property
    def basis(self) -> Basis:
        """What the coefficients belong to."""

    @property
    def gram(self) -> F64:
        """What an error in one coefficient costs beside one in another, (T, T)."""

    def strip(self, rows: slice) -> Strip:
        """Return some rows; may be called from several threads, in any order, and again."""

    def sample(self, count: int) -> Strip:
        """Return about so many pixels from all over, as one row."""
