"""The packed kinds of `.ptm`: PTM_FORMAT_JPEG_LRGB and PTM_FORMAT_JPEG_RGB, a grey JPEG a plane.

After the biases: the JPEG quality; then seven lists with a number for each plane: transforms, motion vectors in x and
y, order, reference plane (-1 for none), bytes of the JPEG, bytes of side information. Then, plane after plane, the
JPEG, the bottom row first, and its side information: records of a pixel's number (big-endian, four bytes) and its code.
Planes are completed by their place in the order: code = JPEG − 128 + reference, modulo 256, where transform 1 turns the
reference's codes over (255 − code); then the side information takes the place of what the JPEG got wrong. The planes
are those of the plain kinds: six terms and red, green, blue; or six terms of red, of green, of blue.
"""

import re
from pathlib import Path
from typing import BinaryIO, NamedTuple

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import FormatError
from processing.ptm.files.plane_jpeg import decode_planes

U8 = NDArray[np.uint8]

PLAIN_KIND = {"PTM_FORMAT_JPEG_LRGB": "PTM_FORMAT_LRGB", "PTM_FORMAT_JPEG_RGB": "PTM_FORMAT_RGB"}
_PLANES = {"PTM_FORMAT_JPEG_LRGB": 9, "PTM_FORMAT_JPEG_RGB": 18}
_HEADER_BYTES = 8192
_LISTS = 7
_RECORD = np.dtype([("pixel", ">u4"), ("code", "u1")])
_MEND = "export it again, as PTM_FORMAT_LRGB or PTM_FORMAT_RGB"


class _Header(NamedTuple):
    transforms: list[int]
    order: list[int]
    references: list[int]
    jpeg_bytes: list[int]
    side_bytes: list[int]


def unpack(path: Path, file: BinaryIO, kind: str, size: tuple[int, int]) -> U8:
    """Read what follows the biases of a packed file, and leave the file after its last byte.

    Parameters
    ----------
    size : height and width, checked

    Returns
    -------
    payload : the bytes of the plain kind. Of LRGB they are nine a pixel, as version 1.1 has them

    Raises
    ------
    FormatError
        A number or a JPEG is damaged, the file is shorter than its header says, or motion was compensated, which nobody
        is known to have written.
    """
    count = _PLANES[kind]
    header = _read_header(path, file, count)
    planes, side = np.zeros((0, *size), np.uint8), []
    for plane in range(count):
        jpeg = file.read(header.jpeg_bytes[plane])
        codes = decode_planes(path, jpeg, size, grey=True, what=f"plane {plane}")
        if plane == 0:  # memory is taken once a JPEG says the same size as the header
            planes = np.zeros((count, *size), np.uint8)
        planes[plane] = codes
        side.append(_side_information(path, file.read(header.side_bytes[plane]), size, plane))
    for place in range(count):
        plane = header.order.index(place)
        _predict(planes, plane, header.references[plane], inverted=header.transforms[plane] == 1)
        planes[plane].reshape(-1)[side[plane]["pixel"]] = side[plane]["code"]
    if kind == "PTM_FORMAT_JPEG_LRGB":
        return planes.transpose(1, 2, 0).reshape(-1)
    return planes.reshape(3, 6, *size).transpose(0, 2, 3, 1).reshape(-1)


def _predict(planes: U8, plane: int, reference: int, *, inverted: bool) -> None:
    if reference >= 0:
        predicted = ~planes[reference] if inverted else planes[reference]
        # uint8 wraps, as the format has it.
        planes[plane] += predicted
        planes[plane] -= np.uint8(128)


def _read_header(path: Path, file: BinaryIO, count: int) -> _Header:
    start = file.tell()
    numbers = 1 + _LISTS * count
    found = re.match(rb"\s*[-+]?\d{1,9}(?:\s+[-+]?\d{1,9}){%d}[ \t]*\r?\n" % (numbers - 1), file.read(_HEADER_BYTES))
    if found is None:
        raise FormatError(f"{path}: the numbers before its JPEGs are damaged; {_MEND}")
    _, *values = (int(word) for word in found[0].split())
    lists = [values[first : first + count] for first in range(0, len(values), count)]
    transforms, across, up, order, references, jpeg_bytes, side_bytes = lists
    _check(path, {*across, *up} == {0}, "motion is compensated, which is not read")
    _check(path, {*transforms} <= {0, 1}, "a transform is unknown")
    first = min(order)  # some count from 1
    order = [place - first for place in order]
    _check(path, first in (0, 1) and sorted(order) == list(range(count)), "the order of its planes is none")
    for plane, reference in enumerate(references):
        known = reference == -1 or (0 <= reference < count and order[reference] < order[plane])
        _check(path, known, f"plane {plane} refers to plane {reference}, which is not there before it")
    _check(path, min(*jpeg_bytes, *side_bytes) >= 0, "a plane has less than no bytes")
    promised = sum(jpeg_bytes) + sum(side_bytes)
    there = path.stat().st_size - start - found.end()
    if there < promised:
        raise FormatError(
            f"{path}: its planes want {promised:,} bytes, the file has {there:,}; it was cut short, copy it again"
        )
    file.seek(start + found.end())
    return _Header(transforms, order, references, jpeg_bytes, side_bytes)


def _side_information(path: Path, stored: bytes, size: tuple[int, int], plane: int) -> NDArray[np.void]:
    _check(path, len(stored) % _RECORD.itemsize == 0, f"the side information of plane {plane} is no whole records")
    records = np.frombuffer(stored, _RECORD)
    inside = bool(np.all(records["pixel"] < size[0] * size[1]))
    _check(path, inside, f"the side information of plane {plane} mends pixels outside the picture")
    return records


def _check(path: Path, holds: bool, otherwise: str) -> None:
    if not holds:
        raise FormatError(f"{path}: {otherwise}; {_MEND}")
