"""From a PTM file to the flat picture that it is, or to a video of its light going round."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.pictures import write_picture
from litrig.base.radiometry import encode_srgb, to_u8
from processing.ptm.files.either import read_any
from viewer.flat_picture import FlatView, open_flat
from viewer.motion import Course, Moment
from viewer.opened import check_shading, refuse_changed_normals, shading_at
from viewer.refusals import refuse_amc_staging, refuse_matcap_staging
from viewer.renderer import Renderer
from viewer.save import save_values
from viewer.staging import Staging
from viewer.video import check_size, write_video

F32 = NDArray[np.float32]


def render_flat(file: Path, output: Path, staging: Staging) -> tuple[int, int]:
    """Draw it, and return its width and height.

    Raises
    ------
    InputError, FormatError
        A file is missing, damaged or of an unknown kind, or the staging does not go with it.
    MissingToolError
        OpenGL is not installed.
    """
    _check_staging(file, staging)
    shading = staging.ptm.shading()
    ptm = read_any(file)
    check_shading(file, ptm, shading)
    flat = FlatView(staging.ptm.window, staging.view.zoom)
    as_light = shading.view == "lit" and not (shading.is_one_plain_light and staging.development.changes_nothing)
    with Renderer() as renderer:
        width, height = flat.size(flat.cut(ptm))
        if staging.motion is not None:
            check_size(output, width, height)
        with open_flat(renderer, ptm, flat, normals=shading.needs_normals, brightest=shading.needs_brightest) as draw:

            def drawn(moment: Moment) -> F32:
                values = draw(shading_at(shading, moment), as_light)
                return np.asarray(staging.development.apply(values), np.float32) if as_light else values

            if staging.motion is not None:
                frames = (drawn(moment) for moment in staging.motion.moments(staging.view))
                codes = (to_u8(encode_srgb(frame) if as_light else frame) for frame in frames)
                write_video(output, codes, (width, height), staging.motion.fps)
            elif as_light:
                write_picture(output, drawn(Moment(staging.view)))
            else:
                are_display = shading.view == "normals" or ptm.space == "srgb"
                save_values(output, drawn(Moment(staging.view)), are_display=are_display)
    return width, height


def _check_staging(file: Path, staging: Staging) -> None:
    refuse_matcap_staging(file, staging)
    refuse_amc_staging(file, staging, "a PTM")
    if staging.size_px is not None:
        raise InputError(
            f"{file}: a flat PTM has its own size; leave out the size and say it by --zoom, or name a mesh"
        )
    if staging.mesh_options:
        options = ", ".join(staging.mesh_options)
        raise InputError(f"{file}: {options} would not change a flat PTM; leave it out, or name a mesh")
    if staging.motion is not None and staging.motion.course is Course.TURNTABLE:
        raise InputError(f"{file}: a flat PTM does not turn; use --tour, or name a mesh")
    refuse_changed_normals(file, staging)
