"""What each key does, and how the panel says it."""

from collections.abc import Callable
from dataclasses import dataclass

from viewer.window.state import Hand

Answer = Callable[[Hand], Hand]


@dataclass(frozen=True)
class Key:
    """A key of the keyboard by the name that imgui has for it, and what the hand does then."""

    name: str
    answer: Answer
    repeats: bool = False


def _zoomed(notches: int) -> Answer:
    return lambda hand: hand.scrolled(notches, (0.0, 0.0))


def _turned(right: int, up: int) -> Answer:
    return lambda hand: hand.turned_by(right, up)


KEYS = (
    Key("left_arrow", _turned(-1, 0), repeats=True),
    Key("right_arrow", _turned(1, 0), repeats=True),
    Key("up_arrow", _turned(0, 1), repeats=True),
    Key("down_arrow", _turned(0, -1), repeats=True),
    Key("equal", _zoomed(1), repeats=True),
    Key("keypad_add", _zoomed(1), repeats=True),
    Key("minus", _zoomed(-1), repeats=True),
    Key("keypad_subtract", _zoomed(-1), repeats=True),
    Key("p", Hand.in_other_projection),
    Key("m", Hand.on_next_mesh),
    Key("r", Hand.reset),
)
SAVE_KEYS = {"s": ".png", "e": ".exr"}
CLOSE_KEYS = ("escape", "q")

LIGHT_HELP = "right drag"
HELP = (
    ("drag", "turn; a flat picture: move"),
    (LIGHT_HELP, "move the light"),
    ("wheel, + −", "zoom"),
    ("arrows", "turn"),
    ("P", "projection"),
    ("M", "next mesh"),
    ("R", "reset the view"),
    ("S, E", "snapshot: PNG, EXR"),
    ("Q, Esc", "close"),
)
