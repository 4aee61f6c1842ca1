"""The balls cut out of every picture: all that the search for highlights needs to keep."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from litrig.base.camera_model import CameraModel
from litrig.base.progress import Progress, Report
from processing.outline.circle import Circle
from processing.ptm.lights.highlight import Highlight
from processing.ptm.lights.mirror import Mirror
from processing.stack import Stack

F32 = NDArray[np.float32]

_LARGEST_RADIUS_PX = 300
_AROUND = 1.25


@dataclass(frozen=True)
class CropFrame:
    """Which part of the pictures is cut out, and by which whole factor it is shrunk."""

    left_px: int
    top_px: int
    width_px: int
    height_px: int
    factor: int

    @classmethod
    def around(cls, circle: Circle, shape: tuple[int, int]) -> "CropFrame":
        """Return the frame around a circle in pictures of this shape (H, W)."""
        factor = max(1, int(np.ceil(circle.radius_px / _LARGEST_RADIUS_PX)))
        reach = _AROUND * circle.radius_px
        left, top = max(0, int(circle.x_px - reach)), max(0, int(circle.y_px - reach))
        right, bottom = min(shape[1], int(circle.x_px + reach) + 1), min(shape[0], int(circle.y_px + reach) + 1)
        return cls(left, top, (right - left) // factor * factor, (bottom - top) // factor * factor, factor)

    def cut(self, grey: F32) -> F32:
        """Cut out of a picture (H, W)."""
        part = grey[self.top_px : self.top_px + self.height_px, self.left_px : self.left_px + self.width_px]
        size = (self.width_px // self.factor, self.height_px // self.factor)
        return np.array(part if self.factor == 1 else cv2.resize(part, size, interpolation=cv2.INTER_AREA))

    def inner(self, circle: Circle) -> Circle:
        """Return a circle of the pictures in pixels of the crops."""
        return Circle(
            (circle.x_px - self.left_px) / self.factor,
            (circle.y_px - self.top_px) / self.factor,
            circle.radius_px / self.factor,
        )

    def outer(self, circle: Circle) -> Circle:
        """Return a circle of the crops in pixels of the pictures."""
        return Circle(
            circle.x_px * self.factor + self.left_px,
            circle.y_px * self.factor + self.top_px,
            circle.radius_px * self.factor,
        )

    def inner_mirror(self, mirror: Mirror) -> Mirror:
        """Return a ball in pixels of the crops."""
        return Mirror(self.inner(mirror.circle), None if mirror.camera is None else self.inner_camera(mirror.camera))

    def outer_highlight(self, found: Highlight) -> Highlight:
        """Return a highlight in pixels of the pictures."""
        x_px, y_px = found.x_px * self.factor + self.left_px, found.y_px * self.factor + self.top_px
        return Highlight(x_px, y_px, found.spread_px * self.factor, found.flags)

    def inner_camera(self, camera: CameraModel) -> CameraModel:
        """Return a camera of the pictures as that of the crops."""
        return camera.model_copy(
            update={
                "width": max(1, self.width_px // self.factor),
                "height": max(1, self.height_px // self.factor),
                "focal_x_px": camera.focal_x_px / self.factor,
                "focal_y_px": camera.focal_y_px / self.factor,
                "centre_x_px": (camera.centre_x_px - self.left_px) / self.factor,
                "centre_y_px": (camera.centre_y_px - self.top_px) / self.factor,
            }
        )


def cut_out(stack: Stack, frames: Sequence[CropFrame], report: Report) -> list[F32]:
    """Cut the balls out of every picture, each (N, h, w) linear grey."""
    # Of large pictures no more is held than the part with all balls in it.
    left, top = min(frame.left_px for frame in frames), min(frame.top_px for frame in frames)
    right = max(frame.left_px + frame.width_px for frame in frames)
    bottom = max(frame.top_px + frame.height_px for frame in frames)
    inner = [replace(frame, left_px=frame.left_px - left, top_px=frame.top_px - top) for frame in frames]

    def cut(_index: int, picture: F32) -> list[F32]:
        grey = picture.mean(axis=-1)
        return [frame.cut(grey) for frame in inner]

    crops: list[list[F32]] = []
    for index, parts in enumerate(stack.each((slice(top, bottom), slice(left, right)), cut)):
        crops.append(parts)
        report(Progress("looking at the balls", index + 1, len(stack), stack.paths[index].name))
    return [np.stack(parts) for parts in zip(*crops, strict=True)]
