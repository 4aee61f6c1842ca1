"""Recorded wires as ports: they answer what the devices answered, and fail on the first byte that differs.

So a session that went wrong on a bench becomes a test without the bench. Answers are there as soon as what they
answer has been written, so that a replay is quick; with a clock they take the time that they took then, for records
in which the host lost patience.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from itertools import groupby
from typing import Any, NamedTuple

import serial

from rig.clock import Clock
from rig.errors import PortError


class ReplayError(AssertionError):
    """The host does not do what it did when the record was made."""


class _Arrival(NamedTuple):
    """Bytes from the device, how long after the host's last word they were read, and whether they were at all."""

    after_s: float
    content: bytes
    is_lost: bool


class _Turn:
    """What the host wrote, and all that came until it wrote again."""

    def __init__(self, out: bytes, at_s: float) -> None:
        self.out, self.at_s = out, at_s
        self.arrivals: list[_Arrival] = []


class ReplayPort(serial.Serial):
    """One port of a record, from its opening to its end."""

    def __init__(self, name: str, turns: Sequence[_Turn], clock: Clock | None) -> None:
        super().__init__()
        self._name, self._turns, self._clock = name, list(turns), clock
        self._waiting: list[_Arrival] = []
        self._written, self._spoken_s = 0, 0.0
        self._begin_turn()

    def read(self, size: int = 1) -> bytes:
        """Return what came before the host wrote again, and was read then."""
        content = b""
        while self._waiting and not self._waiting[0].is_lost and self._is_due(self._waiting[0]):
            arrival = self._waiting.pop(0)
            content += arrival.content
            if len(content) > size:
                self._waiting.insert(0, arrival._replace(content=content[size:]))
                return content[:size]
        return content

    def write(self, content: Any, /) -> int:
        """Compare with what was written then.

        Raises
        ------
        ReplayError
            It is something else.
        """
        written = bytes(content)
        for place in range(len(written)):
            expected = self._expected()
            if written[place] != expected:
                raise ReplayError(
                    f"{self._name}: byte {place} of {written.hex(' ')} ({written!r}) should be "
                    f"{'none at all, for the record ends here' if expected is None else f'{expected:02x}'}"
                )
            self._written += 1
            if self._written == len(self._turns[0].out):
                self._hear_answer()
        return len(written)

    @property
    def in_waiting(self) -> int:
        """How much can be read."""
        return sum(len(arrival.content) for arrival in self._waiting if self._is_due(arrival))

    def reset_input_buffer(self) -> None:
        """Throw away what has come."""
        self._waiting = [arrival for arrival in self._waiting if not self._is_due(arrival)]

    def close(self) -> None:
        """Nothing to give back."""

    def check_finished(self) -> None:
        """Fail if the host wrote less than in the record.

        Raises
        ------
        ReplayError
            It did.
        """
        rest = b"".join(turn.out for turn in self._turns)[self._written :]
        if rest:
            raise ReplayError(f"{self._name}: ended before {rest[:40]!r}, which the record has next")

    def _expected(self) -> int | None:
        if self._turns and self._written == len(self._turns[0].out):
            self._turns.pop(0)
            self._begin_turn()
        return self._turns[0].out[self._written] if self._turns else None

    def _begin_turn(self) -> None:
        self._written = 0
        if self._turns and not self._turns[0].out:  # the device spoke first
            self._hear_answer()

    def _hear_answer(self) -> None:
        self._waiting = list(self._turns[0].arrivals)
        self._spoken_s = self._clock.now_s() if self._clock is not None else 0.0

    def _is_due(self, arrival: _Arrival) -> bool:
        return self._clock is None or self._clock.now_s() - self._spoken_s >= arrival.after_s


class Replay:
    """All ports of a record; each is opened as often as it was then."""

    def __init__(self, entries: Sequence[Mapping[str, Any]], clock: Clock | None) -> None:
        self._openings: dict[str, list[ReplayPort]] = {}
        self._opened: list[ReplayPort] = []
        for port, of_port in groupby(sorted(entries, key=lambda entry: str(entry["port"])), lambda e: str(e["port"])):
            self._openings[port] = [ReplayPort(port, turns, clock) for turns in _openings(of_port)]

    def open(self, path: str) -> ReplayPort:
        """Open a port.

        Raises
        ------
        PortError
            The record does not have it, or not that often.
        """
        if not self._openings.get(path):
            raise PortError(f"{path}: the record knows no (further) opening of this port; check the port in RIG.toml")
        port = self._openings[path].pop(0)
        self._opened.append(port)
        return port

    def check_finished(self) -> None:
        """Fail if anything of the record was left out.

        Raises
        ------
        ReplayError
            Something was.
        """
        for port in self._opened:
            port.check_finished()
        left = [path for path, ports in self._openings.items() if ports]
        if left:
            raise ReplayError(f"{', '.join(left)}: opened less often than in the record")


_current: ContextVar[Replay | None] = ContextVar("replay", default=None)


def current_replay() -> Replay | None:
    """Return the record that stands in for ports, if one does."""
    return _current.get()


@contextmanager
def replaying(entries: Sequence[Mapping[str, Any]], clock: Clock | None = None) -> Iterator[Replay]:
    """Let a record stand in for every port that is opened while the body lasts, and end when it does.

    Parameters
    ----------
    entries : of `rig.wire_record.read_record`
    clock : lets answers take the time that they took; without it they are there at once

    Raises
    ------
    ReplayError
        The body wrote something else, or left something out.
    """
    replay = Replay(entries, clock)
    before = _current.set(replay)
    try:
        yield replay
    finally:
        _current.reset(before)
    replay.check_finished()


def _openings(entries: Iterator[Mapping[str, Any]]) -> Iterator[list[_Turn]]:
    """Split a port's entries where it was opened, and each part into turns."""
    turns: list[_Turn] | None = None
    for entry in entries:
        way, content, at_s = entry["way"], bytes(entry["bytes"]), float(entry["t"])
        if way == "open":
            if turns is not None:
                yield turns
            turns = [_Turn(b"", at_s)]
        elif turns is None:
            continue
        elif way == "out":
            if turns[-1].arrivals or not turns[-1].out:
                turns.append(_Turn(b"", at_s))
            turns[-1].out += content
            turns[-1].at_s = at_s
        elif way in ("in", "lost"):
            turns[-1].arrivals.append(_Arrival(at_s - turns[-1].at_s, content, way == "lost"))
    if turns is not None:
        yield turns
