"""Meshes that need no file: torus, sphere, cloth, ribbon, pillow."""

import math
from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.mesh import jets, surfaces
from processing.mesh.jets import Jet
from processing.mesh.model import Mesh
from processing.mesh.surfaces import Point

F64 = NDArray[np.float64]


def builtin_mesh(name: str) -> Mesh:
    """Return one of the meshes that litrig brings along.

    Raises
    ------
    InputError
        No mesh has that name.
    """
    if name not in _MAKERS:
        names = ", ".join(BUILTIN_NAMES)
        raise InputError(f"mesh {name!r}: there is no such mesh, and mesh files cannot be read yet; use one of {names}")
    return _MAKERS[name]()


def torus(around: int = 192, tube: int = 96) -> Mesh:
    """Return a torus with its grain along the ring."""
    return _from_formula(surfaces.torus, around, tube)


def sphere(around: int = 192, tall: int = 96) -> Mesh:
    """Return a unit sphere with its grain along the parallels, poles on the y axis."""
    u, v = _grid(around, tall)
    east, north = u * 2 * math.pi, (v - 0.5) * math.pi
    positions = np.stack([np.cos(north) * np.sin(east), np.sin(north), np.cos(north) * np.cos(east)], axis=-1)
    # At a pole every way leads along a parallel; the meridian of the vertex says which one is meant.
    tangents = np.stack([np.cos(east), np.zeros_like(east), -np.sin(east)], axis=-1)
    return _without_slivers(_mesh(positions, positions, tangents, u, v))


def cloth(side: int = 240) -> Mesh:
    """Return a square cloth draped over a ball, its grain along one thread."""
    return _fit_unit_sphere(_from_formula(surfaces.cloth, side, side))


def ribbon(long: int = 400, wide: int = 24) -> Mesh:
    """Return a gymnast's ribbon, open and seen from both sides, its grain along it."""
    return _fit_unit_sphere(_from_formula(surfaces.ribbon, long, wide))


def pillow(side: int = 160) -> Mesh:
    """Return a filled pillow of two sides that meet in a seam."""
    sides = [_from_formula(partial(surfaces.pillow_side, side=side_sign), side, side) for side_sign in (1.0, -1.0)]
    return _fit_unit_sphere(_join(*sides))


_MAKERS: dict[str, Callable[[], Mesh]] = {
    "torus": torus,
    "sphere": sphere,
    "cloth": cloth,
    "ribbon": ribbon,
    "pillow": pillow,
}
BUILTIN_NAMES = tuple(_MAKERS)


def _from_formula(surface: Callable[[Jet, Jet], Point], columns: int, rows: int) -> Mesh:
    """Sample a surface on a grid; normals and ∇U follow from its exact derivatives."""
    u, v = _grid(columns, rows)
    point = surface(*jets.parameters(u, v))
    positions = np.stack([part.value for part in point], axis=-1)
    along_u = np.stack([part.du for part in point], axis=-1)
    along_v = np.stack([part.dv for part in point], axis=-1)
    normals = _unit(np.cross(along_u, along_v))
    # ∇U is orthogonal to the lines of constant u, which run along ∂p/∂v.
    return _mesh(positions, normals, _unit(np.cross(along_v, normals)), u, v)


def _grid(columns: int, rows: int) -> tuple[F64, F64]:
    """Return parameters 0..1 with both ends, so that a closed surface has its own vertices on either side of a seam."""
    u, v = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, rows + 1))
    return u, v


def _mesh(positions: F64, normals: F64, tangents: F64, u: F64, v: F64) -> Mesh:
    # sin(2π) is not quite 0: without rounding, a closed surface has a crack along its seam that a pixel can fall into.
    return Mesh(
        positions=np.round(positions, 9).reshape(-1, 3).astype(np.float32) + np.float32(0),
        normals=normals.reshape(-1, 3).astype(np.float32),
        tangents=tangents.reshape(-1, 3).astype(np.float32),
        uvs=np.stack([u, v], axis=-1).reshape(-1, 2).astype(np.float32),
        triangles=_grid_triangles(u.shape[0], u.shape[1]),
    )


def _grid_triangles(rows: int, columns: int) -> NDArray[np.int32]:
    """Cut every cell of a grid of vertices in two, counter-clockwise where ∂p/∂u × ∂p/∂v points at the viewer."""
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)[None, :]).reshape(-1)
    right, above = corner + 1, corner + columns
    lower = np.stack([corner, right, above + 1], axis=1)
    upper = np.stack([corner, above + 1, above], axis=1)
    return np.concatenate([lower, upper]).astype(np.int32)


def _without_slivers(mesh: Mesh) -> Mesh:
    """Leave out triangles of which two corners coincide, as at a pole, and vertices that then belong to none."""
    corners = mesh.positions[mesh.triangles]
    apart = np.any(corners != np.roll(corners, 1, axis=1), axis=2).all(axis=1)
    used, renamed = np.unique(mesh.triangles[apart], return_inverse=True)
    return Mesh(
        positions=mesh.positions[used],
        normals=mesh.normals[used],
        tangents=mesh.tangents[used],
        uvs=mesh.uvs[used],
        triangles=renamed.reshape(-1, 3).astype(np.int32),
    )


def _join(first: Mesh, second: Mesh) -> Mesh:
    count = np.int32(len(first.positions))
    return Mesh(
        positions=np.concatenate([first.positions, second.positions]),
        normals=np.concatenate([first.normals, second.normals]),
        tangents=np.concatenate([first.tangents, second.tangents]),
        uvs=np.concatenate([first.uvs, second.uvs]),
        triangles=np.concatenate([first.triangles, second.triangles + count]),
    )


def _fit_unit_sphere(mesh: Mesh) -> Mesh:
    """Move the middle of the bounding box to the origin and scale to the unit sphere; directions stay."""
    middle = (mesh.positions.min(axis=0) + mesh.positions.max(axis=0)) / 2
    centred = mesh.positions - middle
    reach = np.linalg.norm(centred, axis=1).max()
    return Mesh((centred / reach).astype(np.float32), mesh.normals, mesh.tangents, mesh.uvs, mesh.triangles)


def _unit(vectors: F64) -> F64:
    unit: F64 = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    return unit
