"""Where the camera of a rendered picture stands, as far as the file or the user says so."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.files import read_limited
from processing.exr_parts import require

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
_LARGEST_MATRIX_BYTES = 10_000
_MATRICES = ("worldToCamera", "worldtocamera", "Nl")
"""The standard attribute, and what RenderMan calls it."""
_FOCAL = ("pinholeFocalLength", "nominalFocalLength", "effectiveFocalLength")
_SENSOR = "sensorOverallDimensions"


@dataclass(frozen=True)
class CameraSaid:
    """What the user says of the camera; None leaves it to the file.

    Attributes
    ----------
    world_to_camera : file of 16 numbers, rows that a point is multiplied to from the left
    fov_deg : from the left edge to the right
    orthographic : all pixels are seen along one direction
    depth_along_ray : depth is the distance from the camera, not along its axis
    """

    world_to_camera: Path | None = None
    fov_deg: float | None = None
    orthographic: bool = False
    depth_along_ray: bool = False


def world_to_camera(path: Path, header: Mapping[str, Any], said: CameraSaid) -> F64 | None:
    """Return the matrix (4, 4) that row vectors of the world are multiplied by, or None where none is known.

    Raises
    ------
    InputError, FormatError
        It is no rotation and translation.
    """
    if said.world_to_camera is not None:
        return _checked(said.world_to_camera, _numbers(said.world_to_camera))
    stored = next((header[name] for name in _MATRICES if header.get(name) is not None), None)
    return None if stored is None else _checked(path, np.asarray(stored, np.float64))


def focal_px(header: Mapping[str, Any], width_px: int, said: CameraSaid) -> float | None:
    """Return the focal length in pixels, or None where neither the user nor the file tells it."""
    if said.fov_deg is not None:
        if not 0 < said.fov_deg < 180:
            raise InputError(f"a field of view of {said.fov_deg:g}° is none; give it between 0 and 180")
        return float(width_px / (2 * np.tan(np.radians(said.fov_deg) / 2)))
    focal_mm = next((header[name] for name in _FOCAL if header.get(name) is not None), None)
    sensor_mm = header.get(_SENSOR)
    if focal_mm is None or sensor_mm is None:
        return None
    focal, sensor = float(focal_mm), float(np.ravel(np.asarray(sensor_mm))[0])
    return width_px * focal / sensor if np.isfinite(focal * sensor) and focal > 0 and sensor > 0 else None


def positions_from_depth(depth: F32, focal: float, along_ray: bool) -> F32:
    """Return positions (H, W, 3) in the view frame of what is seen at a depth (H, W), the axis through the middle."""
    height, width = depth.shape
    x = (np.arange(width) + 0.5 - width / 2) / focal
    y = -(np.arange(height) + 0.5 - height / 2) / focal
    rays = np.stack([*np.meshgrid(x, y), -np.ones(depth.shape)], axis=-1)
    if along_ray:
        rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    with np.errstate(invalid="ignore", over="ignore"):
        positions: F32 = (rays * depth[..., None]).astype(np.float32)
    return positions


def axes_seen(positions: F32, shown: NDArray[np.bool_]) -> F64:
    """Return signs of x and z (3,) that turn a camera's frame into the view frame, from where pixels lie in it.

    Renderers differ in whether the camera looks along z or −z, and whether its x is to the right.
    """
    signs = np.ones(3)
    seen = positions[shown].astype(np.float64)
    apart = seen[:, 2] != 0
    if not np.any(apart):
        return signs
    signs[2] = -1 if np.median(seen[:, 2]) > 0 else 1
    columns = np.nonzero(shown)[1][apart]
    x = seen[apart, 0] / np.abs(seen[apart, 2])
    signs[0] = -1 if np.mean((columns - columns.mean()) * (x - x.mean())) < 0 else 1
    return signs


def _numbers(path: Path) -> F64:
    text = read_limited(path, _LARGEST_MATRIX_BYTES).decode("utf-8", "replace").replace("Matrix 4x4", " ")
    try:
        numbers = [float(word) for word in re.split(r"[\s,;()<>\[\]]+", text) if word]
    except ValueError as error:
        raise InputError(f"{path}: holds what are no numbers ({error}); write 16 numbers, row by row") from error
    if len(numbers) != 16:
        raise InputError(f"{path}: holds {len(numbers)} numbers; write 16, row by row")
    matrix = np.array(numbers).reshape(4, 4)
    # With the translation in the last column it is one for column vectors.
    return matrix.T if np.any(matrix[:3, 3]) and not np.any(matrix[3, :3]) else matrix


def _checked(path: Path, matrix: F64) -> F64:
    good = matrix.shape == (4, 4) and bool(np.all(np.isfinite(matrix)))
    turn = matrix[:3, :3] if good else np.zeros((3, 3))
    require(
        path,
        bool(np.allclose(turn @ turn.T, np.eye(3), atol=1e-3)),
        "worldToCamera is no rotation and translation; write it without scale",
    )
    return matrix
