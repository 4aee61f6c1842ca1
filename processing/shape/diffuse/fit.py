"""The diffuse environment of a surface: the nine harmonics that its shading shows (the Shape paper, section 3.1)."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from litrig.base.errors import InputError
from processing.shape.diffuse.passes import F32, F64, furthest_above
from processing.shape.diffuse.quadratic import basis_of, fit_above
from processing.shape.harmonics import evaluate

Method = Literal["qp", "ls"]
_ILL_POSED = 1e6
_DIRECTIONS = 2000
_LIFTS = 8


@dataclass(frozen=True)
class DiffuseOptions:
    """How to fit.

    Attributes
    ----------
    method : "qp", as close as can be and under no pixel, so that what occlusion took shows as negative residuals; or
        "ls", least squares (the paper's figure 2)
    ridge : penalty on all coefficients but the mean, as a share of the mean square of the harmonics; for surfaces whose
        normals cover little of the sphere
    never_negative : let the fit be negative nowhere on the sphere, where no pixel tells
    """

    method: Method = "qp"
    ridge: float = 0.0
    never_negative: bool = False

    def __post_init__(self) -> None:
        """Refuse what means nothing."""
        if not 0 <= self.ridge < np.inf:
            raise InputError(f"diffuse environment: a ridge of {self.ridge:g} means nothing; give 0 or more")
        if self.never_negative and self.method == "ls":
            raise InputError("diffuse environment: least squares knows no bounds; leave never_negative, or use qp")


@dataclass(frozen=True)
class DiffuseFit:
    """Coefficients (9, C) float32, and what is to be known about them."""

    coefficients: F32
    remarks: tuple[str, ...]


def fit_diffuse(normals: F32, shading: F32, options: DiffuseOptions | None = None) -> DiffuseFit:
    """Fit the harmonics to the pixels of a surface (equation 1 and the programme after it).

    Parameters
    ----------
    normals : (N, 3) float32, unit, view frame
    shading : (N, C) float32, finite, D₀

    Raises
    ------
    InputError
        There is no pixel, or one is no finite number.
    """
    options = options or DiffuseOptions()
    if not len(normals):
        raise InputError("diffuse environment: no pixel to fit; choose a surface that is seen")
    if not (np.isfinite(normals).all() and np.isfinite(shading).all()):
        raise InputError("diffuse environment: pixels that are no finite numbers; leave them out")
    normals, shading = np.ascontiguousarray(normals, np.float32), np.ascontiguousarray(shading, np.float32)
    basis = basis_of(normals, shading, options.ridge)
    everywhere = spread_directions(_DIRECTIONS)
    if options.method == "ls":
        coefficients = basis.least_squares.astype(np.float32)
    else:
        exact = fit_above(normals, shading, basis, everywhere if options.never_negative else None)
        coefficients = _lifted(normals, shading, exact)
    remarks = []
    if basis.condition > _ILL_POSED and not options.ridge:
        remarks.append(
            "its normals cover too little of the sphere to tell the diffuse light of other directions; "
            "a ridge of 1e-3 or so tames it"
        )
    negative = float(np.mean((evaluate(everywhere) @ coefficients < 0).any(axis=1)))
    if negative > 0 and not options.never_negative:
        remarks.append(f"its diffuse environment is negative in {negative:.0%} of all directions, where no pixel tells")
    return DiffuseFit(coefficients, tuple(remarks))


def spread_directions(count: int) -> F64:
    """Spread unit directions (count, 3) evenly over the sphere, on a Fibonacci spiral."""
    index = np.arange(count) + 0.5
    z = 1 - 2 * index / count
    angle = np.pi * (1 + np.sqrt(5)) * index
    flat = np.sqrt(1 - z * z)
    return np.stack([flat * np.cos(angle), flat * np.sin(angle), z], axis=-1)


def _lifted(normals: F32, shading: F32, exact: F64) -> F32:
    """Round to single precision, and lift the mean by what this took below a pixel."""
    stored = exact.astype(np.float32)
    for _ in range(_LIFTS):
        excess = furthest_above(normals, shading, stored.astype(np.float64))[0].max(axis=0)
        low = excess > 0
        if not low.any():
            break
        mean = stored[0].astype(np.float64) + np.where(low, excess * np.sqrt(4 * np.pi), 0)
        stored[0] = np.where(low, np.nextafter(mean.astype(np.float32), np.float32(np.inf)), stored[0])
    return stored
