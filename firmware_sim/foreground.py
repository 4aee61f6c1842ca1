"""Run a command in front, as a shell does: it gets the terminal and its signals, we wait."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from types import FrameType

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
    try:
        process = subprocess.Popen(list(command), env=dict(environment), process_group=0)
    except OSError as error:
        reason = error.strerror or error
        raise SimError(f"{command[0]}: cannot be run ({reason}); check its spelling, or give its path") from error
    with _terminal_for(process.pid), _signals_for(process):
        status = process.wait()
    return status if status >= 0 else SIGNAL_BASE - status


@contextmanager
def _signals_for(process: "subprocess.Popen[bytes]") -> Iterator[None]:
    def pass_on(number: int, _: FrameType | None) -> None:
        process.send_signal(number)

    before = {number: signal.signal(number, pass_on) for number in PASSED_ON}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def _terminal_for(group: int) -> Iterator[None]:
    """Hand the terminal to a process group and take it back, if it is ours to give."""
    terminal = _our_terminal()
    if terminal is None:
        yield
        return
    # Who is not in front may change that only while it ignores this signal.
    before = signal.signal(signal.SIGTTOU, signal.SIG_IGN)
    try:
        os.tcsetpgrp(terminal, group)
        yield
    finally:
        os.tcsetpgrp(terminal, os.getpgrp())
        signal.signal(signal.SIGTTOU, before)


def _our_terminal() -> int | None:
    try:
        terminal = sys.stdin.fileno()
        in_front = os.isatty(terminal) and os.tcgetpgrp(terminal) == os.getpgrp()
    except (OSError, ValueError):  # closed, or replaced by something without a file
        return None
    return terminal if in_front else None
