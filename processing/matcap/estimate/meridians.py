"""A MatCap along its meridians: brightness over the angle from the view axis, through the pole and on the other side.

The pixel of a normal (sin θ cos φ, sin θ sin φ, cos θ) lies at (sin θ cos φ, sin θ sin φ) in the disc. On the meridian
φ, θ runs from −π/2 to π/2; a negative one is on the side of φ + π.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from litrig.base.radiometry import LUMINANCE

F64 = NDArray[np.float64]
_PADDING_PX = 4
# So far within the rim no pixel has a share of what lies outside it.
_RIM_PX = 1.0


@dataclass(frozen=True)
class Meridians:
    """The brightness of a MatCap, ready to be sampled.

    Attributes
    ----------
    size : S, pixels along each side
    rim : the greatest |θ| at which the disc was seen, radians
    brightest : the greatest luminance in the disc
    """

    size: int
    rim: float
    brightest: float
    _spline: F64

    @classmethod
    def of(cls, matcap: NDArray[np.floating]) -> "Meridians":
        """Take the luminance of a MatCap (S, S, 3), linear light, the disc inscribed in the square.

        A cubic spline goes through the pixels, for straight lines between them would blur a sharp feature. What lies
        beyond the rim is replaced by its nearest neighbour in the disc, lest it bends the spline within.
        """
        size = matcap.shape[0]
        luminance = np.asarray(matcap, np.float64) @ LUMINANCE
        x, y = grid(size + 2 * _PADDING_PX, size)
        radius = np.hypot(x, y)
        edge = 1 - 2 * _RIM_PX / size
        shrink = np.minimum(edge / np.maximum(radius, edge), 1)
        row, column = _places(x * shrink, y * shrink, size)
        continued = ndimage.map_coordinates(luminance, [row, column], order=1, mode="nearest")
        inside = radius <= edge
        centre = slice(_PADDING_PX, _PADDING_PX + size)
        continued[centre, centre][inside[centre, centre]] = luminance[inside[centre, centre]]
        brightest = float(continued.max())
        return cls(size, float(np.arcsin(edge)), brightest, ndimage.spline_filter(continued, order=3, mode="mirror"))

    @property
    def texel(self) -> float:
        """The angle that a pixel covers at the pole, radians."""
        return 2 / self.size

    def at(self, theta: F64, phi: F64) -> F64:
        """Sample the brightness at angles (...) in radians; beyond the rim it is that of the rim."""
        radius = np.sin(np.clip(theta, -self.rim, self.rim))
        row, column = _places(radius * np.cos(phi), radius * np.sin(phi), self.size)
        sampled: F64 = ndimage.map_coordinates(
            self._spline, [row + _PADDING_PX, column + _PADDING_PX], order=3, prefilter=False, mode="mirror"
        )
        return np.maximum(sampled, 0)


def grid(count: int, size: int) -> tuple[F64, F64]:
    """Return the places x, y (count, count) of pixels about the middle of a disc of `size` pixels; y upwards."""
    along = (2 * np.arange(count) + 1 - count) / size
    x, y = np.meshgrid(along, -along)
    return x, y


def _places(x: F64, y: F64, size: int) -> tuple[F64, F64]:
    return ((1 - y) * size - 1) / 2, ((1 + x) * size - 1) / 2
