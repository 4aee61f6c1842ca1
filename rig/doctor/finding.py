"""What the doctor says: one finding a check."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum


class State(StrEnum):
    """How bad it is."""

    OK = "ok"
    WARNING = "warning"
    """The rig works, but not as well as it could, or not for long."""
    FAULT = "fault"
    """A session would fail, or be worthless."""


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at.

    Attributes
    ----------
    part : section of RIG.toml, or `rig`, `disk`, `clock`
    name : what of it was looked at, in a word or two
    state : how it is
    what : what was found
    next_step : what to do about it; empty if nothing needs doing
    """

    part: str
    name: str
    state: State
    what: str
    next_step: str = ""

    def as_json(self) -> dict[str, str]:
        """Return it as `--json` prints it."""
        return {
            "part": self.part,
            "name": self.name,
            "state": self.state.value,
            "what": self.what,
            "next_step": self.next_step,
        }


Findings = Iterator[Finding]


@dataclass(frozen=True)
class Part:
    """Makes findings about one part."""

    name: str

    def ok(self, name: str, what: str) -> Finding:
        """Tell what is well."""
        return Finding(self.name, name, State.OK, what)

    def warning(self, name: str, what: str, next_step: str) -> Finding:
        """Tell what works for now."""
        return Finding(self.name, name, State.WARNING, what, next_step)

    def fault(self, name: str, what: str, next_step: str) -> Finding:
        """Tell what does not work."""
        return Finding(self.name, name, State.FAULT, what, next_step)

    def refused(self, name: str, error: Exception) -> Finding:
        """Tell an error of ours, whose message has the reason and the next step."""
        what, _, next_step = str(error).partition("; ")
        return self.fault(name, what, next_step)
