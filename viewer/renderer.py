"""Pictures of materials, drawn by OpenGL without a display."""

import math
from collections.abc import Callable, Mapping, Sequence
from types import TracebackType
from typing import Self

import moderngl
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.table_normals import TableNormal
from processing.amc.mips import MipLevel, mip_chain
from processing.amc.model import Amc, TangentAngle
from processing.mesh.model import Mesh
from processing.ptm.model import Ptm
from viewer.amc_texture import upload_amc
from viewer.gl_context import GlContext, open_context
from viewer.ptm_texture import upload_ptm
from viewer.shader_source import shader_source
from viewer.targets import average_down, check_errors, read_rows, target
from viewer.view import View

F32 = NDArray[np.float32]
Size = tuple[int, int]
UniformValue = int | float | bool | tuple[float, ...]

_TABLE_NORMAL_CODES = {TableNormal.RECTIFIED: 0, TableNormal.VIEW: 1, TableNormal.CAMERA: 2}
_BAND_TEXELS = 4 << 20
"""A flat PTM is drawn in bands of rows of about so many texels, so that large ones need little memory."""


class Renderer:
    """Draws AMCs and PTMs. Holds an OpenGL context of its own, so use it in a `with` statement.

    Pictures are (H, W, 4) float32 with row 0 on top: linear light, not cut off at 1, and straight coverage 0..1.
    """

    def __init__(self, open_gl: Callable[[], GlContext] = open_context) -> None:
        self._gl = open_gl()
        self._programs: dict[tuple[str, str], moderngl.Program] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Let the context go; safe twice."""
        for program in self._programs.values():
            program.release()
        self._programs.clear()
        self._gl.moderngl.release()

    def render_amc(
        self,
        amc: Amc,
        mesh: Mesh,
        view: View,
        *,
        size: Size,
        levels: Sequence[MipLevel] | None = None,
        level: int | None = None,
        supersample: int = 1,
        seam_trick: bool = True,
    ) -> F32:
        """Draw a mesh made of the material (the AMC paper, section 6).

        Parameters
        ----------
        size : width and height in pixels
        levels : the mip levels that the AMC's file has; None makes them
        level : read this mip level everywhere; None reads the one that fits the surface's size on screen
        supersample : draw so many times finer in both directions and average, for smooth edges
        seam_trick : choose between k and k′ by what changes less (section 6.2); off shows the seam that it removes

        Returns
        -------
        picture : (H, W, 4) float32, linear light and straight coverage, row 0 on top

        Raises
        ------
        InputError
            The level does not exist, or the graphics driver cannot draw this size.
        GraphicsError
            The graphics driver failed.
        """
        chain = mip_chain(amc) if levels is None else list(levels)
        if level is not None and not 0 <= level < len(chain):
            raise InputError(f"AMC: has mip levels 0 to {len(chain) - 1}, not {level}")
        uniforms: dict[str, UniformValue] = {
            "table": 0,
            "table_normal": _TABLE_NORMAL_CODES[amc.table_normal],
            "angle_in_surface": amc.tangent_angle is TangentAngle.SURFACE,
            "repeats": float(amc.repeats),
            "first_slice": 0.5 / len(amc.slices),
            "level": -1.0 if level is None else float(level),
            "seam_trick": seam_trick,
        }
        with self._gl.moderngl:
            texture = upload_amc(self._gl, chain)
            try:
                texture.use(0)
                return self._draw_mesh("amc.frag", mesh, view, size, supersample, uniforms)
            finally:
                texture.release()

    def render_ptm(self, ptm: Ptm, light: tuple[float, float]) -> F32:
        """Relight a PTM flat, texel by texel, at its own size.

        Parameters
        ----------
        light : x and y of the unit vector to the light, view frame

        Returns
        -------
        values : (H, W, 3) float32 in the PTM's own space, where 1 is white; not cut off. Row 0 on top

        Raises
        ------
        InputError
            The light is outside the unit disc, or the PTM is wider than the graphics driver takes.
        GraphicsError
            The graphics driver failed.
        """
        _light_z(light)
        rows = max(1, _BAND_TEXELS // ptm.coefficients.shape[2])
        starts = range(0, ptm.coefficients.shape[1], rows)
        with self._gl.moderngl:
            return np.concatenate([self._draw_flat(_rows(ptm, start, start + rows), light) for start in starts])

    def render_ptm_on_mesh(
        self, ptm: Ptm, mesh: Mesh, view: View, light: tuple[float, float], *, size: Size, supersample: int = 1
    ) -> F32:
        """Lay a PTM on a mesh and light it from one direction of the view frame; no shadows are cast.

        Returns
        -------
        picture : (H, W, 4) float32, linear light and straight coverage, row 0 on top
        """
        uniforms: dict[str, UniformValue] = {
            "light_direction": (*light, _light_z(light)),
            "is_display": ptm.space == "srgb",
        }
        with self._gl.moderngl:
            textures = upload_ptm(self._gl.moderngl, ptm)
            try:
                textures.smooth()
                textures.use(self._program("mesh.vert", "ptm_mesh.frag"))
                return self._draw_mesh("ptm_mesh.frag", mesh, view, size, supersample, uniforms)
            finally:
                textures.release()

    def _draw_flat(self, band: Ptm, light: tuple[float, float]) -> F32:
        context = self._gl.moderngl
        program = self._program("ptm_flat.vert", "ptm_flat.frag")
        textures = upload_ptm(context, band)
        try:
            with target(context, (band.coefficients.shape[2], band.coefficients.shape[1])) as framebuffer:
                textures.use(program)
                program["light"] = light
                context.enable_only(moderngl.NOTHING)
                vertices = context.vertex_array(program, [])
                vertices.render(moderngl.TRIANGLES, vertices=3)
                vertices.release()
                values = read_rows(framebuffer)[..., :3].copy()
                check_errors(context, "PTM")
        finally:
            textures.release()
        return values

    def _draw_mesh(
        self, fragment: str, mesh: Mesh, view: View, size: Size, supersample: int, uniforms: Mapping[str, UniformValue]
    ) -> F32:
        if supersample < 1:
            raise InputError(f"picture: supersampling {supersample} is below 1; 1 is off, 3 is smooth")
        context = self._gl.moderngl
        program = self._program("mesh.vert", fragment)
        camera = view.camera(size)
        placed: dict[str, UniformValue] = {
            # OpenGL reads matrices column by column.
            "view_from_object": tuple(camera.view_from_object.T.ravel()),
            "clip_from_view": tuple(camera.clip_from_view.T.ravel()),
            "eye_distance": camera.eye_distance or 0.0,
        }
        for name, value in {**placed, **uniforms}.items():
            program[name] = value
        with target(context, (size[0] * supersample, size[1] * supersample)) as framebuffer:
            context.enable_only(moderngl.DEPTH_TEST)
            _draw_triangles(context, program, mesh)
            picture = average_down(read_rows(framebuffer)[::-1], supersample)
            check_errors(context, "picture")
        return picture

    def _program(self, vertex: str, fragment: str) -> moderngl.Program:
        if (vertex, fragment) not in self._programs:
            self._programs[vertex, fragment] = self._gl.moderngl.program(
                vertex_shader=shader_source(vertex), fragment_shader=shader_source(fragment)
            )
        return self._programs[vertex, fragment]


def _draw_triangles(context: moderngl.Context, program: moderngl.Program, mesh: Mesh) -> None:
    attributes = {
        "in_position": mesh.positions,
        "in_normal": mesh.normals,
        "in_tangent": mesh.tangents,
        "in_uv": mesh.uvs,
    }
    # The compiler drops attributes that a shader makes no use of.
    used = {name: np.ascontiguousarray(values, "<f4") for name, values in attributes.items() if name in program}
    buffers = {name: context.buffer(values.tobytes()) for name, values in used.items()}
    indices = context.buffer(np.ascontiguousarray(mesh.triangles, "<i4").tobytes())
    vertices = context.vertex_array(
        program, [(buffers[name], f"{values.shape[1]}f", name) for name, values in used.items()], indices
    )
    vertices.render(moderngl.TRIANGLES)
    resources: list[moderngl.VertexArray | moderngl.Buffer] = [vertices, indices, *buffers.values()]
    for resource in resources:
        resource.release()


def _light_z(light: tuple[float, float]) -> float:
    square = light[0] ** 2 + light[1] ** 2
    if not square <= 1:
        raise InputError(
            f"light: ({light[0]:g}, {light[1]:g}) is no direction; give x and y of a unit vector, x² + y² ≤ 1"
        )
    return math.sqrt(1 - square)


def _rows(ptm: Ptm, start: int, end: int) -> Ptm:
    colour = None if ptm.colour is None else ptm.colour[start:end]
    return Ptm(ptm.coefficients[:, start:end], colour, ptm.space, ptm.source)
