"""Pictures of anything, drawn by OpenGL without a display.

What is drawn is a look (a material's, see `viewer.materials`) on a geometry, seen in a view, into a target. Material
and geometry are uploaded once and drawn as often as wanted; a target is drawn into, and read or shown.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Concatenate, ParamSpec, Protocol, Self, TypeVar

import moderngl
import numpy as np
from numpy.typing import NDArray

from processing.reference.camera import Camera
from viewer.errors import GraphicsError
from viewer.geometry import Geometry
from viewer.gl_context import GlContext, open_context
from viewer.look import Look, UniformValue
from viewer.shader_source import shader_source
from viewer.targets import Drawable, Target, check_errors
from viewer.view import View

F32 = NDArray[np.float32]
Size = tuple[int, int]
P = ParamSpec("P")
ProgramKey = tuple[str, str, frozenset[str]]


class OnCard(Protocol):
    """What was uploaded, and can be let go."""

    def release(self) -> None: ...


T = TypeVar("T", bound=OnCard)


class Renderer:
    """Draws looks on geometries. Holds an OpenGL context of its own, so use it in a `with` statement.

    Several can live side by side: the context is current only while one of the methods runs.
    """

    def __init__(self, open_gl: Callable[[], GlContext] = open_context) -> None:
        self._gl = open_gl()
        self._programs: dict[ProgramKey, moderngl.Program] = {}

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

    @contextmanager
    def upload(
        self, make: Callable[Concatenate[GlContext, P], T], *arguments: P.args, **options: P.kwargs
    ) -> Iterator[T]:
        """Put something on the card, and let it go at the end of the `with` statement.

        Parameters
        ----------
        make : takes the context, then the arguments, as materials, `mesh_geometry` and `Target` do

        Raises
        ------
        InputError
            The graphics driver does not take that much.
        GraphicsError
            The graphics driver failed.
        """
        with self._gl.moderngl:
            try:
                made = make(self._gl, *arguments, **options)
            except moderngl.Error as error:
                raise GraphicsError(
                    f"upload: the graphics driver has no room for it ({error}); ask for less, or update the driver"
                ) from error
            try:
                check_errors(self._gl.moderngl, "upload")
            except BaseException:
                made.release()
                raise
        try:
            yield made
        finally:
            with self._gl.moderngl:
                made.release()

    def draw(
        self, look: Look, geometry: Geometry, target: Drawable, view: View | Camera | None = None, *, clear: bool = True
    ) -> None:
        """Draw one look on one geometry.

        Parameters
        ----------
        view : where the camera is, or the camera itself; None if the look's vertex shader wants no camera, and then
            there is no depth
        clear : take away what was drawn before; otherwise what is nearer than that is drawn over it

        Raises
        ------
        GraphicsError
            The graphics driver failed.
        """
        context = self._gl.moderngl
        with context:
            # A framebuffer that is let go while bound makes the next one's creation fail.
            previous = context.detect_framebuffer()
            target.framebuffer.use()
            try:
                if clear:
                    target.clear()
                context.enable_only(moderngl.NOTHING if view is None else moderngl.DEPTH_TEST)
                for one in (look, *look.others):
                    geometry.draw(self._told(one, target, view))
                check_errors(context, "picture")
            finally:
                previous.use()

    def _told(self, look: Look, target: Drawable, view: View | Camera | None) -> moderngl.Program:
        """Return a look's program with its uniforms and textures set."""
        program = self._program((look.vertex, look.fragment, look.switches))
        if view is not None:
            _tell(program, _placed(view.camera(target.size) if isinstance(view, View) else view))
        for unit, (name, texture) in enumerate(look.textures.items()):
            texture.use(unit)
            program[name] = unit
        for name, value in look.uniforms.items():
            program[name] = value
        return program

    def finish(self) -> None:
        """Wait until all that was asked for is drawn; reading waits by itself."""
        with self._gl.moderngl as context:
            context.finish()

    def picture(
        self, look: Look, geometry: Geometry, view: View | Camera | None = None, *, size: Size, supersample: int = 1
    ) -> F32:
        """Draw one look on one geometry, and read it.

        Parameters
        ----------
        size : width and height in pixels
        supersample : draw so many times finer in both directions and average, for smooth edges

        Returns
        -------
        picture : (H, W, 4) float32, linear light, not cut off at 1, and straight coverage 0..1; row 0 on top
        """
        with self.upload(Target, size, supersample) as target:
            self.draw(look, geometry, target, view)
            return target.read()

    def _program(self, key: ProgramKey) -> moderngl.Program:
        if key not in self._programs:
            vertex, fragment, switches = key
            self._programs[key] = self._gl.moderngl.program(
                vertex_shader=shader_source(vertex, switches), fragment_shader=shader_source(fragment, switches)
            )
        return self._programs[key]


def _tell(program: moderngl.Program, uniforms: dict[str, UniformValue]) -> None:
    """Set those that the compiler has not dropped."""
    for name, value in uniforms.items():
        if name in program:
            program[name] = value


def _placed(camera: Camera) -> dict[str, UniformValue]:
    return {
        # OpenGL reads matrices column by column.
        "view_from_object": tuple(camera.view_from_object.T.ravel()),
        "clip_from_view": tuple(camera.clip_from_view.T.ravel()),
        "eye_distance": camera.eye_distance or 0.0,
    }
