"""From shading buffers to the picture under other normals."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from litrig.base.errors import InputError
from litrig.base.pictures import write_picture
from processing.shape.buffers_exr import read_buffers, read_normals
from processing.shape.buffers_options import say
from processing.shape.displayable import displayable
from processing.shape.editing.edit import edit
from processing.shape.editing.operations import Recipe
from processing.shape.editing.recipe_toml import read_recipe
from processing.shape.env_exr import read_environments
from processing.shape.extended.blend import recompose_regions
from viewer.materials.shading_buffers import recomposed_picture
from viewer.refusals import refuse_amc_staging, refuse_matcap_staging
from viewer.renderer import Renderer
from viewer.staging import BuffersStaging, PtmStaging, Staging

_KIND = "a rendered picture"


def render_buffers(file: Path, output: Path, staging: Staging) -> tuple[int, int]:
    """Draw it, and return its width and height.

    Raises
    ------
    InputError, FormatError
        A file is missing, damaged or of an unknown kind, or the staging does not go with it.
    MissingToolError
        OpenGL is not installed.
    """
    told = staging.buffers
    environment = _check_staging(file, staging)
    buffers = read_buffers(file, tell=say)
    normals = buffers.normals if told.normals is None else read_normals(told.normals, buffers, tell=say)
    recipe = Recipe() if told.recipe is None else read_recipe(told.recipe)
    edited = edit(replace(buffers, normals=normals), recipe, say)
    with Renderer() as renderer:
        picture = recompose_regions(
            partial(recomposed_picture, renderer),
            buffers,
            read_environments(environment),
            edited.normals,
            diffuse_factor=told.diffuse_factor,
            reflection_factor=told.reflection_factor,
            factor_maps=(edited.diffuse_factor, edited.reflection_factor),
        )
    developed = staging.development.apply(displayable(picture, output, say))
    write_picture(output, np.asarray(developed, np.float32))
    height, width = buffers.shape
    return width, height


def uses_buffers(staging: Staging) -> bool:
    """Tell whether anything was said that rendered pictures alone take."""
    return staging.buffers != BuffersStaging()


def _check_staging(file: Path, staging: Staging) -> Path:
    told = staging.buffers
    if told.environment is None:
        raise InputError(
            f"{file}: other normals and factors are for shading buffers with their environments; give those with "
            "--environment X.env.exr"
        )
    if not (np.isfinite(told.diffuse_factor) and np.isfinite(told.reflection_factor)):
        raise InputError(
            f"{file}: factors {told.diffuse_factor:g} and {told.reflection_factor:g} are no numbers; 1 changes nothing"
        )
    refuse_matcap_staging(file, staging)
    refuse_amc_staging(file, staging, _KIND)
    if staging.ptm != PtmStaging():
        raise InputError(f"{file}: {_KIND} has its light in it; leave out what is for PTMs")
    if staging.motion is not None:
        raise InputError(f"{file}: {_KIND} does not move; leave out --turntable and --tour")
    if staging.mesh is not None or staging.beside is not None or staging.size_px is not None or staging.view.zoom != 1:
        raise InputError(f"{file}: {_KIND} is no mesh, and has its own size; leave out mesh, size, zoom and --beside")
    if staging.mesh_options:
        options = ", ".join(staging.mesh_options)
        raise InputError(f"{file}: {options} would not change {_KIND}; leave it out")
    return told.environment
