"""Meshes that are grids of parameters: what their makers share."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from processing.mesh.model import Mesh

F64 = NDArray[np.float64]


def grid(columns: int, rows: int) -> tuple[F64, F64]:
    """Return parameters 0..1 with both ends, so that a closed surface has its own vertices on either side of a seam."""
    u, v = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, rows + 1))
    return u, v


def grid_mesh(positions: F64, normals: F64, tangents: F64, u: F64, v: F64) -> Mesh:
    # sin(2π) is not quite 0: without rounding, a closed surface has a crack along its seam that a pixel can fall into.
    return Mesh(
        positions=np.round(positions, 9).reshape(-1, 3).astype(np.float32) + np.float32(0),
        normals=normals.reshape(-1, 3).astype(np.float32),
        tangents=tangents.reshape(-1, 3).astype(np.float32),
        uvs=np.stack([u, v], axis=-1).reshape(-1, 2).astype(np.float32),
        triangles=grid_triangles(u.shape[0], u.shape[1]),
    )


def grid_triangles(rows: int, columns: int) -> NDArray[np.int32]:
    """Cut every cell of a grid of vertices in two, counter-clockwise where ∂p/∂u × ∂p/∂v points at the viewer."""
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)[None, :]).reshape(-1)
    right, above = corner + 1, corner + columns
    lower = np.stack([corner, right, above + 1], axis=1)
    upper = np.stack([corner, above + 1, above], axis=1)
    return np.concatenate([lower, upper]).astype(np.int32)


def without_slivers(mesh: Mesh) -> Mesh:
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


def join(first: Mesh, second: Mesh) -> Mesh:
    """Put two meshes into one; no vertices are shared."""
    count = np.int32(len(first.positions))
    return Mesh(
        positions=np.concatenate([first.positions, second.positions]),
        normals=np.concatenate([first.normals, second.normals]),
        tangents=np.concatenate([first.tangents, second.tangents]),
        uvs=np.concatenate([first.uvs, second.uvs]),
        triangles=np.concatenate([first.triangles, second.triangles + count]),
    )


def fit_unit_sphere(mesh: Mesh) -> Mesh:
    """Move the middle of the bounding box to the origin and scale to the unit sphere; directions stay."""
    middle = (mesh.positions.min(axis=0) + mesh.positions.max(axis=0)) / 2
    centred = mesh.positions - middle
    reach = np.linalg.norm(centred, axis=1).max()
    return replace(mesh, positions=(centred / reach).astype(np.float32))


def unit(vectors: F64) -> F64:
    """Scale vectors (…, 3) to length one."""
    scaled: F64 = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    return scaled
