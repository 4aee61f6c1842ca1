"""The tangents of a mesh, drawn over it as short lines."""

import numpy as np
from numpy.typing import NDArray

from processing.mesh.model import Mesh
from viewer.geometry import Geometry
from viewer.gl_context import GlContext
from viewer.look import Look

Colour = tuple[float, float, float]

SPACING = 0.085
"""About so far lines stand apart, in radii of the unit sphere."""
LENGTH, WIDTH = 0.07, 0.008
ORANGE: Colour = (1.0, 0.23, 0.02)
_CORNERS = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]], np.float32)


def tangent_lines(gl: GlContext, mesh: Mesh) -> Geometry:
    """Upload one thin strip for every vertex that is shown, each about its vertex and in the surface."""
    shown = spread_out(mesh.positions, SPACING)
    attributes = {
        "in_position": np.repeat(mesh.positions[shown], 4, axis=0),
        "in_normal": np.repeat(mesh.normals[shown], 4, axis=0),
        "in_tangent": np.repeat(mesh.tangents[shown], 4, axis=0),
        "in_corner": np.tile(_CORNERS, (len(shown), 1)),
    }
    strips = 4 * np.arange(len(shown), dtype=np.int32)[:, None, None]
    halves = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    return Geometry(gl, attributes, strips + halves)


def lines_look(colour: Colour = ORANGE) -> Look:
    """Draw the strips in one colour, linear light, over what is there already (`Renderer.draw(..., clear=False)`)."""
    return Look("plain.frag", {"plain_colour": colour, "strip": (LENGTH, WIDTH)}, vertex="tangents.vert")


def spread_out(positions: NDArray[np.float32], spacing: float) -> NDArray[np.int64]:
    """Choose one vertex (V, 3) in every cell of a grid of that spacing, the one nearest its middle; their numbers."""
    places = positions.astype(np.float64) / spacing
    cells = np.floor(places)
    order = np.argsort(np.linalg.norm(places - cells - 0.5, axis=1), kind="stable")
    _, first = np.unique(cells[order], axis=0, return_index=True)
    return np.sort(order[first])
