"""The picture that an AMC stands for, in plain NumPy and double precision: what shaders are tested against."""

import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.table_normals import TableNormal, rotate_smallest, table_normals, table_tangents
from processing.amc.mips import mip_chain
from processing.amc.model import Amc, TangentAngle
from processing.mesh.model import Mesh
from processing.reference.camera import Camera
from processing.reference.per_vertex import PerVertex, interpolated_k, interpolated_places
from processing.reference.shadow import reaches
from processing.reference.surface import Surface, unit, visible_surface

F64 = NDArray[np.float64]
Floats = NDArray[np.floating]
Way = Literal["fragment", "mixed", "vertex"]


def render_amc(
    amc: Amc,
    mesh: Mesh,
    camera: Camera,
    size: tuple[int, int],
    *,
    level: int = 0,
    way: Way = "fragment",
    occluded: bool = False,
) -> F64:
    """Draw a mesh with an AMC (the AMC paper, section 6).

    Parameters
    ----------
    size : width and height in pixels
    level : mip level that every pixel is read from
    way : where i, j and k are found: all at pixels, k at vertices, or all at vertices
    occluded : darken by the mesh's ambient occlusion (section 6.1)

    Returns
    -------
    picture : (H, W, 4) float64, linear light and coverage 0 or 1; row 0 on top
    """
    surface = visible_surface(mesh, camera, size)
    turned, k = _coordinates(amc, surface)
    if way != "fragment":
        vertices = PerVertex.of(mesh, camera, lambda n, t, to_eye: table_coordinates(n, t, to_eye, *_kinds(amc)))
        k = interpolated_k(vertices, surface.seen, mesh.triangles)
        turned = interpolated_places(vertices, surface.seen, mesh.triangles) if way == "vertex" else turned
    light = lookup(amc, turned, k, level)
    return surface.picture(light * surface.openness[:, None] if occluded else light)


def render_sum(low: Amc, high: Amc, mesh: Mesh, camera: Camera, size: tuple[int, int], *, level: int = 0) -> F64:
    """Draw a mesh with two AMCs whose light adds up, each with its own table normal."""
    surface = visible_surface(mesh, camera, size)
    return surface.picture(sum((lookup(amc, *_coordinates(amc, surface), level) for amc in (low, high)), np.zeros(3)))


def render_keyed(
    lit: Amc, unlit: Amc, key: tuple[float, float], mesh: Mesh, camera: Camera, size: tuple[int, int], *, level: int = 0
) -> F64:
    """Draw a mesh with one AMC where the key light reaches it, and with another where not (section 6.1).

    Parameters
    ----------
    key : x and y of the unit vector to the key light, view frame

    Raises
    ------
    InputError
        The key light's direction is none.
    """
    if not math.hypot(*key) <= 1:
        raise InputError(f"key light: {key} is no direction")
    towards = np.array([*key, math.sqrt(1 - key[0] ** 2 - key[1] ** 2)])
    surface = visible_surface(mesh, camera, size)
    is_lit = reaches(surface, mesh, camera, towards)[:, None]
    light, rest = (lookup(amc, *_coordinates(amc, surface), level) for amc in (lit, unlit))
    return surface.picture(np.where(is_lit, light, rest))


def _coordinates(amc: Amc, surface: Surface) -> tuple[Floats, Floats]:
    return table_coordinates(surface.normals, surface.tangents, surface.to_eye, *_kinds(amc))


def _kinds(amc: Amc) -> tuple[TableNormal, TangentAngle]:
    return amc.table_normal, amc.tangent_angle


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
