"""Where on a picture, or in its scene, a relief lies."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.shape.editing.operations import Across
from processing.shape.editing.tilt import unit
from processing.shape.model import BACKGROUND, ShadingBuffers

F32 = NDArray[np.float32]


@dataclass(frozen=True)
class Ground:
    """The points that a relief is a function of.

    Attributes
    ----------
    points : (H, W, 3) float32, pixels to the right and up with z = 0, or positions in the scene
    to_right, to_top : (3,) unit, orthogonal, along which a picture is laid
    middle : (3,)
    faces : (H, W), whether a surface can be seen by what is projected there
    step : distance of neighbouring pixels' points at the middle
    """

    points: F32
    to_right: F32
    to_top: F32
    middle: F32
    faces: NDArray[np.bool_]
    step: float

    @classmethod
    def of(cls, buffers: ShadingBuffers, across: Across, at: tuple[float, float] | None) -> Self:
        """Lay the ground around a place in the picture (column, row); None is its middle, or the scene's origin.

        Raises
        ------
        InputError
            The place is outside the picture, or shows no surface to lay anything on; or there are no positions.
        """
        height, width = buffers.shape
        shown = buffers.surfaces != BACKGROUND
        column, row = at or (width / 2, height / 2)
        if not (0 <= column < width and 0 <= row < height):
            raise InputError(f"a place at {column:g}, {row:g} is outside the picture of {width} × {height} pixels")
        if across == "screen":
            x, y = np.meshgrid(np.arange(width) + 0.5, height - np.arange(height) - 0.5)
            points = np.stack([x, y, np.zeros_like(x)], axis=-1).astype(np.float32)
            right, top = np.eye(3, dtype=np.float32)[:2]
            return cls(points, right, top, np.array([column, height - row, 0], np.float32), shown, 1.0)
        if buffers.orthographic and np.ptp(buffers.positions[shown][:, :2]) == 0:
            raise InputError('positions: the buffers have none; lay it across the "screen", or render positions')
        pixel = (int(row), int(column))
        if at is None:
            right, top, origin = np.eye(2, 3, dtype=np.float32)[0], np.eye(2, 3, dtype=np.float32)[1], np.zeros(3)
            return cls(buffers.positions, right, top, origin.astype(np.float32), shown, _step(buffers))
        if not shown[pixel]:
            raise InputError(f"a place at {column:g}, {row:g} shows no surface; choose one that does")
        n = buffers.normals[pixel]
        right = unit(np.array([1, 0, 0], np.float32) - n[0] * n)
        if not np.any(right):
            right = np.array([0, 0, -1], np.float32)
        faces = shown & (buffers.normals @ n > 0)
        return cls(buffers.positions, right, np.cross(n, right), buffers.positions[pixel], faces, _step(buffers))

    def turned(self, degrees: float) -> tuple[F32, F32]:
        """Return the two directions of a picture that is turned counter-clockwise."""
        cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        return (cos * self.to_right + sin * self.to_top).astype(np.float32), (
            cos * self.to_top - sin * self.to_right
        ).astype(np.float32)


def _step(buffers: ShadingBuffers) -> float:
    """Return the median distance of neighbouring pixels' positions."""
    inside = (buffers.surfaces[:, 1:] == buffers.surfaces[:, :-1]) & (buffers.surfaces[:, 1:] != BACKGROUND)
    apart = np.linalg.norm(np.diff(buffers.positions, axis=1), axis=-1)[inside]
    return float(np.median(apart)) if apart.size else 1.0
