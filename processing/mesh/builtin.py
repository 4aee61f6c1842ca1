"""Meshes that need no file: torus, sphere, cloth, ribbon, pillow, a sewn skirt, and a shirt."""

import math
from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.mesh import jets, surfaces
from processing.mesh.grids import fit_unit_sphere, grid, grid_mesh, join, unit, without_slivers
from processing.mesh.jets import Jet
from processing.mesh.model import Mesh
from processing.mesh.sewn import skirt
from processing.mesh.shirt import shirt
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
        raise InputError(f"mesh {name!r}: there is no such mesh; use one of {names}")
    return _MAKERS[name]()


def torus(around: int = 192, tube: int = 96) -> Mesh:
    """Return a torus with its grain along the ring."""
    return _from_formula(surfaces.torus, around, tube)


def sphere(around: int = 192, tall: int = 96) -> Mesh:
    """Return a unit sphere with its grain along the parallels, poles on the y axis."""
    u, v = grid(around, tall)
    east, north = u * 2 * math.pi, (v - 0.5) * math.pi
    positions = np.stack([np.cos(north) * np.sin(east), np.sin(north), np.cos(north) * np.cos(east)], axis=-1)
    # At a pole every way leads along a parallel; the meridian of the vertex says which one is meant.
    tangents = np.stack([np.cos(east), np.zeros_like(east), -np.sin(east)], axis=-1)
    return without_slivers(grid_mesh(positions, positions, tangents, u, v))


def cloth(side: int = 240) -> Mesh:
    """Return a square cloth draped over a ball, its grain along one thread."""
    return fit_unit_sphere(_from_formula(surfaces.cloth, side, side))


def ribbon(long: int = 400, wide: int = 24) -> Mesh:
    """Return a gymnast's ribbon, open and seen from both sides, its grain along it."""
    return fit_unit_sphere(_from_formula(surfaces.ribbon, long, wide))


def pillow(side: int = 160) -> Mesh:
    """Return a filled pillow of two sides that meet in a seam."""
    sides = [_from_formula(partial(surfaces.pillow_side, side=side_sign), side, side) for side_sign in (1.0, -1.0)]
    return fit_unit_sphere(join(*sides))


_MAKERS: dict[str, Callable[[], Mesh]] = {
    "torus": torus,
    "sphere": sphere,
    "cloth": cloth,
    "ribbon": ribbon,
    "pillow": pillow,
    "sewn": skirt,
    "shirt": shirt,
}
BUILTIN_NAMES = tuple(_MAKERS)


def _from_formula(surface: Callable[[Jet, Jet], Point], columns: int, rows: int) -> Mesh:
    """Sample a surface on a grid; normals and ∇U follow from its exact derivatives."""
    u, v = grid(columns, rows)
    point = surface(*jets.parameters(u, v))
    positions = np.stack([part.value for part in point], axis=-1)
    along_u = np.stack([part.du for part in point], axis=-1)
    along_v = np.stack([part.dv for part in point], axis=-1)
    normals = unit(np.cross(along_u, along_v))
    # ∇U is orthogonal to the lines of constant u, which run along ∂p/∂v.
    return grid_mesh(positions, normals, unit(np.cross(along_v, normals)), u, v)
