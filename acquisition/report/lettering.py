"""Words on pictures."""

from collections.abc import Sequence
from functools import cache

import numpy as np
from matplotlib.font_manager import findfont
from PIL import Image, ImageDraw, ImageFont

from litrig.base.radiometry import U8

Colour = tuple[int, int, int]


@cache
def font(size_px: int) -> ImageFont.FreeTypeFont:
    """Return the font of the plots, which matplotlib brings along."""
    return ImageFont.truetype(findfont("DejaVu Sans"), size_px)


def write(
    picture: U8, texts: Sequence[tuple[tuple[float, float], str, Colour]], size_px: int, anchor: str = "ls"
) -> U8:
    """Return a picture (H, W, 3) with words on it.

    Parameters
    ----------
    texts : place in pixels (x, y), words, colour RGB
    anchor : what of the words is at the place, as Pillow has it: `ls` is the left end of the baseline
    """
    image = Image.fromarray(picture)
    draw = ImageDraw.Draw(image)
    for place, words, colour in texts:
        draw.text(place, words, fill=colour, font=font(size_px), anchor=anchor)
    return np.array(image)


def fitted(words: str, width_px: float, size_px: int) -> str:
    """Cut words short, so that they fit a width."""
    if font(size_px).getlength(words) <= width_px:
        return words
    while words and font(size_px).getlength(words + "…") > width_px:
        words = words[:-1]
    return words + "…" if words else ""
