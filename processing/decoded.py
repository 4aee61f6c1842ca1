"""Every picture of a stack at once, for work that needs all of them pixel by pixel.

They are kept as they are stored, in codes of 8 or 16 bits; floats stay floats. What is more than a budget of memory
lies in a nameless file.
"""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import FormatError
from litrig.base.pictures import JPEG_ENDINGS
from litrig.base.progress import Progress, Report, silent
from litrig.base.radiometry import decode_srgb, encode_srgb
from processing.room import Room, make_room
from processing.stack import Space, Stack

F32 = NDArray[np.float32]
Values = NDArray[Any]

DEFAULT_BUDGET_BYTES = 1_000_000_000
# The rest is for what is made of the pictures, and for those that are just being read.
_SHARE_OF_BUDGET = 0.75
# Decoding anything but a JPEG, or to floats, holds a picture more than once before it is kept here.
_COPIES_IN_FLIGHT, _COPIES_OF_A_JPEG = 3, 1


class Decoded:
    """All pictures of a stack.

    Attributes
    ----------
    values : (N, H·W·3) uint8, uint16 or float32, RGB pixel by pixel from the top row; mapped from a file if spooled
    shape : height and width
    space : which values are meant
    white : the value that stands for 1
    """

    def __init__(self, room: Room, shape: tuple[int, int], space: Space) -> None:
        values: Values = room.array
        self.values = values
        self.shape = shape
        self.space = space
        self._room = room
        self.white = 1.0 if values.dtype == np.float32 else float(np.iinfo(values.dtype).max)
        # Codes are display values; light is looked up.
        self._light = None
        if space == "linear" and values.dtype != np.float32:
            self._light = decode_srgb(np.arange(self.white + 1) / self.white)

    @property
    def spooled(self) -> bool:
        """Whether they lie in a file."""
        return self._room.mapped is not None

    def put(self, index: int, picture: Values) -> None:
        """Keep a picture (H, W, 3)."""
        self._room.put(index, picture.reshape(-1))

    @property
    def proportional(self) -> bool:
        """Whether what is meant is `values / white`, and not to be looked up."""
        return self._light is None

    def window(self, start: int, stop: int) -> tuple[Values, int]:
        """Return an array (N, V) of codes, and the place in it at which some pixels' R, G, B begin."""
        if self.spooled:
            return self._room.rows(slice(3 * start, 3 * stop)), 0
        return self.values, 3 * start

    def pixels(self, start: int, stop: int) -> F32:
        """Return some pixels of each picture, (N, stop − start, 3) float32, 1 is white."""
        values, first = self.window(start, stop)
        return self._meant(values[:, first : first + 3 * (stop - start)]).reshape(len(values), -1, 3)

    def at(self, pixels: NDArray[np.int64]) -> F32:
        """Return chosen pixels of each picture, (N, n, 3) float32, 1 is white."""
        width = self.shape[1]
        chosen = np.zeros((len(self.values), len(pixels), 3), self.values.dtype)
        rows = pixels // width
        for row in np.unique(rows) if self.spooled else ():  # one reading for all pixels of a row
            here = rows == row
            values = self.window(row * width, (row + 1) * width)[0].reshape(len(self.values), width, 3)
            chosen[:, here] = values[:, pixels[here] - row * width]
        if not self.spooled:
            places = (3 * pixels[:, None] + np.arange(3)).ravel()
            chosen[:] = np.stack([picture[places] for picture in self.values]).reshape(chosen.shape)
        return self._meant(chosen)

    def _meant(self, values: Values) -> F32:
        if self._light is not None:
            return self._light.take(values)
        return values.astype(np.float32) * np.float32(1 / self.white)


def decoded(
    stack: Stack,
    space: Space,
    *,
    budget_bytes: int = DEFAULT_BUDGET_BYTES,
    spool: Path | None = None,
    report: Report = silent,
) -> Decoded:
    """Read every picture of a stack; what is spooled vanishes with what is returned.

    Parameters
    ----------
    space : display values or linear light
    budget_bytes : more than this is spooled
    spool : folder on a disk with room; by default where temporary files go

    Raises
    ------
    InputError, FormatError
        A picture is missing, damaged, or of another size or depth than the first; the spool has no room.
    """
    first = _stored(stack, 0, space)
    height, width = stack.shape
    room = make_room(
        (len(stack), height * width * 3),
        first.dtype,
        most_in_memory_bytes=int(_SHARE_OF_BUDGET * budget_bytes),
        folder=spool,
        advice="name another folder with --spool, or raise --memory",
    )
    held = Decoded(room, (height, width), space)
    held.put(0, first)
    picture_bytes = first.nbytes
    del first  # it may be a large part of the budget
    report(Progress("reading", 1, len(stack), stack.paths[0].name))
    _read_others(stack, held, _at_once(stack, picture_bytes, budget_bytes), report)
    return held


def _read_others(stack: Stack, held: Decoded, workers: int, report: Report) -> None:
    def read(index: int) -> None:
        into = None if held.spooled else held.values[index]
        picture = _stored(stack, index, held.space, into)
        if picture.dtype != held.values.dtype:
            raise FormatError(
                f"{stack.paths[index]}: holds {picture.dtype} values, the pictures before it {held.values.dtype}; "
                "bring all pictures to one format"
            )
        if into is None or not np.shares_memory(picture, into):
            held.put(index, picture)

    with ThreadPoolExecutor(workers) as pool:
        for index, _ in enumerate(pool.map(read, range(1, len(stack))), 1):
            report(Progress("reading", index + 1, len(stack), stack.paths[index].name))


def _at_once(stack: Stack, picture_bytes: int, budget_bytes: int) -> int:
    """Return how many pictures may be decoded at a time."""
    jpegs = all(path.suffix.lower() in JPEG_ENDINGS for path in stack.paths)
    bytes_in_flight = (_COPIES_OF_A_JPEG if jpegs else _COPIES_IN_FLIGHT) * picture_bytes
    return max(1, min(os.cpu_count() or 1, budget_bytes // max(1, bytes_in_flight)))


def _stored(stack: Stack, index: int, space: Space, into: Values | None = None) -> Values:
    """Return a picture (H, W, 3) as it is kept."""
    picture: Values = stack.stored(index, into)
    return encode_srgb(picture) if picture.dtype == np.float32 and space == "srgb" else picture


def spread(shape: tuple[int, int], count: int, most_rows: int = 96) -> NDArray[np.int64]:
    """Choose pixels from all over a picture, the same ones each time.

    They stand in few rows, so that little of a mapped file is touched, and at random in each, so that no pattern of the
    picture falls in step with them.

    Returns
    -------
    pixels : (n,) indices into the picture row by row, n about `count` or all of them where there are no more
    """
    height, width = shape
    if height * width <= count:
        return np.arange(height * width)
    random = np.random.default_rng(0)
    rows: Sequence[int] = np.unique(np.linspace(0, height - 1, min(height, most_rows)).astype(int)).tolist()
    each = min(width, -(-count // len(rows)))
    return np.concatenate([row * width + np.sort(random.choice(width, each, replace=False)) for row in rows])
