"""What is shown, drawn: the renderer's side of the window. Nothing here knows of windows, mice or keys."""

from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import NamedTuple, Self

from litrig.base.errors import InputError
from processing.reference.camera import Camera
from viewer.geometry import Geometry, mesh_geometry, whole_picture
from viewer.render_file import staged_mesh
from viewer.renderer import Renderer, Size
from viewer.save import save_rendered
from viewer.staging import DARK_GREY, Staging
from viewer.targets import Target
from viewer.view import View
from viewer.window.display import DisplayTarget, display_look
from viewer.window.flat import flat_camera, rectangle
from viewer.window.material import Looks, Material
from viewer.window.state import Shown

MOST_PIXELS = 20_000_000
"""Finer drawing ends here, 400 MB of colour and depth."""


class Drawn(NamedTuple):
    """What the picture that is there was drawn from."""

    shown: Shown
    size: Size
    finer: int


class _Set(NamedTuple):
    """A mesh with the material on it."""

    mesh: str | None
    geometry: Geometry
    looks: Looks


class Stage:
    """Draws one material as `Shown`, and only when something changed. Use it in a `with` statement."""

    def __init__(self, renderer: Renderer, material: Material, *, finer: int = Staging().supersample) -> None:
        self._renderer, self._material, self._finer = renderer, material, finer
        self._held, self._held_set, self._held_targets = ExitStack(), ExitStack(), ExitStack()
        self._everything = self._held.enter_context(renderer.upload(whole_picture))
        self._set: _Set | None = None
        self._targets: dict[int, Target] = {}
        self._display: DisplayTarget | None = None
        self._drawn: Drawn | None = None
        self.pictures_drawn = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for held in (self._held_set, self._held_targets, self._held):
            held.close()

    def show(self, shown: Shown, size: Size, *, moving: bool) -> DisplayTarget:
        """Draw what is shown, unless it is there already, and return the picture of display codes.

        Parameters
        ----------
        size : width and height in pixels
        moving : draw without smooth edges, which takes a fraction of the time

        Raises
        ------
        InputError, FormatError
            A mesh or the material cannot be read or drawn, or the picture is larger than the graphics driver takes.
        GraphicsError
            The graphics driver failed.
        """
        display = self._display
        if display is None or display.size != size:
            display = self._resize(size)
        # A flat picture has no edges to smooth, and is sharper as it is.
        finest = 1 if shown.mesh is None else affordable(size, self._finer)
        wanted = Drawn(shown, size, 1 if moving else finest)
        if self._drawn in (wanted, wanted._replace(finer=finest)):
            return display
        target = self._target(size, wanted.finer)
        self._draw(shown, target)
        self._renderer.draw(display_look(target, DARK_GREY), self._everything, display)
        self._drawn = wanted
        self.pictures_drawn += 1
        return display

    def save(self, shown: Shown, size: Size, path: Path) -> None:
        """Write what is shown as `litrig render` does; a flat picture has its own size.

        Raises
        ------
        InputError
            The file cannot be written, or the picture is larger than the graphics driver takes.
        GraphicsError
            The graphics driver failed.
        """
        if shown.mesh is None:
            self._material.save_flat(self._renderer, path, _light(shown))
            return
        with self._renderer.upload(Target, size, self._finer) as target:
            self._draw(shown, target)
            save_rendered(path, target.read(), DARK_GREY)

    def _draw(self, shown: Shown, target: Target) -> None:
        dressed = self._dressed(shown.mesh)
        look = dressed.looks(None if shown.mesh is None else shown.view, _light(shown))
        self._renderer.draw(look, dressed.geometry, target, self._camera(shown, target.size))

    def _camera(self, shown: Shown, size: Size) -> View | Camera:
        if shown.mesh is None and self._material.flat_size is not None:
            return flat_camera(self._material.flat_size, size, shown.zoom, shown.pan)
        return shown.view

    def _dressed(self, mesh: str | None) -> _Set:
        """Lay the material on a mesh; what was there before goes."""
        if self._set is not None and self._set.mesh == mesh:
            return self._set
        self._set = None
        self._held_set.close()
        flat_size = self._material.flat_size
        if mesh is None and flat_size is not None:
            surface = rectangle(flat_size)
        elif mesh is not None:
            surface = staged_mesh(Staging(mesh))
        else:
            raise InputError(f"{self._material.file}: is no flat picture; name a mesh")
        geometry = self._held_set.enter_context(self._renderer.upload(mesh_geometry, surface))
        looks = self._held_set.enter_context(self._material.laid_on(self._renderer, geometry, mesh))
        self._set = _Set(mesh, geometry, looks)
        return self._set

    def _resize(self, size: Size) -> DisplayTarget:
        self._targets.clear()
        self._drawn = None
        self._held_targets.close()
        self._display = self._held_targets.enter_context(self._renderer.upload(DisplayTarget, size))
        return self._display

    def _target(self, size: Size, finer: int) -> Target:
        if finer not in self._targets:
            self._targets[finer] = self._held_targets.enter_context(self._renderer.upload(Target, size, finer))
        return self._targets[finer]


def affordable(size: Size, finer: int) -> int:
    """Return how many times finer a picture can be drawn, at most as many as wanted, in the memory there is for it."""
    while finer > 1 and size[0] * size[1] * finer**2 > MOST_PIXELS:
        finer -= 1
    return finer


def _light(shown: Shown) -> tuple[float, float]:
    """Return where the light is; a material whose light cannot move does not ask."""
    return shown.light or (0.0, 0.0)
