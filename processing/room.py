"""Room for large arrays: in memory, or in a nameless file where they are more than that.

What a program maps from a file the system can take back at any time, and brings it again when it is touched. So arrays
of any size pass through little memory, as long as who looks at a part of each picture says when that is done. Rows of
many pictures are read and written past the mapping, for a touch brings far more than the row. The file goes with the
array, however the program ends.
"""

import mmap
import os
import tempfile
import weakref
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from litrig.base.errors import InputError

MOST_IN_MEMORY_BYTES = 1 << 28


@dataclass(frozen=True)
class Room:
    """An array and where it is.

    Attributes
    ----------
    array : (N, H, …), pictures of one size
    mapped, file : the mapping and the descriptor of what the array is the content of; None in memory
    """

    array: NDArray[Any]
    mapped: mmap.mmap | None = None
    file: int | None = None

    def release(self) -> None:
        """Give memory back; the array keeps what it holds."""
        if self.mapped is not None:
            self.mapped.madvise(mmap.MADV_DONTNEED)

    def rows(self, rows: slice) -> NDArray[Any]:
        """Read some rows of all pictures, (N, rows, …)."""
        if self.file is None:
            return self.array[:, rows]
        part = np.zeros_like(self.array[:, rows])
        for index, one in enumerate(part):
            os.preadv(self.file, [one.data], self._place(index, rows))
        return part

    def put_rows(self, rows: slice, values: NDArray[Any]) -> None:
        """Write some rows (M, rows, …) of the first M pictures."""
        if self.file is None:
            self.array[: len(values), rows] = values
            return
        for index, one in enumerate(values):
            os.pwritev(self.file, [np.ascontiguousarray(one).data], self._place(index, rows))

    def put(self, index: int, values: NDArray[Any]) -> None:
        """Write one picture, past the mapping as well."""
        if self.file is None:
            self.array[index] = values
            return
        rest, place = np.ascontiguousarray(values).data.cast("B"), index * self.array.strides[0]
        while rest:  # the system writes no more than two gigabytes at once
            written = os.pwrite(self.file, rest, place)
            rest, place = rest[written:], place + written

    def _place(self, index: int, rows: slice) -> int:
        return int(index * self.array.strides[0] + rows.start * self.array.strides[1])


def make_room(
    shape: tuple[int, ...],
    dtype: DTypeLike = np.float32,
    *,
    most_in_memory_bytes: int | None = None,
    folder: Path | None = None,
    advice: str = "name another folder in TMPDIR",
) -> Room:
    """Make room in memory, or beyond a limit in a file that vanishes with the array; zeros both.

    Parameters
    ----------
    most_in_memory_bytes : the limit; 256 MiB by default
    folder : on a disk with room; by default where temporary files go
    advice : what else a person could do if there is no room

    Raises
    ------
    InputError
        The folder has no space for it.
    """
    size = int(np.prod(shape)) * np.dtype(dtype).itemsize
    if size <= (MOST_IN_MEMORY_BYTES if most_in_memory_bytes is None else most_in_memory_bytes):
        return Room(np.zeros(shape, dtype))
    place = folder or Path(tempfile.gettempdir())
    try:
        with tempfile.TemporaryFile(dir=place) as file:
            os.posix_fallocate(file.fileno(), 0, size)  # a full disk is told now, not by the death of the program
            mapped, descriptor = mmap.mmap(file.fileno(), size), os.dup(file.fileno())
    except OSError as error:
        raise InputError(
            f"{place}: has no {size / 2**20:.0f} MiB for a while ({error.strerror}); free space, or {advice}"
        ) from error
    weakref.finalize(mapped, os.close, descriptor)
    return Room(np.frombuffer(mapped, dtype).reshape(shape), mapped, descriptor)
