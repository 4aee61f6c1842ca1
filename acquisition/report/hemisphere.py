"""The frames of a PTM session where their lights were: thumbnails on the hemisphere as the sample sees it."""

from collections.abc import Sequence

import cv2
import numpy as np

from acquisition.report.cells import Cell
from acquisition.report.lettering import write
from acquisition.report.sheets import PAPER, QUIET, Thumb, framed
from litrig.base.directions import direction_from_angles
from litrig.base.radiometry import U8

SIZE_PX = 1152
MOST_CELLS = 150
"""More would hide each other."""
_RING: tuple[int, int, int] = (52, 50, 46)
_COVER = 0.62
"""Share of the disc that the thumbnails cover, were they spread evenly."""
_LARGEST_PX, _SMALLEST_PX = 150, 54


def hemisphere(cells: Sequence[Cell], thumb: Thumb) -> U8:
    """Draw the steps that have a light, (SIZE_PX, SIZE_PX, 3) uint8 RGB.

    The map keeps areas (Lambert's azimuthal projection), so that lights that are spread evenly lie evenly; the rim is
    the horizon, up is y.
    """
    lit = [cell for cell in cells if cell.step.aim is not None]
    pictures = [None if cell.frame is None else thumb(cell) for cell in lit]
    shapes = [picture.shape[:2] for picture in pictures if picture is not None]
    height, width = shapes[0] if shapes else (3, 4)
    reach_px = SIZE_PX / 2 - 48
    ratio = height / width
    cell_px = float(np.sqrt(_COVER * np.pi * reach_px**2 / max(1, len(lit)) / ratio))
    cell_px = min(max(cell_px, _SMALLEST_PX), _LARGEST_PX)
    canvas = _map(reach_px)
    for cell, picture in zip(lit, pictures, strict=True):
        drawn = framed(cell, picture, round(cell_px), (height, width))
        x, y = _place(cell, reach_px)
        _put(canvas, drawn, x, y)
    return canvas


def _map(reach_px: float) -> U8:
    """Draw rings every 15° of elevation, each 30° with its number."""
    canvas = np.full((SIZE_PX, SIZE_PX, 3), PAPER, np.uint8)
    middle, texts = SIZE_PX // 2, []
    for elevation_deg in range(0, 90, 15):
        radius = _radius(elevation_deg) * reach_px
        cv2.circle(canvas, (middle, middle), round(radius), _RING, 2 if elevation_deg == 0 else 1, cv2.LINE_AA)
        if elevation_deg % 30 == 0:
            texts.append(((middle + 4.0, middle + radius + 15), f"{elevation_deg}°", QUIET))
    return write(canvas, texts, 12)


def _radius(elevation_deg: float) -> float:
    """Return the distance from the middle, 1 at the horizon."""
    return float(np.sqrt(1 - np.sin(np.radians(max(0.0, elevation_deg)))))


def _place(cell: Cell, reach_px: float) -> tuple[int, int]:
    aim = cell.step.aim
    assert aim is not None  # noqa: S101  # chosen by the caller
    direction = direction_from_angles(aim.azimuth_deg, aim.elevation_deg)
    flat = float(np.hypot(direction[0], direction[1])) or 1.0
    radius = _radius(aim.elevation_deg) * reach_px
    return round(SIZE_PX / 2 + radius * direction[0] / flat), round(SIZE_PX / 2 - radius * direction[1] / flat)


def _put(canvas: U8, drawn: U8, x: int, y: int) -> None:
    """Lay a picture with its middle on a place, and cut off what lies outside."""
    top, left = y - drawn.shape[0] // 2, x - drawn.shape[1] // 2
    rows = slice(max(0, top), min(canvas.shape[0], top + drawn.shape[0]))
    columns = slice(max(0, left), min(canvas.shape[1], left + drawn.shape[1]))
    canvas[rows, columns] = drawn[rows.start - top : rows.stop - top, columns.start - left : columns.stop - left]
