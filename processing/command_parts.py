"""What the commands of all materials have in common."""

import json
import math
from collections.abc import Callable, Sequence
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from litrig.base.capture_folder.capture import Capture

    Refer = Callable[[Capture], Capture]

PATH = click.Path(path_type=Path)
FOLDER = click.argument("folder", metavar="FOLDER", type=PATH)
PICTURES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".exr")
JSON = click.option("--json", "as_json", is_flag=True, help="Print one JSON object, for programs.")


class _OnlyFinite(click.ParamType[float]):
    def convert(self, value: Any, param: click.Parameter | None, context: click.Context | None) -> float:
        number = float(super().convert(value, param, context))
        if not math.isfinite(number):
            self.fail(f"{number} is not a finite number", param, context)
        return number


class Finite(_OnlyFinite, click.types.FloatParamType):
    """A number, and neither NaN nor infinity."""


class FiniteRange(_OnlyFinite, click.FloatRange):
    """A finite number in a range; the range alone lets NaN pass."""


def references(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options that say what comes off pictures and divides them, handed over as `refer`.

    `refer` takes the capture that was read and returns the one to work on; it says what it does.
    """

    @click.option("--white", metavar="IMAGE", type=PATH, help="Picture of a white card in the sample's place.")
    @click.option("--dark", metavar="IMAGE", type=PATH, help="Picture with the lamps dark, or the lens covered.")
    @click.option("--as-shot", is_flag=True, help="Leave the session's own white and dark frames out of it.")
    @wraps(command)
    def referred(*args: Any, white: Path | None, dark: Path | None, as_shot: bool, **options: Any) -> Any:
        return command(*args, refer=lambda capture: _referred(capture, white, dark, as_shot), **options)

    return referred


def _referred(capture: "Capture", white: Path | None, dark: Path | None, as_shot: bool) -> "Capture":
    from dataclasses import replace

    from litrig.base.capture_folder.capture import Role
    from litrig.base.capture_folder.reader import with_references

    if as_shot:
        capture = replace(capture, frames=tuple(f for f in capture.frames if f.role not in (Role.WHITE, Role.DARK)))
    capture = with_references(capture, white, dark)
    for role, use in ((Role.DARK, "taken off"), (Role.WHITE, "divided by")):
        if names := [frame.path.name for frame in capture.having(role)]:
            click.echo(f"{use}: {names[0]}" + (f" and {len(names) - 1} more" if len(names) > 1 else ""), err=True)
    return capture


def check_output(output: Path, *endings: str) -> None:
    """Refuse before the work what could not be written after it."""
    from litrig.base.errors import InputError

    if not output.name.lower().endswith(endings):
        named = output.suffix or "a name without ending"
        raise InputError(f"{output}: cannot be written as {named}; end it in {' or '.join(endings)}")
    if not output.absolute().parent.is_dir():
        raise InputError(f"{output}: the folder {output.parent} does not exist; create it first")


def check_kept(outputs: Sequence[Path | None], inputs: Sequence[Path]) -> None:
    """Refuse to write over what is read, or one output over the other."""
    from litrig.base.errors import InputError

    taken = {path.resolve(): "is read; write to another name" for path in inputs}
    for output in outputs:
        if output is None:
            continue
        if (place := output.resolve()) in taken:
            raise InputError(f"{output}: {taken[place]}")
        taken[place] = "is to be written twice; give each output a name of its own"


def check_folder(folder: Path) -> None:
    """Refuse before the work a folder that could not be made after it."""
    from litrig.base.errors import InputError

    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder}: is a file; name a folder for the page")
    if not folder.absolute().parent.is_dir():
        raise InputError(f"{folder}: the folder {folder.parent} does not exist; create it first")


def echo_clipped(output: Path, linear: "NDArray[np.float32]") -> None:
    """Say what part of a picture is brighter than its file can hold."""
    import numpy as np

    share = float(np.mean(linear > 1))
    if share > 0 and output.suffix.lower() != ".exr":
        click.echo(f"{share:.1%} of the values are brighter than white and are cut off; write .exr to keep them")


def echo_facts(facts: dict[str, Any], as_json: bool) -> None:
    """Print what is known, a line a fact or as JSON."""
    if as_json:
        click.echo(json.dumps(facts))
        return
    for key, value in facts.items():
        if isinstance(value, dict):
            click.echo(f"{key.replace('_', ' ')}:")
            for name, (least, most) in value.items():
                click.echo(f"  {name}: {least:g} to {most:g}")
        else:
            click.echo(f"{key.replace('_', ' ')}: {value}")
