"""Room for slices: in memory, or in a nameless file where they are many.

What a program maps from a file the system can take back at any time, and brings it again when it is touched. So slices
of any number pass through the memory of a few, as long as who looks at a little of each says when that is done. Rows of
all slices are read and written past the mapping, for a touch brings far more than the row.
"""

import mmap
import os
import tempfile
import weakref
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError

F32 = NDArray[np.float32]

MOST_IN_MEMORY_BYTES = 1 << 28


@dataclass(frozen=True)
class Room:
    """Slices and where they are.

    Attributes
    ----------
    array : (N, S, S, 3) float32
    mapped, file : the mapping and the descriptor of what the array is the content of; None in memory
    """

    array: F32
    mapped: mmap.mmap | None = None
    file: int | None = None

    def release(self) -> None:
        """Give memory back; the array keeps what it holds."""
        if self.mapped is not None:
            self.mapped.madvise(mmap.MADV_DONTNEED)

    def rows(self, rows: slice) -> F32:
        """Read some rows of all slices, (N, rows, S, 3)."""
        if self.file is None:
            return self.array[:, rows]
        part = np.zeros_like(self.array[:, rows])
        for index, one in enumerate(part):
            os.preadv(self.file, [one.data], self._place(index, rows))
        return part

    def put_rows(self, rows: slice, values: F32) -> None:
        """Write some rows (M, rows, S, 3) of the first M slices."""
        if self.file is None:
            self.array[: len(values), rows] = values
            return
        for index, one in enumerate(values):
            os.pwritev(self.file, [np.ascontiguousarray(one).data], self._place(index, rows))

    def _place(self, index: int, rows: slice) -> int:
        return int(index * self.array.strides[0] + rows.start * self.array.strides[1])


def make_room(shape: tuple[int, ...]) -> Room:
    """Make room in memory for up to 256 MiB, and beyond in a file that vanishes with the array; zeros both.

    Raises
    ------
    InputError
        The folder for temporary files has no space for it.
    """
    count = int(np.prod(shape))
    if 4 * count <= MOST_IN_MEMORY_BYTES:
        return Room(np.zeros(shape, np.float32))
    try:
        with tempfile.TemporaryFile() as file:
            os.posix_fallocate(file.fileno(), 0, 4 * count)  # a full disk is told now, not by the death of the program
            mapped, descriptor = mmap.mmap(file.fileno(), 4 * count), os.dup(file.fileno())
    except OSError as error:
        raise InputError(
            f"{tempfile.gettempdir()}: has no {4 * count / 2**20:.0f} MiB for the slices ({error.strerror}); free "
            "space, name another folder in TMPDIR, or choose a smaller --size"
        ) from error
    weakref.finalize(mapped, os.close, descriptor)
    return Room(np.frombuffer(mapped, np.float32).reshape(shape), mapped, descriptor)
