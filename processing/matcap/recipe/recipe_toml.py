"""`X.recipe.toml`: operations on a decomposed MatCap, in their order."""

import os
from pathlib import Path
from typing import Literal

import tomli_w

from litrig.base.config import StrictModel, read_toml
from litrig.base.errors import InputError
from litrig.base.files import write_atomically
from processing.matcap.recipe.operations import Operation

ENDING = ".recipe.toml"
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
    if not path.name.lower().endswith(ENDING):
        raise InputError(f"{path}: cannot hold a recipe; end the name in {ENDING}")
    steps = [
        # The rest is what it would be without being said.
        {"op": step.op, **step.model_dump(mode="json", exclude_defaults=True, exclude_none=True)}
        for step in recipe.steps
    ]
    write_atomically(path, tomli_w.dumps({"kind": recipe.kind, "steps": steps}).encode())


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
