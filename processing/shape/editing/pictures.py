"""Pictures that edits are made with: height maps, masks and painted normals."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.pictures import read_codes, read_linear
from processing.shape.buffers.pixels import TURNED_AWAY
from processing.shape.buffers_exr import Tell, read_normals
from processing.shape.model import BACKGROUND, ShadingBuffers

F32 = NDArray[np.float32]
_NOT_UNIT = 0.35
_BELOW_A_CODE = 1.01


def stored_values(path: Path) -> F32:
    """Read the values that a picture stores, (H, W, 3): 0..1 of integers, or those of an EXR as they are.

    Raises
    ------
    InputError, FormatError
        The picture cannot be read.
    """
    if path.suffix.lower() == ".exr":
        return read_linear(path)
    codes = read_codes(path)
    values: F32 = codes.astype(np.float32) / np.float32(np.iinfo(codes.dtype).max)
    return values


def height_map(path: Path) -> F32:
    """Read heights (h, w): the mean of the stored channels."""
    heights: F32 = stored_values(path).mean(axis=-1, dtype=np.float32)
    return heights


def mask_weights(path: Path, buffers: ShadingBuffers) -> F32:
    """Read a mask (H, W), 0 to 1.

    Raises
    ------
    InputError
        It is of another size, or leaves 0 to 1.
    """
    weights = height_map(path)
    _check_size(path, weights, buffers, "mask")
    if weights.min() < 0 or weights.max() > 1:
        raise InputError(f"{path}: a mask of values {weights.min():g} to {weights.max():g}; scale it to 0 to 1")
    return weights


def painted_normals(
    path: Path, buffers: ShadingBuffers, *, green_is_down: bool, in_surface: bool, tell: Tell
) -> tuple[F32, NDArray[np.bool_]]:
    """Read normals that were made elsewhere.

    Parameters
    ----------
    green_is_down : the second component counts downwards
    in_surface : z is the surface's own normal, and neutral grey of 8 bits is 0

    Returns
    -------
    normals : (H, W, 3) unit
    painted : (H, W), where there is one

    Raises
    ------
    InputError, FormatError
        The picture cannot be read, is of another size, or holds no normals.
    """
    shown = buffers.surfaces != BACKGROUND
    if path.suffix.lower() == ".exr":
        normals, painted = read_normals(path, buffers, tell, in_surface=in_surface), shown
    else:
        codes = read_codes(path)
        _check_size(path, codes[..., 0], buffers, "normals")
        most = np.iinfo(codes.dtype).max
        normals = codes.astype(np.float32) / np.float32(most / 2) - 1
        if in_surface:
            normals[np.abs(normals) < _BELOW_A_CODE / most] = 0
        length = np.linalg.norm(normals, axis=-1)
        painted = shown & (np.abs(length - 1) < _NOT_UNIT)
        if not np.any(painted):
            raise InputError(f"{path}: holds no normals where surfaces are; store (n + 1)/2")
        if lost := int(np.count_nonzero(shown & ~painted)):
            tell(f"{path.name} holds no normals in {lost} pixels of surfaces; they keep theirs")
        normals = (normals / np.where(painted, length, 1)[..., None]).astype(np.float32)
    if green_is_down:
        normals = normals * np.array([1, -1, 1], np.float32)
    away = np.sum(normals * buffers.to_eye, axis=-1) < TURNED_AWAY
    if not in_surface and (turned := int(np.count_nonzero(painted & away))):
        tell(f"{path.name} has normals that look away from the camera in {turned} pixels of surfaces")
    return normals, painted


def _check_size(path: Path, plane: NDArray[np.number], buffers: ShadingBuffers, what: str) -> None:
    height, width = buffers.shape
    if plane.shape != (height, width):
        raise InputError(
            f"{path}: {what} of {plane.shape[1]} × {plane.shape[0]} pixels for a picture of {width} × {height}; make "
            "them alike"
        )
