"""Arrays that live on the disk while they are made, for files whose layout is not the order in which rows come."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from litrig.base.errors import InputError


@contextmanager
def spooled(beside: Path, shape: tuple[int, ...], dtype: DTypeLike) -> Iterator[NDArray[Any]]:
    """Yield an array of zeros that lies in a nameless file in the folder of `beside`, and goes with the body.

    Raises
    ------
    InputError
        The folder does not exist, or has no room for it.
    """
    try:
        with tempfile.TemporaryFile(dir=beside.absolute().parent) as file:
            # Without room a memory map would kill the process at its first full page.
            os.posix_fallocate(file.fileno(), 0, max(1, int(np.prod(shape)) * np.dtype(dtype).itemsize))
            yield np.memmap(file, dtype, "r+", shape=shape)
    except OSError as error:
        raise InputError(
            f"{beside}: cannot be written ({error.strerror or error}); free space, or choose another name or folder"
        ) from error
