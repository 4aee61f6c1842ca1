"""`litrig shape recompose`."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from processing.command_parts import PATH, PICTURES, check_kept, check_output, echo_clipped
from processing.shape.buffers_options import buffers_options, say
from processing.shape.edit_options import edit_options
from processing.shape.horizon import HORIZON

if TYPE_CHECKING:
    from processing.shape.buffers_exr import ReadOptions
    from processing.shape.editing.operations import Recipe
    from processing.shape.model import Environments


@click.command(epilog="Example: litrig shape recompose shot.exr shot.env.exr --ripple 320 240 2 30 -o rippled.png")
@click.argument("file", metavar="BUFFERS.exr", type=PATH)
@click.argument("environment", metavar="X.env.exr", type=PATH)
@edit_options
@buffers_options
@click.option(
    "--horizon",
    metavar="COSINE",
    type=click.FloatRange(0, 1),
    default=HORIZON,
    show_default=True,
    help="Mirrored rays that an edit turns below this cosine to the surface are more and more hidden by it; 0: never, "
    "as the paper has it.",
)
@click.option("--save-recipe", metavar="RECIPE", type=PATH, help="Write all edits as .recipe.toml.")
@click.option("--normals-out", metavar="EXR", type=PATH, help="Write the edited normals, view frame.")
@click.option("-o", "--output", metavar="IMAGE", type=PATH, required=True, help="EXR, PNG, JPEG or TIFF to write.")
def recompose(
    file: Path,
    environment: Path,
    make_recipe: "Callable[[], Recipe]",
    read_options: "Callable[[], ReadOptions]",
    horizon: float,
    save_recipe: Path | None,
    normals_out: Path | None,
    output: Path,
) -> None:
    """Shade a rendered picture again after its surfaces' normals were edited.

    Pixels that no edit touches keep their bits. An EXR gets linear light as it came, with the background; other formats
    get display values. In the name of BUFFERS.exr and of the outputs # stands for a digit of a frame's number, as in
    shot.####.exr: all frames that are there are shaded with the same environments. Masks, normals and height maps may
    be named so too.
    """
    from litrig.base.console import reporting
    from litrig.base.progress import Progress
    from processing.recipe_toml import ENDING
    from processing.shape.editing.recipe_toml import at_frame, files_of, write_recipe
    from processing.shape.env_exr import read_environments

    check_output(output, *PICTURES)
    if normals_out is not None:
        check_output(normals_out, ".exr")
    if save_recipe is not None:
        check_output(save_recipe, ENDING)
    recipe, options = make_recipe(), read_options()
    jobs = _jobs(file, output, normals_out)
    recipes = [recipe if job.number is None else at_frame(recipe, job.number) for job in jobs]
    read = [path for job, edits in zip(jobs, recipes, strict=True) for path in (job.file, *files_of(edits))]
    check_kept([path for job in jobs for path in (job.output, job.normals_out)], [environment, *read])
    environments = read_environments(environment)
    seen: set[int] = set()
    with reporting() as report:
        for done, (job, edits) in enumerate(zip(jobs, recipes, strict=True), 1):
            seen |= set(_shade(job, environments, edits, options, horizon))
            if len(jobs) > 1:
                report(Progress("recompose", done, len(jobs), job.output.name))
    if strange := sorted({number for one in recipe.steps for number in one.surfaces} - seen):
        say(f"no frame shows surface {', '.join(map(str, strange))}")
    if save_recipe is not None:
        write_recipe(save_recipe, recipe)
        click.echo(f"{save_recipe}: {len(recipe.steps)} steps")


@dataclass(frozen=True)
class _Job:
    """One picture to shade, and its number in a sequence."""

    file: Path
    output: Path
    normals_out: Path | None = None
    number: int | None = None


def _jobs(file: Path, output: Path, normals_out: Path | None) -> list[_Job]:
    from litrig.base.errors import InputError
    from processing.shape.frames import frame, frame_numbers, is_pattern

    for name in (output, *([normals_out] if normals_out else [])):
        if is_pattern(name) != is_pattern(file):
            raise InputError(f"{name}: write # for the number of a frame in the buffers' name and here, or in neither")
    if not is_pattern(file):
        return [_Job(file, output, normals_out)]
    return [
        _Job(frame(file, number), frame(output, number), normals_out and frame(normals_out, number), number)
        for number in frame_numbers(file)
    ]


def _shade(
    job: _Job, environments: "Environments", recipe: "Recipe", options: "ReadOptions", horizon: float
) -> list[int]:
    """Shade one picture, and return the surfaces that it shows."""
    from dataclasses import replace

    import numpy as np

    from litrig.base.errors import InputError
    from litrig.base.pictures import write_exr, write_picture
    from processing.shape.buffers_exr import NORMALS, read_buffers
    from processing.shape.displayable import displayable
    from processing.shape.editing.edit import edit
    from processing.shape.extended.blend import recompose_regions
    from processing.shape.recompose import recompose as shade_again

    is_frame = job.number is not None
    buffers = read_buffers(job.file, replace(options, may_be_empty=is_frame), say)
    try:
        edited = edit(buffers, recipe, say, is_frame=is_frame)
    except InputError as error:
        if not is_frame:
            raise
        raise InputError(f"{job.file}: {error}") from error
    touched = np.any(edited.normals != buffers.normals, axis=-1)
    touched |= (edited.diffuse_factor != 1) | (edited.reflection_factor != 1)
    without = sorted(set(np.unique(buffers.surfaces[touched]).tolist()) - set(environments))
    if without:
        say(f"{job.file.name}: no environment of surface {', '.join(map(str, without))}, which stays as it is")
    picture = recompose_regions(
        shade_again,
        buffers,
        environments,
        edited.normals,
        diffuse_factor=edited.diffuse_factor,
        reflection_factor=edited.reflection_factor,
        horizon=horizon,
    )
    changed = np.any(picture != buffers.picture, axis=-1) & (buffers.surfaces > 0)
    shown = displayable(picture, job.output, say)
    echo_clipped(job.output, shown)
    write_picture(job.output, shown)
    if job.normals_out is not None:
        channels = {f"normal.{axis}": np.ascontiguousarray(edited.normals[..., k]) for k, axis in enumerate("XYZ")}
        write_exr(job.normals_out, channels, {"litrig.kind": NORMALS})
    click.echo(f"{job.output}: {picture.shape[1]} × {picture.shape[0]} pixels, {np.mean(changed):.1%} of them changed")
    return buffers.seen
