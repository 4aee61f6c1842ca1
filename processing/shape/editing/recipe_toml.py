"""`.recipe.toml`: edits of shape in their order, `[[steps]]` each. Files are named from the recipe's own folder."""

import os
from collections.abc import Callable
from pathlib import Path

from litrig.base.config import read_toml
from processing.recipe_toml import write_steps
from processing.shape.editing.operations import AnyOperation, Recipe
from processing.shape.frames import frame


def read_recipe(path: Path) -> Recipe:
    """Read a recipe; the files that it names are found from its folder.

    Raises
    ------
    InputError
        The file is missing, or cannot be read.
    ConfigError
        It is no TOML, or says what no edit understands.
    """
    folder = path.absolute().parent
    return _with_files(read_toml(path, Recipe), lambda file: folder / file)


def write_recipe(path: Path, recipe: Recipe) -> None:
    """Write a recipe, the files in it named from its folder.

    Raises
    ------
    InputError
        The name does not end in .recipe.toml, or the file cannot be written.
    """
    folder = path.absolute().parent
    told = _with_files(recipe, lambda file: Path(os.path.relpath(file.absolute(), folder)))
    write_steps(path, recipe.kind, [(step.op, step) for step in told.steps])


def at_frame(recipe: Recipe, number: int) -> Recipe:
    """Return the recipe for one frame of a sequence: # in the names of its files becomes the frame's number."""
    return _with_files(recipe, lambda file: frame(file, number))


def files_of(recipe: Recipe) -> list[Path]:
    """Return the files that a recipe reads."""
    return [file for one in recipe.steps for file in _files(one).values()]


def _with_files(recipe: Recipe, change: Callable[[Path], Path]) -> Recipe:
    return Recipe(steps=tuple(_changed(one, change) for one in recipe.steps))


def _changed(one: AnyOperation, change: Callable[[Path], Path]) -> AnyOperation:
    return one.model_copy(update={name: change(file) for name, file in _files(one).items()})


def _files(one: AnyOperation) -> dict[str, Path]:
    return {name: value for name in type(one).model_fields if isinstance(value := getattr(one, name), Path)}
