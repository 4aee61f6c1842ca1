"""What an operator says of a session, and the options to say it by."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from typing import Any, TypeVar

import click

Command = TypeVar("Command", bound=Callable[..., Any])


@dataclass(frozen=True)
class SessionInfo:
    """What the operator says about a session.

    Attributes
    ----------
    object_id : what is on the table
    tangent_zero_deg : direction of the grain at turntable zero, counter-clockwise from the view frame's x axis
    operator : who shoots it
    note : anything else worth knowing in ten years
    """

    object_id: str = "object"
    tangent_zero_deg: float = 0.0
    operator: str = ""
    note: str = ""


def session_options(command: Command) -> Callable[..., Any]:
    """Add the options, and hand them to the command as `info`."""

    @click.option("--object", "object_id", default="object", show_default=True, help="What stands on the table.")
    @click.option(
        "--tangent-zero",
        "tangent_zero_deg",
        type=click.FloatRange(-360, 360),
        default=0.0,
        show_default=True,
        help="Direction of brushing or thread at turntable zero, in degrees from the picture's right, "
        "counter-clockwise.",
    )
    @click.option("--operator", default="", metavar="NAME", help="Who shoots it, for the records.")
    @click.option("--note", default="", metavar="TEXT", help="Anything worth knowing in ten years.")
    @wraps(command)
    def described(*args: Any, object_id: str, tangent_zero_deg: float, operator: str, note: str, **options: Any) -> Any:
        return command(*args, info=SessionInfo(object_id, tangent_zero_deg, operator, note), **options)

    return described
