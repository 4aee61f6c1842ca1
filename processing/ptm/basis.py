"""The functions of the light's direction that a pixel's brightness is a sum of."""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]

Kind = Literal["ptm", "hsh"]
# Lights on the horizon have no azimuth left in the half-sphere's functions; the field keeps this far away from it.
_LOWEST_RAD = 0.01
_DISC_NODES, _DISC_ANGLES = 24, 48


@dataclass(frozen=True)
class Basis:
    """A family of functions and how many of them are used.

    Attributes
    ----------
    kind : "ptm", polynomials of (u, v) (Synthesis and Rendering of 3D Textures, equation 8): with 6 terms
        u², v², uv, u, v, 1; with 3 terms u, v, 1. "hsh", the hemispherical harmonics of degree 0 to 3, orthonormal over
        the half-sphere, in the order of the `.rti` format: by degree, and in each from cos mφ over m = 0 to sin mφ
    terms : 3 or 6 of "ptm"; 4, 9 or 16 of "hsh"
    """

    kind: Kind
    terms: int

    def __post_init__(self) -> None:
        if self.terms not in TERMS[self.kind]:
            raise ValueError(f"a basis {self.kind} has {' or '.join(map(str, TERMS[self.kind]))} terms")

    def __str__(self) -> str:
        return f"{self.kind.upper()} of {self.terms} terms"

    @property
    def names(self) -> tuple[str, ...]:
        """What each term is called."""
        if self.kind == "ptm":
            return ("u2", "v2", "uv", "u", "v", "1")[6 - self.terms :]
        return tuple(f"h{index}" for index in range(self.terms))

    def evaluate(self, light_dirs: NDArray[np.floating]) -> F64:
        """Evaluate the terms.

        Parameters
        ----------
        light_dirs : (..., 2) or (..., 3), unit, view frame, sample to light; two numbers are its x and y

        Returns
        -------
        values : (..., terms) float64
        """
        directions = np.asarray(light_dirs, np.float64)
        return self._polynomials(directions) if self.kind == "ptm" else self._harmonics(directions)

    @cached_property
    def gram(self) -> F64:
        """Mean (terms, terms) of the products of the terms, over lights spread evenly over the unit disc of (u, v)."""
        radius, weight = np.polynomial.legendre.leggauss(_DISC_NODES)
        angle = 2 * np.pi * np.arange(_DISC_ANGLES) / _DISC_ANGLES
        r = (radius[:, None] + 1) / 2
        values = self.evaluate(np.stack([r * np.cos(angle), r * np.sin(angle)], axis=-1))
        return np.asarray(np.einsum("ra,rat,ras->ts", weight[:, None] * r / _DISC_ANGLES, values, values), np.float64)

    def _polynomials(self, directions: F64) -> F64:
        u, v = directions[..., 0], directions[..., 1]
        return np.stack([u * u, v * v, u * v, u, v, np.ones_like(u)], axis=-1)[..., 6 - self.terms :]

    def _harmonics(self, directions: F64) -> F64:
        x, y = directions[..., 0], directions[..., 1]
        z = directions[..., 2] if directions.shape[-1] == 3 else np.sqrt(np.maximum(1 - x * x - y * y, 0))
        c = np.cos(np.minimum(np.arccos(np.clip(z, -1, 1)), np.pi / 2 - _LOWEST_RAD))
        phi = np.arctan2(y, x)
        s = c - c * c
        q = np.sqrt(s)
        one, two = np.sqrt(6 / np.pi) * q, np.sqrt(30 / np.pi)
        values = [
            np.full_like(c, 1 / np.sqrt(2 * np.pi)),
            one * np.cos(phi),
            np.sqrt(3 / (2 * np.pi)) * (2 * c - 1),
            one * np.sin(phi),
        ]
        if self.terms > 4:
            mixed = two * (2 * c - 1) * q
            values += [
                -two * s * np.cos(2 * phi),
                mixed * np.cos(phi),
                np.sqrt(5 / (2 * np.pi)) * (1 - 6 * s),
                mixed * np.sin(phi),
                -two * s * np.sin(2 * phi),
            ]
        if self.terms > 9:
            outer = np.sqrt(140 / np.pi) * s * q
            middle = -np.sqrt(210 / np.pi) * (2 * c - 1) * s
            inner = np.sqrt(84 / np.pi) * q * (1 - 5 * s)
            values += [
                outer * np.cos(3 * phi),
                middle * np.cos(2 * phi),
                inner * np.cos(phi),
                np.sqrt(7 / (2 * np.pi)) * (20 * c**3 - 30 * c**2 + 12 * c - 1),
                inner * np.sin(phi),
                middle * np.sin(2 * phi),
                outer * np.sin(3 * phi),
            ]
        return np.stack(values, axis=-1)


TERMS: dict[Kind, tuple[int, ...]] = {"ptm": (6, 3), "hsh": (9, 4, 16)}
"""How many terms a kind may have, the usual number first."""

PTM = Basis("ptm", 6)
"""The polynomial that `.ptm` files hold."""
