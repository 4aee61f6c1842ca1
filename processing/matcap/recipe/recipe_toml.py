"""`X.recipe.toml`: operations on a decomposed MatCap, in their order."""

import os
from pathlib import Path
from typing import Literal

from litrig.base.config import StrictModel, read_toml
from processing.matcap.recipe.operations import Operation
from processing.recipe_toml import write_steps

_FILE_KEYS = ("image", "to_file", "from_file")


class Recipe(StrictModel):
    """Steps, each done to what the one before left. Files are named as seen from the recipe's folder."""

    kind: Literal["matcap"] = "matcap"
    steps: tuple[Operation, ...] = ()


def read_recipe(path: Path) -> Recipe:
    """Read a recipe.

    Raises
    ------
    InputError, ConfigError
        The file is missing, is no TOML, or has a step, key or value that is none.
    """
    return read_toml(path, Recipe)


def write_recipe(path: Path, recipe: Recipe) -> None:
    """Write a recipe; the file is whole or not there.

    Raises
    ------
    InputError
        The name does not end in .recipe.toml, or the file cannot be written.
    """
    write_steps(path, recipe.kind, [(step.op, step) for step in recipe.steps])


def rebased(recipe: Recipe, before: Path, after: Path) -> Recipe:
    """Name the files of a recipe as seen from another folder."""

    def seen(name: str) -> str:
        whole = before / name
        return name if Path(name).is_absolute() else os.path.relpath(whole, after)

    steps = []
    for step in recipe.steps:
        names = {key: getattr(step, key) for key in _FILE_KEYS if getattr(step, key, None) is not None}
        steps.append(step.model_copy(update={key: seen(name) for key, name in names.items()}))
    return Recipe(steps=tuple(steps))
