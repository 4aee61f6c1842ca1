"""Reading with trimesh: whatever it stumbles over is one clear error."""

import io
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from litrig.base.errors import FormatError, InputError
from processing.mesh.files.pieces import F64, I64


def read_by_library(path: Path, content: bytes, load: Callable[[io.BytesIO], Any]) -> Any:
    """Call one of trimesh's readers on a file's content; it gets no way to other files.

    Raises
    ------
    FormatError
        The reader fails, or warns that it guesses.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return load(io.BytesIO(content))
    except InputError:
        raise
    # Damaged files end the readers by whatever comes first: an index, a shape, a type, an assertion.
    except Exception as error:
        lines = str(error).splitlines()
        reason = lines[0][:100] if lines else type(error).__name__
        raise FormatError(f"{path}: is damaged or no {path.suffix[1:].upper()} ({reason}); export it again") from error


def table(values: Any, width: int) -> F64:
    """Return (N, width) float64.

    Raises
    ------
    ValueError
        The values are of another shape.
    """
    array = np.asarray(values, np.float64)
    if array.ndim != 2 or array.shape[1] != width:
        raise ValueError(f"an array of shape {array.shape}")
    return array


def triangle_table(values: Any) -> I64:
    """Return (T, 3) int64; raises as `table` does."""
    array = np.asarray(values)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "iu":
        raise ValueError(f"faces of shape {array.shape}")
    return array.astype(np.int64)
