"""A second reader of `.ptm`, written from the description of the format alone."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray


def plain_picture(path: Path, u: float, v: float) -> NDArray[np.float64]:
    """Read a PTM_1.2 file byte by byte and relight it: (H, W, 3) in units where 255 is white, row 0 on top."""
    content = path.read_bytes()
    lines: list[str] = []
    place = 0
    while len(lines) < 6:
        end = content.index(b"\n", place)
        lines.append(content[place:end].decode("ascii"))
        place = end + 1
    assert lines[0] == "PTM_1.2"
    width, height = int(lines[2]), int(lines[3])
    scales, biases = [float(word) for word in lines[4].split(" ")], [int(word) for word in lines[5].split(" ")]
    terms = [u * u, v * v, u * v, u, v, 1.0]
    picture = np.zeros((height, width, 3))
    for pixel in range(width * height):
        row, column = height - 1 - pixel // width, pixel % width

        def polynomial(start: int) -> float:
            codes = content[start : start + 6]
            return sum(t * (c - b) * s for t, c, b, s in zip(terms, codes, biases, scales, strict=True))

        if lines[1] == "PTM_FORMAT_RGB":
            for channel in range(3):
                picture[row, column, channel] = polynomial(place + (channel * width * height + pixel) * 6)
        else:
            assert lines[1] == "PTM_FORMAT_LRGB"
            colour = place + width * height * 6 + pixel * 3
            luminance = polynomial(place + pixel * 6)
            picture[row, column] = [luminance * code / 255 for code in content[colour : colour + 3]]
    return picture
