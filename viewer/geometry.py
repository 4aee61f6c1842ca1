"""Shapes on the graphics card."""

from collections.abc import Mapping

import moderngl
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.mesh.model import Mesh
from viewer.gl_context import GlContext

Floats = NDArray[np.floating]
_SHORTEST = 1e-6


class Geometry:
    """Vertices that any look can be drawn on, as often as wanted; uploaded once.

    A shader takes those attributes that it names.
    """

    def __init__(
        self,
        gl: GlContext,
        attributes: Mapping[str, Floats],
        indices: NDArray[np.integer] | None = None,
        *,
        mode: int = moderngl.TRIANGLES,
        count: int = -1,
    ) -> None:
        """Upload.

        Parameters
        ----------
        attributes : (V, C) or (V,) each, by the name that shaders give them
        indices : of vertices, in the order of drawing; None takes them as they come
        mode : what vertices make up
        count : of vertices, where there are no attributes to tell
        """
        self._context = gl.moderngl
        self._mode, self._count = mode, count
        self._arrays: dict[moderngl.Program, moderngl.VertexArray] = {}
        columns = {name: np.ascontiguousarray(values, "<f4") for name, values in attributes.items()}
        self._formats = {name: f"{values[0].size}f" for name, values in columns.items()}
        self._buffers = {name: self._context.buffer(values.tobytes()) for name, values in columns.items()}
        self._indices = (
            None if indices is None else self._context.buffer(np.ascontiguousarray(indices, "<i4").tobytes())
        )

    def draw(self, program: moderngl.Program) -> None:
        """Draw with a program whose uniforms are set, in the current context."""
        if program not in self._arrays:
            # The compiler drops attributes that a shader makes no use of.
            used = [(self._buffers[name], form, name) for name, form in self._formats.items() if name in program]
            self._arrays[program] = self._context.vertex_array(program, used, self._indices)
        self._arrays[program].render(self._mode, vertices=self._count)

    def release(self) -> None:
        resources = [*self._arrays.values(), *self._buffers.values(), self._indices]
        for resource in resources:
            if resource is not None:
                resource.release()
        self._arrays.clear()
        self._buffers.clear()
        self._indices = None


def mesh_geometry(gl: GlContext, mesh: Mesh) -> Geometry:
    """Upload a mesh, in the object's own frame.

    Raises
    ------
    InputError
        It cannot be drawn: see `check_mesh`.
    """
    check_mesh(mesh)
    attributes: dict[str, Floats] = {
        "in_position": mesh.positions,
        "in_normal": mesh.normals,
        "in_tangent": mesh.tangents,
        "in_uv": mesh.uvs,
        "in_occlusion": np.ones(len(mesh.positions)) if mesh.occlusion is None else mesh.occlusion,
    }
    return Geometry(gl, attributes, mesh.triangles)


def check_mesh(mesh: Mesh) -> None:
    """Refuse a mesh that would be drawn as nothing, as noise, or from memory that is not its own.

    Raises
    ------
    InputError
        It has no triangle with an area, numbers that are none, directions without length, or triangles of vertices
        that do not exist.
    """
    count = len(mesh.positions)
    attributes = {"positions": mesh.positions, "normals": mesh.normals, "tangents": mesh.tangents, "uvs": mesh.uvs}
    if mesh.occlusion is not None:
        attributes["occlusion"] = mesh.occlusion
    for name, values in attributes.items():
        if len(values) != count:
            raise InputError(f"mesh: {len(values)} {name} for {count} positions; export it again")
        strange = int(np.count_nonzero(~np.isfinite(values).reshape(count, -1).all(axis=1))) if count else 0
        if strange:
            raise InputError(
                f"mesh: {name} of {strange} of {count} vertices are no numbers; mend it or export it again"
            )
    for name in ("normals", "tangents"):
        lost = int(np.count_nonzero(np.linalg.norm(attributes[name], axis=1) < _SHORTEST))
        if lost:
            raise InputError(f"mesh: {name} of {lost} of {count} vertices have no length; export it again")
    if mesh.triangles.size and not 0 <= mesh.triangles.min() <= mesh.triangles.max() < count:
        raise InputError(f"mesh: has triangles of vertices that are not among its {count}; export it again")
    corners = mesh.positions[mesh.triangles].astype(np.float64)
    doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) if corners.size else np.zeros(1)
    if not np.any(doubled):
        raise InputError(f"mesh: none of its {len(mesh.triangles)} triangles has an area; there is nothing to draw")


def whole_picture(gl: GlContext) -> Geometry:
    """Make the one triangle, of no attributes, that covers everything (`flat.vert`)."""
    return Geometry(gl, {}, count=3)
