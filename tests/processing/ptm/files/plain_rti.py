"""A second reader of `.rti`, written from the description of the format alone."""

import math
import struct
from pathlib import Path

import numpy as np
from numpy.typing import NDArray


def harmonics(x: float, y: float, z: float) -> list[float]:
    """The first nine, as the description lists them."""
    c = math.cos(min(math.acos(z), math.pi / 2 - 0.01))
    phi = math.atan2(y, x)
    q = math.sqrt(c - c * c)
    return [
        1 / math.sqrt(2 * math.pi),
        math.sqrt(6 / math.pi) * math.cos(phi) * q,
        math.sqrt(3 / (2 * math.pi)) * (2 * c - 1),
        math.sqrt(6 / math.pi) * math.sin(phi) * q,
        math.sqrt(30 / math.pi) * math.cos(2 * phi) * (c * c - c),
        math.sqrt(30 / math.pi) * math.cos(phi) * (2 * c - 1) * q,
        math.sqrt(5 / (2 * math.pi)) * (1 - 6 * c + 6 * c * c),
        math.sqrt(30 / math.pi) * math.sin(phi) * (2 * c - 1) * q,
        math.sqrt(30 / math.pi) * math.sin(2 * phi) * (c * c - c),
    ]


def plain_picture(path: Path, u: float, v: float) -> NDArray[np.float64]:
    """Read an .rti of HSH byte by byte and relight it: (H, W, 3) where 1 is white, row 0 on top."""
    content = path.read_bytes()
    lines: list[str] = []
    place = 0
    while sum(not line.startswith("#") for line in lines) < 3:
        end = content.index(b"\r\n", place)
        lines.append(content[place:end].decode("ascii"))
        place = end + 2
    assert lines[0] == "#HSH1.2"
    kind, sizes, coding = [line.split(" ") for line in lines if not line.startswith("#")]
    assert kind == ["3"]
    width, height, channels = map(int, sizes)
    terms, apart, code_bytes = map(int, coding)
    assert (channels, apart, code_bytes) == (3, 2, 1)
    scales = struct.unpack_from(f"<{terms}f", content, place)
    biases = struct.unpack_from(f"<{terms}f", content, place + 4 * terms)
    place += 8 * terms
    weights = harmonics(u, v, math.sqrt(1 - u * u - v * v))
    picture = np.zeros((height, width, 3))
    for row in range(height):
        for column in range(width):
            for channel in range(3):
                for term in range(terms):
                    value = content[place] / 255 * scales[term] + biases[term]
                    picture[row, column, channel] += weights[term] * value
                    place += 1
    return picture
