"""Lights so near that their direction and brightness differ over the picture."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.radiometry import decode_srgb
from processing.stack import Space

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]


@dataclass(frozen=True)
class NearLights:
    """Where the lights stood, and how large the picture is.

    Attributes
    ----------
    positions_mm : (N, 3) in the view frame, the origin at the picture's centre, in the plane of the object
    picture_width_mm : width of what the picture shows, in that plane
    """

    positions_mm: F64
    picture_width_mm: float

    def __post_init__(self) -> None:
        if not self.picture_width_mm > 0:
            raise InputError(f"a picture of {self.picture_width_mm:g} mm has no width; say how much it shows")
        if not np.all(np.isfinite(self.positions_mm)):
            raise InputError("a light's position is not a number; measure the lights again")

    @property
    def central_directions(self) -> F64:
        """Directions (N, 3) at the picture's centre, unit, view frame."""
        directions: F64 = self.positions_mm / np.linalg.norm(self.positions_mm, axis=1, keepdims=True)
        return directions

    def at(self, pixels: NDArray[np.int64], shape: tuple[int, int]) -> tuple[F64, F32]:
        """Tell what each light does at some pixels.

        Parameters
        ----------
        pixels : (P,) indices into the picture row by row
        shape : height and width of the picture

        Returns
        -------
        directions : (N, P, 3) unit, view frame, pixel to light
        gains : (N, P) by what the light's effect must be multiplied to be that of a light at the mean distance: it
            falls with the square of the distance
        """
        height, width = shape
        mm_per_px = self.picture_width_mm / width
        rows, columns = np.divmod(pixels, width)
        place = np.stack([columns + 0.5 - width / 2, height / 2 - rows - 0.5, np.zeros(len(pixels))], axis=-1)
        way = self.positions_mm[:, None] - place * mm_per_px
        distance = np.linalg.norm(way, axis=-1, keepdims=True)
        mean = np.linalg.norm(self.positions_mm, axis=1).mean()
        return way / distance, ((distance[..., 0] / mean) ** 2).astype(np.float32)


def brighten(values: F32, gains: F32, space: Space) -> F32:
    """Multiply light, also where values are display-encoded; nothing is cut off at white.

    Parameters
    ----------
    values : (N, P, 3)
    gains : (N, 1 or P, 1 or 3)
    """
    light = (decode_srgb(values) if space == "srgb" else values) * gains
    if space == "linear":
        return light
    return np.where(light <= 0.0031308, light * 12.92, 1.055 * np.maximum(light, 0) ** (1 / 2.4) - 0.055).astype(
        np.float32
    )
