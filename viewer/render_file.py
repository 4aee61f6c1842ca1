"""From a material file to a picture file, or to a video."""

import dataclasses
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
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
from viewer.motion import Course, Moment
from viewer.opened import is_amc, open_looks
from viewer.refusals import is_decomposed
from viewer.render_buffers import render_buffers, uses_buffers
from viewer.render_flat import render_flat
from viewer.renderer import Renderer
from viewer.save import frame_codes, save_rendered
from viewer.staging import DARK_GREY, DEFAULT_MESH, DEFAULT_SIZE_PX, AmcStaging, MatcapStaging, PtmStaging, Staging
from viewer.tangent_lines import lines_look, tangent_lines
from viewer.targets import Target
from viewer.video import check_video, write_video

F32 = NDArray[np.float32]
Drawn = Callable[[Moment], F32]


def render_file(file: Path, output: Path, staging: Staging) -> tuple[int, int]:
    """Draw a material file into a picture file, or a video if something moves, and return its width and height.

    Raises
    ------
    InputError, FormatError
        A file is missing, damaged or of an unknown kind, or the staging does not go with it.
    MissingToolError
        OpenGL is not installed.
    """
    check_video(output, moves=staging.motion is not None)
    if uses_buffers(staging):
        return render_buffers(file, output, staging)
    if holds_material(file) and staging.mesh is None and staging.beside is None:
        return render_flat(file, output, staging)
    if staging.motion is not None and staging.background_srgb is None:
        raise InputError(f"{output}: a video cannot be transparent; choose a background colour")
    width, height = staging.size_px or DEFAULT_SIZE_PX
    size = (width * (1 if staging.beside is None else 2), height)
    with _drawing(file, staging) as draw:
        if staging.motion is None:
            save_rendered(output, draw(Moment(staging.view)), staging.background_srgb)
        else:
            moments = staging.motion.moments(staging.view)
            background = staging.background_srgb or DARK_GREY
            write_video(output, (frame_codes(draw(moment), background) for moment in moments), size, staging.motion.fps)
    return size


@contextmanager
def _drawing(file: Path, staging: Staging) -> Iterator[Drawn]:
    """Open all that is drawn; yields what draws one moment, (H, W, 4) float32, linear light and straight coverage."""
    mesh = staged_mesh(staging)
    size = staging.size_px or DEFAULT_SIZE_PX
    with Renderer() as renderer, ExitStack() as held:
        geometry = held.enter_context(renderer.upload(mesh_geometry, mesh))
        looks = [held.enter_context(open_looks(renderer, file, staging, geometry))]
        if staging.beside is not None:
            looks.append(
                held.enter_context(open_looks(renderer, staging.beside, _staged_beside(staging, file), geometry))
            )
        target = held.enter_context(renderer.upload(Target, size, staging.supersample))
        lines: Geometry | None = None
        if staging.tangents:
            lines = held.enter_context(renderer.upload(tangent_lines, mesh))

        def draw(moment: Moment) -> F32:
            pictures = []
            for look in looks:
                renderer.draw(look(moment), geometry, target, moment.view)
                if lines is not None:
                    renderer.draw(lines_look(), lines, target, moment.view, clear=False)
                pictures.append(target.read())
            return np.asarray(staging.development.apply(np.concatenate(pictures, axis=1)), np.float32)

        yield draw


def _staged_beside(staging: Staging, file: Path) -> Staging:
    """Leave out what was said of the first material and does not go with the second; the mesh has its grain already."""
    other = staging.beside
    lights = staging.ptm.lights if other is not None and is_decomposed(other) and is_decomposed(file) else ()
    is_table = other is not None and is_amc(other)
    amc = AmcStaging(coordinates=staging.amc.coordinates) if is_table else AmcStaging()
    if other is not None and holds_material(other):
        return dataclasses.replace(staging, amc=amc, matcap=MatcapStaging())
    # A light tour of a PTM leaves the other as it is.
    motion = staging.motion
    if motion is not None and holds_material(file):
        motion = dataclasses.replace(motion, course=Course.TURNTABLE)
    ptm = PtmStaging(lights=lights)
    return dataclasses.replace(staging, amc=amc, ptm=ptm, matcap=MatcapStaging(), motion=motion)


def staged_mesh(staging: Staging) -> Mesh:
    """Make or read the mesh with its grain as it is staged; what a file lacks is said on standard error."""
    mesh, remarks = mesh_of(staging.mesh or DEFAULT_MESH)
    for remark in remarks:
        echo(remark, err=True)
    if staging.amc.directions is not None:
        mesh = painted(mesh, read_directions(staging.amc.directions), str(staging.amc.directions))
    if staging.occluded and mesh.occlusion is None:
        mesh = with_occlusion(mesh)
    return turned(mesh, staging.amc.turn_deg)
