"""The pictures of the demo's page."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from litrig.base.capture_folder import layout
from litrig.base.contact_sheet import contact_sheet
from litrig.base.page import Figure
from litrig.base.pictures import read_codes, write_codes
from litrig.base.radiometry import encode_srgb, to_u8

Codes = NDArray[np.uint8]


class Pictures:
    """Writes pictures below the page, and hands out the figures that show them."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        (folder / "pictures").mkdir(parents=True, exist_ok=True)

    def add(self, name: str, codes: Codes, caption: str, *, wide: bool = False) -> Figure:
        """Write one picture, (H, W, 3) or (H, W, 4) uint8."""
        file = f"pictures/{name}.png"
        write_codes(self._folder / file, codes)
        return Figure(file, caption, wide, (codes.shape[1], codes.shape[0]))


def frames_sheet(capture: Path, columns: int, most: int) -> Codes:
    """Lay out the thumbnails of a session, at most so many, evenly chosen."""
    thumbs = sorted((capture / layout.THUMBS).iterdir())
    chosen = [thumbs[i] for i in evenly(len(thumbs), most)]
    return contact_sheet([np.asarray(read_codes(path), np.uint8) for path in chosen], columns, 120)


def slices_sheet(slices: NDArray[np.float32], columns: int, most: int) -> Codes:
    """Lay out slices of an AMC, (D, S, S, 3) linear."""
    return contact_sheet([to_u8(encode_srgb(slices[i])) for i in evenly(len(slices), most)], columns, 128)


def over(picture: NDArray[np.float32], background: Sequence[float] = (0.012, 0.011, 0.010)) -> Codes:
    """Lay a rendered picture, (H, W, 4) linear light and coverage, over a background and encode it."""
    coverage = picture[..., 3:]
    blended = picture[..., :3] * coverage + np.asarray(background, np.float32) * (1 - coverage)
    return to_u8(encode_srgb(blended))


def evenly(count: int, most: int) -> list[int]:
    """Choose at most so many of `count` indices, evenly, beginning with the first."""
    return [i * count // min(count, most) for i in range(min(count, most))]
