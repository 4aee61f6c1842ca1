"""Shapes of figures 6 and 9 of the Shape paper: a teapot, a vase, and what litrig brings along."""

from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BPoly

from processing.mesh.builtin import sphere, torus
from processing.mesh.grids import fit_unit_sphere, grid, grid_mesh, join, unit, without_slivers
from processing.mesh.model import Mesh

F64 = NDArray[np.float64]

# Bézier curves of four points each: distance from the axis, height.
_TEAPOT_SIDE = (
    ((1.5, 0.0), (1.5, 0.225), (2.0, 0.45), (2.0, 0.9)),
    ((2.0, 0.9), (2.0, 1.35), (1.75, 1.875), (1.5, 2.4)),
    ((1.5, 2.4), (1.44, 2.53), (1.36, 2.53), (1.3, 2.4)),
    ((1.3, 2.4), (0.9, 2.62), (0.4, 2.5), (0.22, 2.68)),
    ((0.22, 2.68), (0.1, 2.86), (0.62, 3.15), (0.0, 3.15)),
)
_VASE_SIDE = (
    ((0.6, 0.0), (0.6, 0.1), (1.25, 0.5), (1.25, 1.3)),
    ((1.25, 1.3), (1.25, 2.1), (0.5, 2.3), (0.5, 2.8)),
    ((0.5, 2.8), (0.5, 3.1), (0.7, 3.3), (0.95, 3.4)),
)
# Middle lines of tubes, and their radii from end to end.
_SPOUT = ((1.5, 0.75), (2.9, 0.8), (2.2, 2.0), (3.0, 2.35)), (0.62, 0.2)
_TUBE_UV = 0.25
_HANDLE = ((-1.55, 2.1), (-3.4, 2.4), (-3.2, 0.9), (-1.85, 0.75)), (0.16, 0.16)


def teapot() -> Mesh:
    """Return a teapot: body and lid by a curve that is turned about the y axis, spout and handle by tubes."""
    parts = _turned(_TEAPOT_SIDE)
    for line, radii in (_SPOUT, _HANDLE):
        parts = join(parts, _tube(np.array(line), radii))
    return fit_unit_sphere(parts)


def vase() -> Mesh:
    return fit_unit_sphere(_turned(_VASE_SIDE))


SHAPES = {"teapot": cache(teapot), "vase": cache(vase), "torus": cache(torus), "sphere": cache(sphere)}


def _turned(side: tuple[tuple[tuple[float, float], ...], ...], around: int = 160, tall: int = 160) -> Mesh:
    curve = BPoly(np.moveaxis(np.array(side), 1, 0), np.linspace(0, 1, len(side) + 1))
    u, v = grid(around, tall)
    (radius, height), (outwards, upwards) = np.moveaxis(curve(v), -1, 0), np.moveaxis(curve(v, 1), -1, 0)
    east, east_along = (np.stack([f(u), 0 * u, g(u)], axis=-1) for f, g in ((_sin, _cos), (_cos, _minus_sin)))
    up = np.array([0.0, 1.0, 0.0])
    positions = radius[..., None] * east + height[..., None] * up
    normals = unit(upwards[..., None] * east - outwards[..., None] * up)
    return without_slivers(grid_mesh(positions, normals, east_along, u, v))


def _tube(line: F64, radii: tuple[float, float], around: int = 48, long: int = 96) -> Mesh:
    curve = BPoly(line[:, None, :], [0, 1])
    u, v = grid(around, long)
    x, y = np.moveaxis(curve(v), -1, 0)
    along_x, along_y = np.moveaxis(curve(v, 1), -1, 0)
    bend_x, bend_y = np.moveaxis(curve(v, 2), -1, 0)
    speed = np.hypot(along_x, along_y)
    radius, growth = radii[0] + v * (radii[1] - radii[0]), radii[1] - radii[0]
    ahead = np.stack([along_x, along_y, 0 * x], axis=-1) / speed[..., None]
    aside = np.stack([-ahead[..., 1], ahead[..., 0], 0 * x], axis=-1)
    round_it = _cos(u)[..., None] * aside + _sin(u)[..., None] * np.array([0.0, 0.0, 1.0])
    positions = np.stack([x, y, 0 * x], axis=-1) + radius[..., None] * round_it
    # On the inside of a bend the surface is shorter, so that the same growth makes a steeper cone.
    bend = (along_x * bend_y - along_y * bend_x) / speed**2
    length = speed - radius * bend * _cos(u)
    normals = unit(length[..., None] * round_it - growth * ahead)
    # A thin tube has a smaller part of a pattern than the body.
    return grid_mesh(positions, normals, unit(np.cross(ahead, round_it)), _TUBE_UV * u, _TUBE_UV * v)


def _sin(u: F64) -> F64:
    return np.asarray(np.sin(2 * np.pi * u))


def _cos(u: F64) -> F64:
    return np.asarray(np.cos(2 * np.pi * u))


def _minus_sin(u: F64) -> F64:
    return -_sin(u)
