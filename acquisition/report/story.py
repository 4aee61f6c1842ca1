"""What happened in a session, in order, and how it stands now: in words."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any

from acquisition.report.record import SessionRecord, moment, wall_time
from litrig.base.capture_folder.journal import Entry
from litrig.base.capture_folder.lock import who_writes


class State(Enum):
    """How a session stands."""

    CLOSED = "closed"
    WRITING = "under way"
    PAUSED = "paused"
    HOLD = "on hold"
    STOPPED = "stopped"
    BROKEN_OFF = "broken off"
    OPEN = "open"


@dataclass(frozen=True)
class Standing:
    """How a session stands, and why."""

    state: State
    reason: str

    def __str__(self) -> str:
        return f"{self.state.value}: {self.reason}"


@dataclass(frozen=True)
class Happening:
    """Something that a person may want to know.

    Attributes
    ----------
    at : wall clock, as the journal labels it
    since_start_s : seconds since the session's beginning by that clock; None if the label is no time
    is_trouble : whether something went wrong
    """

    at: str
    since_start_s: float | None
    what: str
    text: str
    is_trouble: bool


def standing(record: SessionRecord) -> Standing:
    """Tell how a session stands from its folder and the last word of its journal."""
    frames = f"{len(record.counting)} of {len(record.wanted)} frames"
    if writer := who_writes(record.folder):
        return Standing(State.WRITING, f"{writer} writes there")
    if record.verification.closed:
        return Standing(State.CLOSED, "a complete bag" if not record.findings else "as a bag that is not in order")
    last = next((entry for entry in reversed(record.entries) if entry["ev"] in _ENDS), record.entries[-1])
    if last["ev"] == "pause":
        return Standing(State.PAUSED, f"by the operator, after {frames}")
    if last["ev"] == "hold":
        return Standing(State.HOLD, str(last.get("reason", "no reason was given")))
    if last["ev"] == "stop":
        return Standing(State.STOPPED, f"by the operator, after {frames}")
    if last["ev"] == "close":
        return Standing(State.BROKEN_OFF, "all was shot, but the bag was not made complete; resume it")
    if not record.missing:
        return Standing(State.OPEN, "all was shot, but the session was not closed; resume it")
    return Standing(State.BROKEN_OFF, f"its process died or was killed after {frames}; resume it")


_ENDS = frozenset({"frame", "pause", "hold", "stop", "close", "reopened", "segment", "session"})


def story(record: SessionRecord) -> list[Happening]:
    """Return everything but the frames, in order."""
    start = wall_time(record.entries[0].get("t"))
    happenings = []
    for entry in record.entries:
        told = _TELLERS.get(entry["ev"])
        if told is None:
            continue
        what, text, is_trouble = told(entry)
        at = wall_time(entry.get("t"))
        since_s = None if start is None or at is None else (at - start).total_seconds()
        happenings.append(Happening(str(entry.get("t", "")), since_s, what, text, is_trouble))
    return happenings


def segments(record: SessionRecord) -> list[tuple[int, str]]:
    """Return number and description of every segment: the first, and each that was opened later."""
    told = [(1, f"begun {moment(record.entries[0].get('t'))}, litrig {_version(record)}")]
    for index, entry in enumerate(record.of("segment"), 2):
        number = entry.get("number")
        told.append(
            (number if isinstance(number, int) else index, f"resumed {moment(entry.get('t'))}, {_segment(entry)}")
        )
    return told


def _version(record: SessionRecord) -> str:
    session: Mapping[str, Any] = record.settings.get("session", {})
    return str(session.get("litrig", "of unknown version"))


def _segment(entry: Entry) -> str:
    changed = [str(change) for change in entry.get("changed") or ()]
    torn = entry.get("torn_bytes") or 0
    parts = [f"litrig {entry.get('litrig', 'of unknown version')}"]
    parts.append(f"changed: {'; '.join(changed)}" if changed else "same configuration")
    if torn:
        parts.append(f"{torn} bytes of a line that was never whole cut off the journal")
    return ", ".join(parts)


def _step(entry: Entry) -> str:
    return f"step {entry.get('step', '?')}"


def _listed(steps: list[Any]) -> str:
    return f"step {steps[0]}" if len(steps) == 1 else f"{len(steps)} steps ({min(steps)} to {max(steps)})"


_Teller = Callable[[Entry], tuple[str, str, bool]]
_TELLERS: Mapping[str, _Teller] = {
    "session": lambda entry: ("begun", f"object {entry.get('object', '?')}", False),
    "segment": lambda entry: ("resumed", f"segment {entry.get('number', '?')}, {_segment(entry)}", False),
    "retry": lambda entry: (
        "retry",
        f"{_step(entry)}, try {entry.get('attempt', '?')}: the frame {entry.get('reason', '')}",
        True,
    ),
    "reconnect": lambda entry: ("reconnect", f"{_step(entry)}: {entry.get('reason', '')}", True),
    "recall": lambda entry: (
        "recall",
        f"{_listed(entry['steps'])} called back: {entry.get('reason', '')}" if entry["steps"] else "nothing",
        True,
    ),
    "hold": lambda entry: ("hold", str(entry.get("reason", "")), True),
    "pause": lambda _: ("pause", "by the operator; the rig stayed powered", False),
    "stop": lambda _: ("stop", "by the operator, at once", True),
    "confirmed": lambda entry: ("done by hand", f"{_step(entry)}: {entry.get('what', '')}", False),
    "ambient": lambda entry: (
        "ambient light",
        f"{100 * float(entry.get('light') or 0):.2f} % of full light with all lamps dark",
        False,
    ),
    "note": lambda entry: ("note", str(entry.get("text", "")), False),
    "reopened": lambda _: ("reopened", "the closed bag was opened again", False),
    "close": lambda entry: ("closed", f"{entry.get('frames', '?')} frames in the bag", False),
}
