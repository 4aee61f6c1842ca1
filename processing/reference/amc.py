"""The picture that an AMC stands for, in plain NumPy and double precision: what shaders are tested against."""

import math

import numpy as np
from numpy.typing import NDArray

from litrig.base.table_normals import TableNormal, rotate_smallest, table_normals, table_tangents
from processing.amc.mips import mip_chain
from processing.amc.model import Amc, TangentAngle
from processing.mesh.model import Mesh
from processing.reference.camera import Camera
from processing.reference.raster import rasterise

F64 = NDArray[np.float64]
Floats = NDArray[np.floating]
_GRAZING = 1e-3


def render_amc(amc: Amc, mesh: Mesh, camera: Camera, size: tuple[int, int], *, level: int = 0) -> F64:
    """Draw a mesh with an AMC (the AMC paper, section 6).

    Parameters
    ----------
    size : width and height in pixels
    level : mip level that every pixel is read from

    Returns
    -------
    picture : (H, W, 4) float64, linear light and coverage 0 or 1; row 0 on top
    """
    points = mesh.positions.astype(np.float64) @ camera.view_from_object.T
    seen = rasterise(points, mesh.triangles, camera.clip_from_view, size)

    def at_fragments(directions: NDArray[np.float32]) -> F64:
        return seen.interpolate(directions.astype(np.float64) @ camera.view_from_object.T, mesh.triangles)

    to_eye = camera.to_eye(seen.interpolate(points, mesh.triangles))
    normals = visible_normals(unit(at_fragments(mesh.normals)), to_eye, seen.front)
    tangents = at_fragments(mesh.tangents)
    tangents = unit(tangents - normals * np.sum(tangents * normals, axis=1, keepdims=True))
    turned, k = table_coordinates(normals, tangents, to_eye, amc.table_normal, amc.tangent_angle)
    picture = np.zeros((size[1], size[0], 4))
    picture[seen.rows, seen.columns, :3] = lookup(amc, turned, k, level)
    picture[seen.rows, seen.columns, 3] = 1
    return picture


def visible_normals(normals: F64, to_eye: F64, front: NDArray[np.bool_]) -> F64:
    """Turn normals to the side that is seen, (N, 3).

    A triangle and its normal must agree that it is the back which is seen; at a silhouette one of them alone is often
    wrong. What then still looks away from the eye is bent back to the silhouette.
    """
    towards = np.sum(normals * to_eye, axis=1)
    sides = np.where(~front & (towards < 0), -1.0, 1.0)
    towards = (sides * towards)[:, None]
    seen = normals * sides[:, None]
    return np.where(towards < _GRAZING, unit(seen + to_eye * (_GRAZING - towards)), seen)


def table_coordinates(
    normals: F64,
    tangents: F64,
    to_eye: F64,
    kind: TableNormal,
    tangent_angle: TangentAngle = TangentAngle.PICTURE,
) -> tuple[Floats, Floats]:
    """Return the table's normal (N, 3) and k (N,) in [0, 1) (the AMC paper, equation 3).

    A table normal that looks away from the camera has no texel; it is read at the rim of the disc.
    """
    turned = table_normals(normals, to_eye, kind)
    across = table_tangents(tangents, normals, turned)
    if tangent_angle is TangentAngle.SURFACE:
        across = rotate_smallest(across, turned, np.array([0.0, 0.0, 1.0]))
    k = np.arctan2(across[:, 1], across[:, 0]) / (2 * math.pi)
    k = k - np.floor(k)
    on_rim = turned * np.array([1.0, 1.0, 0.0])
    turned = np.where(turned[:, 2:] < 0, unit(on_rim), turned)
    return turned, np.where(k < 1, k, 0.0)


def lookup(amc: Amc, normals: Floats, k: Floats, level: int = 0) -> F64:
    """Read a level trilinearly: texel centres and clamping in the slices, wrapping round along k.

    Slice j stands at k·R·D = j exactly. A smaller level's slice is the mean of several, and stands in their middle.

    Parameters
    ----------
    normals : (N, 3) table normals
    k : (N,) tangent angle as a share of a turn

    Returns
    -------
    colours : (N, 3) float64, linear
    """
    table = mip_chain(amc)[level].colours.astype(np.float64)
    depth, size = table.shape[:2]
    column = np.clip((normals[:, 0] + 1) / 2 * size - 0.5, 0, size - 1)
    row = np.clip((1 - normals[:, 1]) / 2 * size - 0.5, 0, size - 1)
    slice_number = (k * amc.repeats + 0.5 / len(amc.slices)) * depth - 0.5
    colours = np.zeros((len(k), 3))
    for slices, slice_share in _neighbours(slice_number):
        for rows, row_share in _neighbours(row):
            for columns, column_share in _neighbours(column):
                texels = table[slices % depth, np.minimum(rows, size - 1), np.minimum(columns, size - 1)]
                colours += (slice_share * row_share * column_share)[:, None] * texels
    return colours


def _neighbours(coordinate: Floats) -> tuple[tuple[NDArray[np.int64], Floats], tuple[NDArray[np.int64], Floats]]:
    """Return the texels on either side of a coordinate, each with its share."""
    below = np.floor(coordinate)
    share = coordinate - below
    number = below.astype(np.int64)
    return (number, 1 - share), (number + 1, share)


def unit(vectors: Floats) -> F64:
    """Scale vectors (N, 3) to length one."""
    scaled: F64 = vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-30)
    return scaled
