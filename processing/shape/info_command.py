"""`litrig shape info`."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from processing.command_parts import JSON, PATH, echo_facts
from processing.shape.buffers_options import buffers_options

if TYPE_CHECKING:
    from processing.shape.buffers_exr import ReadOptions


@click.command(epilog="Example: litrig shape info shot.exr --fov 40")
@click.argument("file", metavar="BUFFERS.exr", type=PATH)
@buffers_options
@JSON
def info(file: Path, read_options: "Callable[[], ReadOptions]", as_json: bool) -> None:
    """Tell which buffers are recognised in a rendered picture, what is missing, and which surfaces it shows."""
    from processing.shape.survey import survey

    seen = survey(file, read_options())
    facts: dict[str, Any] = {
        "size": f"{seen.size[0]} × {seen.size[1]}",
        **{name: f"{layers} ({renderer})" for name, (layers, renderer) in seen.found.items()},
        "missing": ", ".join(seen.missing) or "nothing",
        "other layers": ", ".join(seen.unused) or "none",
    }
    facts |= {f"surface {number}": told for number, told in seen.surfaces.items()}
    facts |= {f"note {number}": remark for number, remark in enumerate(seen.remarks, 1)}
    echo_facts(facts, as_json)
