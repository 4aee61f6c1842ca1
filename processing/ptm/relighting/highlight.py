"""Specular enhancement: a highlight that the material never had, to show the finest relief."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from processing.ptm.model import Ptm
from processing.ptm.relighting.relight import relight

F32 = NDArray[np.float32]


@dataclass(frozen=True)
class Highlight:
    """A Blinn–Phong lobe (Malzbender, Gelb, Wolters, Polynomial Texture Maps, 2001, specular enhancement).

    Attributes
    ----------
    normals : (H, W, 3) float32, unit, view frame
    strength : ks, where 1 is white
    exponent : of n·h, greater than 0; the larger, the smaller the highlight
    """

    normals: F32
    strength: float
    exponent: float

    def strip(self, rows: slice) -> "Highlight":
        """Return some rows."""
        return replace(self, normals=self.normals[rows])

    def under(self, light: NDArray[np.floating]) -> F32:
        """Return ks·(n·h)^exponent (H, W), h half-way between the light (3,) and the camera at z."""
        half = np.asarray(light, np.float64) + np.array([0.0, 0.0, 1.0])
        half /= np.linalg.norm(half)
        cosine = np.maximum(self.normals @ half.astype(np.float32), 0)
        return np.asarray(self.strength * cosine**self.exponent, np.float32)


def shade(ptm: Ptm, light: NDArray[np.floating], highlight: Highlight | None = None) -> F32:
    """Relight at one light (3,), and add the highlight to the values as they are stored, as viewers do.

    Returns
    -------
    picture : (H, W, 3) float32 in the material's own space, not cut off
    """
    values = relight(ptm, light)
    return values if highlight is None else values + highlight.under(light)[..., None]
