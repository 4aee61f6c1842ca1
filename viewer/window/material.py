"""A material file opened for the window: lit as often as wanted.

This is the window's one door to the kinds of material; it knows nothing of any but that the light of a PTM and of a
decomposed MatCap moves, and that a PTM can be seen flat.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from litrig.base.errors import InputError
from processing.ptm.files.either import holds_material, read_any
from processing.ptm.model import Ptm
from viewer.flat_picture import flat_picture
from viewer.geometry import Geometry
from viewer.look import Look
from viewer.materials.ptm import PtmMaterial
from viewer.materials.ptm_shading import DEFAULT_LIGHT, PtmShading, shading_lights
from viewer.motion import Moment
from viewer.opened import open_looks
from viewer.refusals import is_decomposed
from viewer.renderer import Renderer
from viewer.save import save_values
from viewer.staging import DEFAULT_MESH, Staging
from viewer.view import View
from viewer.window.state import Light

Looks = Callable[[View | None, Light], Look]
"""Says how the material looks in a view, or flat, under a light; cheap."""


IN_THE_CAMERA: Light = (0.0, 0.0)


@dataclass(frozen=True)
class Material:
    """What the window knows of a material file.

    Attributes
    ----------
    ptm : what was read, if it is a PTM; other kinds are read as they are laid on a mesh
    """

    file: Path
    ptm: Ptm | None

    @property
    def light(self) -> Light | None:
        """Where its light is at first, x and y of the unit vector; None if it cannot move."""
        if self.ptm is not None:
            return DEFAULT_LIGHT
        return IN_THE_CAMERA if is_decomposed(self.file) else None

    @property
    def flat_size(self) -> tuple[int, int] | None:
        """Width and height of the picture that it is, in texels; None if it is none."""
        return None if self.ptm is None else (self.ptm.shape[1], self.ptm.shape[0])

    @property
    def mesh(self) -> str | None:
        """What `litrig render` shows it on if nobody says; None is flat."""
        return DEFAULT_MESH if self.ptm is None else None

    @contextmanager
    def laid_on(self, renderer: Renderer, geometry: Geometry, mesh: str | None) -> Iterator[Looks]:
        """Upload it for a mesh, or for the rectangle of its flat picture if there is none.

        Raises
        ------
        InputError, FormatError
            The file is missing, damaged or of an unknown kind, or does not go with the mesh.
        """
        if self.ptm is None:
            with open_looks(renderer, self.file, Staging(mesh), geometry) as looks:
                yield lambda view, light: looks(Moment(view or View(), matcap_light=light))
            return
        # Flat, the stored values are the display's values, whatever was fitted.
        ptm = replace(self.ptm, space="srgb") if mesh is None else self.ptm
        with renderer.upload(PtmMaterial, ptm, smooth=True) as material:
            yield lambda _, light: material.mesh_look(_lit(light))

    def save_flat(self, renderer: Renderer, path: Path, light: Light) -> None:
        """Write the picture that it is, at its own size, by the code of `litrig render`."""
        if self.ptm is None:
            raise InputError(f"{self.file}: is no flat picture; choose a mesh")
        values = flat_picture(renderer, self.ptm, _lit(light))
        save_values(path, values, are_display=self.ptm.space == "srgb")


def read_material(file: Path) -> Material:
    """Open a material file.

    Raises
    ------
    InputError, FormatError
        The file is missing or damaged; what is no PTM is looked at when it is laid on a mesh.
    """
    if holds_material(file):
        return Material(file, read_any(file))
    if not file.exists():
        raise InputError(f"{file}: no such file; check the name")
    return Material(file, None)


def _lit(light: Light) -> PtmShading:
    return PtmShading(shading_lights((light,)))
