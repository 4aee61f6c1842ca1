"""Puts pictures with labels on a sheet."""

import io
from pathlib import Path
from typing import NamedTuple

from PIL import Image, ImageDraw, ImageFont

CELL_PX = 296
GAP_PX = 8
LABEL_PX = 26
TEXT_PX = 17
PAPER, INK = "#f4f3f0", "#222222"
LIMIT_BYTES = 150_000


class Cell(NamedTuple):
    """A picture and what is written below it; a ball is cut out of the black that is around it.

    An inset is a little ball in the upper corner, the left one or the right one.
    """

    label: str
    picture: Path | Image.Image
    ball: bool = False
    inset: Path | None = None
    on_right: bool = False


def write_sheet(path: Path, rows: list[list[Cell]], cell_px: int = CELL_PX) -> None:
    """Write rows of cells as a JPEG, as good as the limit allows."""
    across = max(len(row) for row in rows)
    step, tall = cell_px + GAP_PX, cell_px + LABEL_PX + GAP_PX
    sheet = Image.new("RGB", (across * step + GAP_PX, len(rows) * tall + GAP_PX), PAPER)
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(size=TEXT_PX)
    for down, row in enumerate(rows):
        for right, cell in enumerate(row):
            x, y = GAP_PX + right * step, GAP_PX + down * tall
            _lay(sheet, cell, cell_px, (x, y))
            if cell.inset is not None:
                little = cell_px // 4
                _lay(
                    sheet,
                    Cell("", cell.inset, ball=True),
                    little,
                    (x + (cell_px - little if cell.on_right else 4), y + 4),
                )
            pen.text((x + cell_px / 2, y + cell_px + 3), cell.label, fill=INK, font=font, anchor="mt")
    path.write_bytes(_jpeg(sheet))


def _lay(sheet: Image.Image, cell: Cell, side: int, at: tuple[int, int]) -> None:
    opened = cell.picture if isinstance(cell.picture, Image.Image) else Image.open(cell.picture)
    picture = opened.convert("RGB").resize((side, side), Image.Resampling.LANCZOS)
    if not cell.ball:
        sheet.paste(picture, at)
        return
    mask = Image.new("L", (4 * side, 4 * side))
    ImageDraw.Draw(mask).ellipse((4, 4, 4 * side - 5, 4 * side - 5), fill=255)
    sheet.paste(picture, at, mask.resize((side, side), Image.Resampling.LANCZOS))


def _jpeg(sheet: Image.Image) -> bytes:
    for quality in range(93, 20, -3):
        data = io.BytesIO()
        sheet.save(data, "JPEG", quality=quality, optimize=True, progressive=True)
        if data.tell() < LIMIT_BYTES:
            break
    return data.getvalue()
