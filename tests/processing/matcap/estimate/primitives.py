"""MatCaps of analytic lights whose variance is known (the MatCap paper, figure 5), as 8-bit sRGB pictures."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

from processing.matcap.estimate.estimate import FilterEstimate, Kind, estimate_filter_size
from processing.matcap.estimate.regions import Region

F64 = NDArray[np.float64]
Shape = Literal["spot", "spot with a neighbour", "ring", "edge of a ring", "straight edge"]
SHAPES: tuple[Shape, ...] = ("spot", "spot with a neighbour", "ring", "edge of a ring", "straight edge")
EDGES = ("edge of a ring", "straight edge")
BRIGHTEST = 0.95


@dataclass(frozen=True)
class Primitive:
    """A light whose brightness, or slope, along its meridian is a Gaussian.

    Attributes
    ----------
    theta, phi : where it is brightest or steepest, radians
    deviation : the Gaussian's standard deviation, radians
    """

    shape: Shape
    theta: float
    deviation: float
    phi: float = 0.7

    @property
    def variance(self) -> float:
        return self.deviation**2

    @property
    def of(self) -> Kind:
        return "edges" if self.shape in EDGES else "values"

    def region(self, size: int, side: int = 5) -> Region:
        return Region.around(self.theta, self.phi, size, side)

    def light(self, normals: F64) -> F64:
        """Return its brightness 0..1 at unit normals (..., 3)."""
        theta = np.arccos(np.clip(normals[..., 2], -1, 1))
        if self.shape == "ring":
            return _bump(theta - self.theta, self.deviation)
        if self.shape == "edge of a ring":
            return _step(theta - self.theta, self.deviation)
        if self.shape == "straight edge":
            across = _direction(self.theta - np.pi / 2, self.phi)
            return _step(-np.arcsin(np.clip(normals @ across, -1, 1)), self.deviation)
        light = _bump(_angle(normals, _direction(self.theta, self.phi)), self.deviation)
        if self.shape == "spot with a neighbour":
            beside = _angle(normals, _direction(-self.theta - 0.3, self.phi))
            light = light + 0.8 * _bump(beside, min(self.deviation, 0.12))
        return light


def matcap_of(*primitives: Primitive, size: int, bits: bool = True) -> NDArray[np.float32]:
    """Draw lights that add up, (S, S, 3) linear, through 8 bits of sRGB unless told otherwise."""
    along = (2 * np.arange(size) + 1) / size - 1
    x, y = np.meshgrid(along, -along)
    radius = np.hypot(x, y)
    normals = np.stack([x, y, np.sqrt(np.clip(1 - radius**2, 0, None))], axis=-1)
    light = BRIGHTEST * np.clip(sum(one.light(normals) for one in primitives), 0, 1) * (radius <= 1)
    if bits:
        light = _decoded(np.rint(_encoded(light) * 255) / 255)
    return np.repeat(light[..., None], 3, axis=2).astype(np.float32)


def estimated(primitive: Primitive, size: int) -> FilterEstimate:
    """Estimate a primitive from a region of 5 × 5 pixels in its middle."""
    return estimate_filter_size(matcap_of(primitive, size=size), [primitive.region(size)], of=primitive.of)


def has_one_mode(primitive: Primitive) -> bool:
    """Whether the profile through the pole has one mode within two deviations: a ring has its other side there."""
    return primitive.shape not in ("ring", "edge of a ring") or primitive.theta > 2 * primitive.deviation


def _bump(angle: F64, deviation: float) -> F64:
    return np.exp(-(angle**2) / (2 * deviation**2))


def _step(angle: F64, deviation: float) -> F64:
    step: F64 = (1 + erf(angle / (deviation * np.sqrt(2)))) / 2
    return step


def _direction(theta: float, phi: float) -> F64:
    return np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])


def _angle(normals: F64, direction: F64) -> F64:
    return np.arccos(np.clip(normals @ direction, -1, 1))


def _encoded(linear: F64) -> F64:
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 0.0031308) ** (1 / 2.4) - 0.055)


def _decoded(display: F64) -> F64:
    return np.where(display <= 0.04045, display / 12.92, ((display + 0.055) / 1.055) ** 2.4)
