"""Run a command in front, as a shell does: it gets the terminal and its signals, we wait."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from types import FrameType
from typing import Self

from firmware_sim.errors import SimError

PASSED_ON = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)
SIGNAL_BASE = 128
"""A command that a signal ended has this plus the signal's number as its status, as in shells."""


def run_in_front(command: Sequence[str], environment: Mapping[str, str]) -> int:
    """Run a command with our standard input and output, and return its exit status.

    It is a process group of its own, so that each signal reaches it exactly once: from the terminal if it has one, from
    us if somebody signals us.

    Raises
    ------
    SimError
        There is no such command, or it may not be run.
    """
    terminal = _our_terminal()
    with _Signals() as signals, _lent(terminal):
        try:
            # The command takes the terminal itself, before it is what it is: whoever hears from it may press Ctrl-C.
            process = subprocess.Popen(
                list(command), env=dict(environment), process_group=0, preexec_fn=partial(_take, terminal)
            )
        except OSError as error:
            reason = error.strerror or error
            raise SimError(f"{command[0]}: cannot be run ({reason}); check its spelling, or give its path") from error
        signals.pass_on_to(process)
        status = process.wait()
    return status if status >= 0 else SIGNAL_BASE - status


class _Signals:
    """Passes our signals on to a process; those that come before it is there wait for it."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._early: list[int] = []

    def __enter__(self) -> Self:
        self._before = {number: signal.signal(number, self._heard) for number in PASSED_ON}
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def pass_on_to(self, process: "subprocess.Popen[bytes]") -> None:
        self._process = process
        for number in self._early:
            process.send_signal(number)

    def _heard(self, number: int, _: FrameType | None) -> None:
        if self._process is None:
            self._early.append(number)
        else:
            self._process.send_signal(number)


def _take(terminal: int | None) -> None:
    """Bring this process's group to the front of a terminal."""
    if terminal is not None:
        with suppress(OSError):  # it has just gone
            _bring_to_front(terminal)


def _bring_to_front(terminal: int) -> None:
    # Who is not in front may change that only while it ignores this signal.
    before = signal.signal(signal.SIGTTOU, signal.SIG_IGN)
    try:
        os.tcsetpgrp(terminal, os.getpgrp())
    finally:
        signal.signal(signal.SIGTTOU, before)


@contextmanager
def _lent(terminal: int | None) -> Iterator[None]:
    """Take the terminal back at the end, if it was ours to give."""
    try:
        yield
    finally:
        if terminal is not None:
            _bring_to_front(terminal)


def _our_terminal() -> int | None:
    try:
        terminal = sys.stdin.fileno()
        in_front = os.isatty(terminal) and os.tcgetpgrp(terminal) == os.getpgrp()
    except (OSError, ValueError):  # closed, or replaced by something without a file
        return None
    return terminal if in_front else None
