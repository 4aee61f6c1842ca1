"""A recipe done to a decomposed MatCap."""

from pathlib import Path
from typing import assert_never

from litrig.base.errors import InputError
from litrig.base.progress import Progress, Report, silent
from processing.matcap.matcap_exr import read_matcap
from processing.matcap.model import DecomposedMatcap
from processing.matcap.recipe.lighting import StepError, align, hang, move, paint, rotate
from processing.matcap.recipe.material import outline, recolour, roughen, scale
from processing.matcap.recipe.mixing import take
from processing.matcap.recipe.operations import (
    Align,
    Colour,
    Gain,
    Hang,
    Move,
    Operation,
    Outline,
    Paint,
    Rotate,
    Roughness,
    Take,
)
from processing.matcap.recipe.recipe_toml import Recipe


def apply_recipe(
    matcap: DecomposedMatcap, recipe: Recipe, folder: Path, source: str = "recipe", report: Report = silent
) -> DecomposedMatcap:
    """Do a recipe's steps one after the other.

    Parameters
    ----------
    folder : where files that the recipe names are looked for
    source : what to call the recipe in errors

    Raises
    ------
    InputError, FormatError
        A file that a step names is missing or damaged, or there is nothing to do a step to.
    """
    for number, step in enumerate(recipe.steps, 1):
        try:
            matcap = _done(matcap, step, folder)
        except StepError as error:
            raise InputError(f"{source}: step {number}, {step.op}: {error}") from error
        report(Progress(f"steps on {source}", number, len(recipe.steps), step.op))
    return matcap


def _done(matcap: DecomposedMatcap, step: Operation, folder: Path) -> DecomposedMatcap:
    match step:
        case Rotate():
            return rotate(matcap, step)
        case Align():
            return align(matcap, step, None if step.to_file is None else read_matcap(folder / step.to_file))
        case Paint():
            return paint(matcap, step)
        case Hang():
            return hang(matcap, step, folder)
        case Move():
            return move(matcap, step)
        case Roughness():
            return roughen(matcap, step)
        case Colour():
            return recolour(matcap, step)
        case Gain():
            return scale(matcap, step)
        case Outline():
            return outline(matcap, step)
        case Take():
            return take(matcap, step, read_matcap(folder / step.from_file))
        case _:
            assert_never(step)
