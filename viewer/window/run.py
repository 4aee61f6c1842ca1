"""The window from its opening to its end."""

import os
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from litrig.base.errors import MissingToolError
from processing.mesh.builtin import BUILTIN_NAMES
from viewer.gl_context import adopt_context
from viewer.renderer import Renderer, Size
from viewer.window.captured import CapturedErrors
from viewer.window.material import Material, read_material
from viewer.window.saving import saving_beside
from viewer.window.stage import Stage
from viewer.window.state import start

if TYPE_CHECKING:
    from viewer.window.frame import Frame

DEFAULT_PICTURE_PX = (900, 760)
_INSTEAD = "use litrig render, which needs no display"
_NO_GL = (
    "update the graphics driver, or install Mesa's with: apt-get install -y --no-install-recommends libgl1 "
    "libgl1-mesa-dri"
)


def view_file(file: Path, mesh: str | None, size: Size | None, folder: Path) -> None:
    """Show a material file in a window until it is closed.

    Parameters
    ----------
    mesh : name of a builtin mesh, or a mesh file; None is what `litrig render` takes
    size : width and height of the picture at first, in pixels of a common display; None is a handy one
    folder : where snapshots go

    Raises
    ------
    InputError, FormatError
        A file is missing, damaged or of an unknown kind.
    MissingToolError
        There is no display, no OpenGL 3.3 on it, or no imgui-bundle.
    """
    _check_tools()
    material = read_material(file)
    _Window(material, mesh or material.mesh, size or DEFAULT_PICTURE_PX, folder).run()


def _check_tools() -> None:
    try:
        import imgui_bundle  # noqa: F401
    except ImportError as error:
        raise MissingToolError(
            f"window: imgui-bundle is not installed ({error}); install it with: pip install imgui-bundle, or {_INSTEAD}"
        ) from error
    if not os.environ.get("DISPLAY"):
        raise MissingToolError(
            f"window: there is no display, for DISPLAY is not set; start it on a desktop, or {_INSTEAD}"
        )


class _Window:
    """The callbacks of hello_imgui. An error in one of them closes the window, and is raised when that is done."""

    def __init__(self, material: Material, mesh: str | None, size: Size, folder: Path) -> None:
        self._material, self._mesh, self._size, self._folder = material, mesh, size, folder
        self._held = ExitStack()
        self._error: BaseException | None = None
        self._frame: Frame | None = None

    def run(self) -> None:
        from imgui_bundle import hello_imgui

        from viewer.window.frame import dress
        from viewer.window.panel import WIDTH_EM

        params = hello_imgui.RunnerParams()
        self._params = params
        params.app_window_params.window_title = f"{self._material.file.name} – litrig"
        panel_px = round(WIDTH_EM * 15)
        params.app_window_params.window_geometry.size = (self._size[0] + panel_px, self._size[1])
        params.ini_disable = True
        params.imgui_window_params.default_imgui_window_type = (
            hello_imgui.DefaultImGuiWindowType.provide_full_screen_window
        )
        params.renderer_backend_options.open_gl_options.anti_aliasing_samples = 0
        params.callbacks.setup_imgui_style = dress
        params.callbacks.show_gui = self._step
        params.callbacks.before_exit = self._close
        with CapturedErrors() as captured:

            def begin() -> None:
                captured.let_go()
                self._guarded(self._open)

            params.callbacks.post_init = begin
            try:
                hello_imgui.run(params)
            except RuntimeError as error:
                if self._frame is not None and self._error is None:
                    raise
                if self._error is None:
                    raise MissingToolError(_advice(captured.lines(), str(error))) from error
        if self._error is not None:
            raise self._error

    def _open(self) -> None:
        from viewer.window.frame import Frame

        renderer = self._held.enter_context(Renderer(adopt_context))
        stage = self._held.enter_context(Stage(renderer, self._material))
        meshes = (*(() if self._material.flat_size is None else (None,)), *BUILTIN_NAMES)
        hand = start(self._mesh, meshes, self._material.light)
        stage.show(hand.shown, self._size, moving=False)
        self._frame = Frame(self._material.file, hand, stage, saving_beside(self._folder, self._material.file))

    def _show(self) -> None:
        if self._frame is not None and not self._frame.show():
            self._params.app_shall_exit = True

    def _step(self) -> None:
        self._guarded(self._show)
        if self._error is not None:  # said here, for before the first frame nobody listens
            self._params.app_shall_exit = True

    def _close(self) -> None:
        self._held.close()

    def _guarded(self, body: Callable[[], None]) -> None:
        """Run a callback: an error must not pass through the library, which would leave the window half alive."""
        if self._error is not None:
            return
        try:
            body()
        except BaseException as error:  # kept, and raised by run
            self._error = error


def _advice(said: list[str], reason: str) -> str:
    words = [line.partition(": ")[2] or line for line in said if line.startswith("Glfw Error")]
    why = words[-1] if words else reason
    if "display" in why.lower():
        return f"window: the display cannot be opened ({why}); check DISPLAY, or {_INSTEAD}"
    return f"window: there is no OpenGL 3.3 on this display ({why}); {_NO_GL}; or {_INSTEAD}"
