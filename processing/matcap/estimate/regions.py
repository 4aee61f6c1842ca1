"""Regions of interest, in pixels of a MatCap."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError

F64 = NDArray[np.float64]

_MOST_PIXELS = 400


@dataclass(frozen=True)
class Region:
    """A rectangle of whole pixels.

    Attributes
    ----------
    x, y : its upper left corner, from that of the picture
    width, height : pixels
    """

    x: int
    y: int
    width: int
    height: int

    def __str__(self) -> str:
        return f"{self.width} × {self.height} at {self.x}, {self.y}"

    def angles(self, size: int, rim: float) -> tuple[F64, F64]:
        """Return (θ, φ) of the pixels whose normals are in the disc, in radians; of large regions every so many.

        Parameters
        ----------
        size : S, pixels along each side of the MatCap
        rim : the greatest θ that counts

        Raises
        ------
        InputError
            The region is no part of the picture, or has no pixel in the disc.
        """
        if min(self.width, self.height) < 1 or min(self.x, self.y) < 0:
            raise InputError(f"region {self}: is no rectangle in the picture; give X Y W H in whole pixels")
        if self.x + self.width > size or self.y + self.height > size:
            raise InputError(f"region {self}: goes beyond the {size} × {size} pixels of the MatCap; keep it inside")
        step = max(int(np.ceil(np.sqrt(self.width * self.height / _MOST_PIXELS))), 1)
        # What is left over by whole steps is shared by both ends.
        columns = self.x + (self.width - 1) % step // 2 + np.arange(0, self.width, step)
        rows = self.y + (self.height - 1) % step // 2 + np.arange(0, self.height, step)
        x, y = np.meshgrid((2 * columns + 1) / size - 1, 1 - (2 * rows + 1) / size)
        radius = np.hypot(x, y)
        inside = radius < np.sin(rim)
        if not inside.any():
            raise InputError(f"region {self}: lies outside the disc; move it onto the ball")
        return np.arcsin(radius[inside]), np.arctan2(y[inside], x[inside])

    def grown(self, pixels: int, size: int) -> "Region":
        """Return the region with a margin, within a picture of S × S pixels."""
        left, top = max(self.x - pixels, 0), max(self.y - pixels, 0)
        right, bottom = min(self.x + self.width + pixels, size), min(self.y + self.height + pixels, size)
        return Region(left, top, right - left, bottom - top)

    @classmethod
    def around(cls, theta: float, phi: float, size: int, side: int) -> "Region":
        """Return the square of `side` pixels around the pixel at (θ, φ), as much of it as is in the picture."""
        column = int((1 + np.sin(theta) * np.cos(phi)) * size / 2) - side // 2
        row = int((1 - np.sin(theta) * np.sin(phi)) * size / 2) - side // 2
        return cls(int(np.clip(column, 0, size - side)), int(np.clip(row, 0, size - side)), side, side)
