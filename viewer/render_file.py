"""From a material file to a picture file."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from click import echo
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.amc.files import either
from processing.amc.files.ktx2 import read_levels
from processing.amc.mips import MipLevel
from processing.amc.model import Amc
from processing.mesh.direction_map import read_directions
from processing.mesh.either import mesh_of
from processing.mesh.fields import painted, turned
from processing.mesh.model import Mesh
from processing.ptm.basis import PTM
from processing.ptm.files.either import ENDINGS as PTM_ENDINGS
from processing.ptm.files.either import holds_material, read_any
from processing.ptm.model import Ptm
from viewer.renderer import Renderer
from viewer.save import save_flat, save_rendered
from viewer.view import View

DEFAULT_SIZE_PX = (800, 800)
DEFAULT_LIGHT = (-0.4, 0.4)
DEFAULT_MESH = "torus"
DARK_GREY = (0x20 / 255, 0x21 / 255, 0x24 / 255)


@dataclass(frozen=True)
class Staging:
    """How a material is shown.

    Attributes
    ----------
    mesh : name of a builtin mesh, or a mesh file; None is a torus for an AMC, and flat for a PTM
    light : x and y of the unit vector to a PTM's light, view frame; None is one from the upper left
    size_px : width and height; None is 800 by 800, or the PTM's own size if it is flat
    background_srgb : colour behind the object, display values 0..1; None is transparent
    supersample : draw so many times finer and average
    directions : picture of the grain's direction on the mesh, as `read_directions` reads it; None is the mesh's own
    turn_deg : then turns the grain in the surface, counter-clockwise seen from outside
    mesh_options : what was asked for, by its option's name, that means something on a mesh only
    """

    mesh: str | None = None
    light: tuple[float, float] | None = None
    size_px: tuple[int, int] | None = None
    view: View = field(default_factory=lambda: View(pitch_deg=30))
    background_srgb: tuple[float, float, float] | None = DARK_GREY
    supersample: int = 3
    directions: Path | None = None
    turn_deg: float = 0.0
    mesh_options: tuple[str, ...] = ()


def render_file(file: Path, output: Path, staging: Staging) -> tuple[int, int]:
    """Draw a material file into a picture file, and return its width and height.

    Raises
    ------
    InputError, FormatError
        A file is missing, damaged or of an unknown kind, or the staging does not go with it.
    MissingToolError
        OpenGL is not installed.
    """
    name = file.name.lower()
    if name.endswith(either.ENDINGS):
        return _render_amc(file, output, staging)
    if holds_material(file):
        return (
            _render_flat(file, output, staging) if staging.mesh is None else _render_ptm_on_mesh(file, output, staging)
        )
    endings = ", ".join(either.ENDINGS + PTM_ENDINGS)
    raise InputError(f"{file}: unknown ending; give a file that ends in {endings}, or a web folder")


def _render_amc(file: Path, output: Path, staging: Staging) -> tuple[int, int]:
    if staging.light is not None:
        raise InputError(f"{file}: an AMC was lit when it was captured; leave out the light, turn the object instead")
    mesh = _mesh_with_grain(staging)
    amc, levels = _read_amc(file)
    with Renderer() as renderer:
        picture = renderer.render_amc(
            amc,
            mesh,
            staging.view,
            size=staging.size_px or DEFAULT_SIZE_PX,
            levels=levels,
            supersample=staging.supersample,
        )
    save_rendered(output, picture, staging.background_srgb)
    return _size_of(picture)


def _read_amc(file: Path) -> tuple[Amc, list[MipLevel] | None]:
    """Read a table and its smaller levels; a file that has none leaves them to whoever reads it."""
    if file.name.lower().endswith(either.LOW_RANK):
        return either.read_any(file), None
    amc, levels = read_levels(file)
    return amc, levels if len(levels) > 1 else None


def _mesh(staging: Staging) -> Mesh:
    mesh, remarks = mesh_of(staging.mesh or DEFAULT_MESH)
    for remark in remarks:
        echo(remark, err=True)
    return mesh


def _mesh_with_grain(staging: Staging) -> Mesh:
    mesh = _mesh(staging)
    if staging.directions is not None:
        mesh = painted(mesh, read_directions(staging.directions), str(staging.directions))
    return turned(mesh, staging.turn_deg)


def _refuse_grain(file: Path, staging: Staging) -> None:
    if staging.directions is not None or staging.turn_deg:
        raise InputError(
            f"{file}: a PTM has no grain to turn or to paint; leave out the turn and the directions, or give an AMC"
        )


def _render_flat(file: Path, output: Path, staging: Staging) -> tuple[int, int]:
    _refuse_grain(file, staging)
    if staging.size_px is not None:
        raise InputError(f"{file}: a flat PTM has its own size; leave out the size, or name a mesh")
    if staging.mesh_options:
        options = ", ".join(staging.mesh_options)
        raise InputError(f"{file}: {options} would not change a flat PTM; leave it out, or name a mesh")
    ptm = _read_ptm(file)
    with Renderer() as renderer:
        values = renderer.render_ptm(ptm, staging.light or DEFAULT_LIGHT)
    save_flat(output, values, ptm)
    return _size_of(values)


def _render_ptm_on_mesh(file: Path, output: Path, staging: Staging) -> tuple[int, int]:
    _refuse_grain(file, staging)
    mesh = _mesh(staging)
    ptm = _read_ptm(file)
    with Renderer() as renderer:
        picture = renderer.render_ptm_on_mesh(
            ptm,
            mesh,
            staging.view,
            staging.light or DEFAULT_LIGHT,
            size=staging.size_px or DEFAULT_SIZE_PX,
            supersample=staging.supersample,
        )
    save_rendered(output, picture, staging.background_srgb)
    return _size_of(picture)


def _read_ptm(file: Path) -> Ptm:
    ptm = read_any(file)
    if ptm.basis != PTM:
        raise InputError(f"{file}: is an {ptm.basis}; only {PTM} is drawn here, so give it to litrig ptm relight")
    return ptm


def _size_of(picture: NDArray[np.float32]) -> tuple[int, int]:
    return picture.shape[1], picture.shape[0]
