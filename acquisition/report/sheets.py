"""Contact sheets: every wanted step as a thumbnail, framed in the colour of what a person should know of it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from acquisition.report.cells import Cell, Colour, Flag, pose_words
from acquisition.report.lettering import fitted, font, write
from acquisition.report.record import Fate
from litrig.base.capture_folder.capture import Role
from litrig.base.contact_sheet import BACKGROUND, contact_sheet
from litrig.base.radiometry import U8

Thumb = Callable[[Cell], U8 | None]

PAGE_PX = 1152
GAP_PX = 6
INK: Colour = (232, 230, 225)
QUIET: Colour = (160, 156, 148)
EMPTY: Colour = (30, 28, 26)
PAPER: Colour = (13, 12, 11)
_FRAME_PX = 3
_USUAL_SHAPE = (3, 4)


@dataclass(frozen=True)
class Look:
    """How a sheet is laid out.

    Attributes
    ----------
    columns : cells a row
    rows : rows a sheet, at most
    letters_px : size of the captions
    """

    columns: int
    rows: int
    letters_px: int

    @property
    def cell_px(self) -> int:
        """The width of a cell."""
        return (PAGE_PX - GAP_PX * (self.columns - 1)) // self.columns


def look_for(cells: int) -> Look:
    """Choose a layout that stays legible: the more cells, the smaller, and then several sheets."""
    if cells <= 48:
        return Look(columns=min(6, max(4, cells)), rows=8, letters_px=13)
    if cells <= 160:
        return Look(columns=8, rows=20, letters_px=12)
    return Look(columns=12, rows=20, letters_px=11)


def sheets(cells: Sequence[Cell], thumb: Thumb, look: Look) -> list[U8]:
    """Draw as many sheets as are needed, each (H, W, 3) uint8 RGB."""
    a_sheet = look.columns * look.rows
    return [_sheet(cells[start : start + a_sheet], thumb, look) for start in range(0, len(cells), a_sheet)]


def grid_sheets(grid: Sequence[Sequence[Cell | None]], thumb: Thumb) -> list[U8]:
    """Draw a product of slices and lights, a row a slice and a column a light; wide or high ones in several sheets."""
    columns = min(len(grid[0]), 12)
    look = Look(columns=max(columns, 4), rows=16, letters_px=11)
    return [
        np.concatenate([_grid_row(row[left : left + columns], thumb, look) for row in grid[top : top + look.rows]])
        for left in range(0, len(grid[0]), columns)
        for top in range(0, len(grid), look.rows)
    ]


def legend(flags: Sequence[Flag]) -> U8:
    """Draw what the colours mean."""
    size_px = 13
    lengths = [font(size_px).getlength(flag.label) for flag in flags]
    picture = np.full((26, PAGE_PX, 3), PAPER, np.uint8)
    x, texts = 4.0, []
    for flag, length in zip(flags, lengths, strict=True):
        cv2.rectangle(picture, (round(x), 7), (round(x) + 16, 19), flag.colour, 2)
        texts.append(((x + 24, 18.0), flag.label, INK))
        x += 24 + length + 26
    return write(picture, texts, size_px)


def framed(cell: Cell, picture: U8 | None, width_px: int, shape: tuple[int, int] = _USUAL_SHAPE) -> U8:
    """Draw the thumbnail of a step in its frame; an empty one if there is no picture.

    Parameters
    ----------
    shape : height and width, to a common factor, of an empty one
    """
    inner_px = width_px - 2 * _FRAME_PX
    flag = cell.flags[0] if cell.flags else None
    if picture is None:
        inner = np.full((round(inner_px * shape[0] / shape[1]), inner_px, 3), EMPTY, np.uint8)
        words = "" if cell.frame is None else "no picture"
        inner = write(inner, [((inner_px / 2, inner.shape[0] / 2), words, QUIET)], 11, "mm")
    else:
        height = max(1, round(inner_px * picture.shape[0] / picture.shape[1]))
        shrinks = inner_px < picture.shape[1]
        inner = np.asarray(
            cv2.resize(picture, (inner_px, height), interpolation=cv2.INTER_AREA if shrinks else cv2.INTER_CUBIC),
            np.uint8,
        )
        if cell.frame is not None and cell.frame.fate is not Fate.COUNTS:
            inner = (inner // 3).astype(np.uint8)
    colour = BACKGROUND if flag is None else flag.colour
    drawn = cv2.copyMakeBorder(inner, *(_FRAME_PX,) * 4, cv2.BORDER_CONSTANT, value=colour)
    if picture is None:
        _dash(np.asarray(drawn, np.uint8))
    return np.asarray(drawn, np.uint8)


def _sheet(cells: Sequence[Cell], thumb: Thumb, look: Look) -> U8:
    pictures = [_draw(cell, thumb, look) for cell in cells]
    return contact_sheet(pictures, look.columns, look.cell_px, GAP_PX)


def _grid_row(row: Sequence[Cell | None], thumb: Thumb, look: Look) -> U8:
    """Draw a slice below its angle; a cell then tells its light alone."""
    angles_deg = {cell.step.angle_deg for cell in row if cell is not None} - {None}
    title = np.full((26, PAGE_PX, 3), BACKGROUND, np.uint8)
    words = f"turntable at {angles_deg.pop():.5g}°" if angles_deg else ""
    title = write(title, [((float(_FRAME_PX), 19.0), words, INK)], 12)
    pictures = [_draw(None if cell is None else _light_alone(cell), thumb, look) for cell in row]
    cells = contact_sheet(pictures, look.columns, look.cell_px, GAP_PX)
    rest_px = PAGE_PX - cells.shape[1]
    filled = cv2.copyMakeBorder(cells, 0, GAP_PX, 0, rest_px, cv2.BORDER_CONSTANT, value=BACKGROUND)
    return np.concatenate([title, np.asarray(filled, np.uint8)])


def _light_alone(cell: Cell) -> Cell:
    """Tell the light in the first line, and exposure and repeat in the second unless there is more to say."""
    which = pose_words(replace(cell.step, role=Role.FRAME, angle_deg=None, aim=None))
    light = replace(cell.step, angle_deg=None, exposure_ev=0.0, repeat=0)
    return replace(cell, step=light, words=cell.words or which)


def _draw(cell: Cell | None, thumb: Thumb, look: Look) -> U8:
    """Draw a cell: the thumbnail in its frame, and two lines below."""
    if cell is None:
        return np.full((4, look.cell_px, 3), BACKGROUND, np.uint8)
    drawn = framed(cell, None if cell.frame is None else thumb(cell), look.cell_px)
    line_px = look.letters_px + 5
    captions = np.full((line_px * (2 if cell.words else 1) + 3, look.cell_px, 3), BACKGROUND, np.uint8)
    width_px = look.cell_px - 2 * _FRAME_PX
    number = f"{cell.step.step}"
    texts = [((float(_FRAME_PX), float(line_px - 3)), number, INK)]
    after_px = font(look.letters_px).getlength(number + "  ")
    pose = fitted(cell.pose, width_px - after_px, look.letters_px)
    texts.append(((_FRAME_PX + after_px, float(line_px - 3)), pose, QUIET))
    if cell.words:
        words = fitted(cell.words, width_px, look.letters_px)
        colour = cell.flags[0].colour if cell.flags else QUIET
        texts.append(((float(_FRAME_PX), float(2 * line_px - 3)), words, colour))
    return np.concatenate([drawn, write(captions, texts, look.letters_px)])


def _dash(drawn: U8) -> None:
    """Break the frame of an empty cell."""
    height, width = drawn.shape[:2]
    for start in range(0, max(height, width), 12):
        for rows, columns in (
            (slice(0, _FRAME_PX), slice(start, start + 5)),
            (slice(height - _FRAME_PX, height), slice(start, start + 5)),
            (slice(start, start + 5), slice(0, _FRAME_PX)),
            (slice(start, start + 5), slice(width - _FRAME_PX, width)),
        ):
            drawn[rows, columns] = BACKGROUND
