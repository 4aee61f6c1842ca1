"""Writing `X.recipe.toml`: the kind of what is edited, and steps with an `op` each."""

from collections.abc import Iterable
from pathlib import Path

import tomli_w

from litrig.base.config import StrictModel
from litrig.base.errors import InputError
from litrig.base.files import write_atomically

ENDING = ".recipe.toml"


def write_steps(path: Path, kind: str, steps: Iterable[tuple[str, StrictModel]]) -> None:
    """Write a recipe; the file is whole or not there.

    Parameters
    ----------
    steps : the `op` of each step, and the step; what it would be without being said is left out

    Raises
    ------
    InputError
        The name does not end in .recipe.toml, or the file cannot be written.
    """
    if not path.name.lower().endswith(ENDING):
        raise InputError(f"{path}: cannot hold a recipe; end the name in {ENDING}")
    told = [{"op": op, **step.model_dump(mode="json", exclude_defaults=True, exclude_none=True)} for op, step in steps]
    write_atomically(path, tomli_w.dumps({"kind": kind, "steps": told}).encode())
