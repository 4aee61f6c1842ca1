"""From a material file to a picture file."""

import dataclasses
from pathlib import Path

import numpy as np
from click import echo
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.mesh.direction_map import read_directions
from processing.mesh.either import mesh_of
from processing.mesh.fields import painted, turned
from processing.mesh.model import Mesh
from processing.mesh.occlusion_cache import with_occlusion
from processing.ptm.files.either import holds_material
from viewer.geometry import Geometry, mesh_geometry
from viewer.materials.ptm import ptm_picture
from viewer.opened import is_amc, open_look, read_ptm_to_draw, refuse_amc_staging
from viewer.renderer import Renderer
from viewer.save import save_flat, save_rendered
from viewer.staging import DEFAULT_LIGHT, DEFAULT_MESH, DEFAULT_SIZE_PX, AmcStaging, PtmStaging, Staging
from viewer.tangent_lines import lines_look, tangent_lines
from viewer.targets import Target

F32 = NDArray[np.float32]


def render_file(file: Path, output: Path, staging: Staging) -> tuple[int, int]:
    """Draw a material file into a picture file, and return its width and height.

    Raises
    ------
    InputError, FormatError
        A file is missing, damaged or of an unknown kind, or the staging does not go with it.
    MissingToolError
        OpenGL is not installed.
    """
    if holds_material(file) and staging.mesh is None and staging.beside is None:
        return _render_flat(file, output, staging)
    mesh = _staged_mesh(staging)
    with Renderer() as renderer, renderer.upload(mesh_geometry, mesh) as geometry:
        pictures = [_mesh_picture(renderer, file, staging, mesh, geometry)]
        if staging.beside is not None:
            pictures.append(_mesh_picture(renderer, staging.beside, _staged_beside(staging), mesh, geometry))
    picture = np.concatenate(pictures, axis=1)
    save_rendered(output, picture, staging.background_srgb)
    return picture.shape[1], picture.shape[0]


def _mesh_picture(renderer: Renderer, file: Path, staging: Staging, mesh: Mesh, geometry: Geometry) -> F32:
    size = staging.size_px or DEFAULT_SIZE_PX
    with (
        open_look(renderer, file, staging, geometry) as look,
        renderer.upload(Target, size, staging.supersample) as target,
    ):
        renderer.draw(look, geometry, target, staging.view)
        if staging.tangents:
            with renderer.upload(tangent_lines, mesh) as lines:
                renderer.draw(lines_look(), lines, target, staging.view, clear=False)
        return target.read()


def _staged_beside(staging: Staging) -> Staging:
    """Leave out what was said of the first material and does not go with the second; the mesh has its grain already."""
    other = staging.beside
    is_table = other is not None and is_amc(other)
    amc = AmcStaging(coordinates=staging.amc.coordinates) if is_table else AmcStaging()
    is_ptm = other is not None and holds_material(other)
    ptm = staging.ptm if is_ptm else PtmStaging()
    return dataclasses.replace(staging, amc=amc, ptm=ptm, light=staging.light if is_ptm else None)


def _staged_mesh(staging: Staging) -> Mesh:
    mesh, remarks = mesh_of(staging.mesh or DEFAULT_MESH)
    for remark in remarks:
        echo(remark, err=True)
    if staging.amc.directions is not None:
        mesh = painted(mesh, read_directions(staging.amc.directions), str(staging.amc.directions))
    if staging.occluded and mesh.occlusion is None:
        mesh = with_occlusion(mesh)
    return turned(mesh, staging.amc.turn_deg)


def _render_flat(file: Path, output: Path, staging: Staging) -> tuple[int, int]:
    refuse_amc_staging(file, staging, "a PTM")
    if staging.size_px is not None:
        raise InputError(f"{file}: a flat PTM has its own size; leave out the size, or name a mesh")
    if staging.mesh_options:
        options = ", ".join(staging.mesh_options)
        raise InputError(f"{file}: {options} would not change a flat PTM; leave it out, or name a mesh")
    ptm = read_ptm_to_draw(file)
    with Renderer() as renderer:
        values = ptm_picture(renderer, ptm, staging.light or DEFAULT_LIGHT)
    save_flat(output, values, ptm)
    return values.shape[1], values.shape[0]
