"""Many pictures on one sheet."""

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

BACKGROUND = (13, 12, 11)


def contact_sheet(
    pictures: Sequence[NDArray[np.uint8]], columns: int, cell_width: int, gap: int = 4
) -> NDArray[np.uint8]:
    """Lay pictures out in rows, left to right and top to bottom.

    Parameters
    ----------
    pictures : (H, W, 3) uint8 RGB each; scaled to `cell_width`, each row as high as its highest
    columns : pictures a row

    Returns
    -------
    sheet : (h, w, 3) uint8 RGB
    """
    cells = [_scaled(picture, cell_width) for picture in pictures]
    rows = [cells[start : start + columns] for start in range(0, len(cells), columns)]
    heights = [max(cell.shape[0] for cell in row) for row in rows]
    shape = (sum(heights) + gap * (len(rows) - 1), columns * cell_width + gap * (columns - 1), 3)
    sheet = np.full(shape, BACKGROUND, np.uint8)
    top = 0
    for row, height in zip(rows, heights, strict=True):
        for column, cell in enumerate(row):
            left = column * (cell_width + gap)
            sheet[top : top + cell.shape[0], left : left + cell_width] = cell
        top += height + gap
    return sheet


def _scaled(picture: NDArray[np.uint8], width: int) -> NDArray[np.uint8]:
    height = max(1, round(picture.shape[0] * width / picture.shape[1]))
    shrinks = width < picture.shape[1]
    resized = cv2.resize(picture, (width, height), interpolation=cv2.INTER_AREA if shrinks else cv2.INTER_CUBIC)
    return np.asarray(resized, np.uint8)
