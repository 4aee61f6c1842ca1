"""Every picture of a stack at once, for work that needs all of them pixel by pixel.

They are kept as they are stored, in codes of 8 or 16 bits; floats stay floats. What is more than a budget of memory
lies in a nameless file that is mapped into it.
"""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import FormatError
from litrig.base.progress import Progress, Report, silent
from litrig.base.radiometry import decode_srgb, encode_srgb
from processing.room import Room, make_room
from processing.stack import Space, Stack

F32 = NDArray[np.float32]
Values = NDArray[Any]

DEFAULT_BUDGET_BYTES = 1_000_000_000
# The rest is for what is made of the pictures, and for those that are just being read.
_SHARE_OF_BUDGET = 0.75
# A decoder of anything but JPEG holds the picture twice before it is copied here.
_COPIES_IN_FLIGHT = 3


class Decoded:
    """All pictures of a stack.

    Attributes
    ----------
    values : (N, H·W·3) uint8, uint16 or float32, RGB pixel by pixel from the top row; may be mapped from a file
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

    @property
    def proportional(self) -> bool:
        """Whether what is meant is `values / white`, and not to be looked up."""
        return self._light is None

    def pixels(self, start: int, stop: int) -> F32:
        """Return some pixels of each picture, (N, stop − start, 3) float32, 1 is white."""
        return self._meant(self.values[:, 3 * start : 3 * stop]).reshape(len(self.values), -1, 3)

    def at(self, pixels: NDArray[np.int64]) -> F32:
        """Return chosen pixels of each picture, (N, n, 3) float32, 1 is white."""
        places = (3 * pixels[:, None] + np.arange(3)).ravel()
        chosen = [picture[places] for picture in self.values]
        self.release()
        return self._meant(np.stack(chosen)).reshape(len(self.values), -1, 3)

    def release(self) -> None:
        """Give back the memory of what was read from the file; reading again maps it again."""
        self._room.release()

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
    _read_all(stack, held, first, budget_bytes, report)
    return held


def _read_all(stack: Stack, held: Decoded, first: Values, budget_bytes: int, report: Report) -> None:
    def read(index: int) -> int:
        picture = first if index == 0 else _stored(stack, index, held.space, held.values[index])
        if picture.dtype != held.values.dtype:
            raise FormatError(
                f"{stack.paths[index]}: holds {picture.dtype} values, the pictures before it {held.values.dtype}; "
                "bring all pictures to one format"
            )
        if not np.shares_memory(picture, held.values[index]):
            held.values[index] = picture.reshape(-1)
        held.release()
        return index

    bytes_in_flight = _COPIES_IN_FLIGHT * first.nbytes
    workers = max(1, min(os.cpu_count() or 1, budget_bytes // max(1, bytes_in_flight)))
    with ThreadPoolExecutor(workers) as pool:
        for done, index in enumerate(pool.map(read, range(len(stack))), 1):
            report(Progress("reading", done, len(stack), stack.paths[index].name))


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
