"""Compiling numerical loops."""

from collections.abc import Callable
from typing import ParamSpec, TypeVar

import numba

P = ParamSpec("P")
T = TypeVar("T")


def kernel(function: Callable[P, T]) -> Callable[P, T]:
    """Compile a function of arrays and numbers at its first call, without holding the interpreter's lock.

    It divides by zero as arrays do, without an error, for the test would keep a loop from being run in vectors;
    products may be added without rounding them first.

    The machine code is kept beside the source for the next process, or in the user's cache where that cannot be
    written; where neither can, each process compiles anew.
    """
    try:
        compiled: Callable[P, T] = numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})(
            function
        )
    except RuntimeError:  # numba's word for no place to keep it
        compiled = numba.njit(nogil=True, error_model="numpy", fastmath={"contract"})(function)
    return compiled
