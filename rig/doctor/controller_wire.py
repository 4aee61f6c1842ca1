"""GRBL as the doctor needs it: is one there, what does it report, how is it set."""

import re
from dataclasses import dataclass

import serial

from rig.clock import Clock

BAUD = 115_200
REPORT = r"<(\w+(?::\d+)?)\|.*>"
POLL_S = 0.005
ANSWER_S = 0.3
BOOT_S = 3.0
ASK_AGAIN_S = 0.25


@dataclass(frozen=True)
class Dialogue:
    """The lines that came after a question, and whether they ended as they should."""

    lines: tuple[str, ...]
    is_complete: bool


class ControllerWire:
    """A GRBL controller behind an open port."""

    def __init__(self, port: serial.Serial, clock: Clock) -> None:
        self._port, self._clock = port, clock

    def state(self, patience_s: float) -> str:
        """Ask for its state until it tells, or for so long; opening a port resets many boards, which then boot."""
        until_s = self._clock.now_s() + patience_s
        while True:
            for line in self._ask(b"?", min(ASK_AGAIN_S, patience_s), REPORT).lines:
                if match := re.fullmatch(REPORT, line):
                    return match[1]
            if self._clock.now_s() >= until_s:
                return ""

    def version(self) -> str:
        """Return what it calls itself, without the text that its owner may have stored in it; empty if it does not."""
        for line in self._ask(b"$I\n", ANSWER_S, r"ok|error:\d+").lines:
            if match := re.fullmatch(r"\[VER:([^:\]]*).*\]", line):
                return match[1]
        return ""

    def settings(self) -> dict[int, float]:
        """Return the `$` settings; none if it does not tell them now."""
        found = self._ask(b"$$\n", 2 * ANSWER_S, r"ok|error:\d+")
        pairs = (re.match(r"\$(\d+)=([-\d.]+)", line) for line in found.lines)
        return {int(pair[1]): float(pair[2]) for pair in pairs if pair} if found.is_complete else {}

    def _ask(self, question: bytes, patience_s: float, end: str) -> Dialogue:
        self._port.reset_input_buffer()
        self._port.write(question)
        until_s = self._clock.now_s() + patience_s
        content = b""
        while self._clock.now_s() < until_s:
            arrived = bytes(self._port.read(4096))
            content += arrived
            lines = [line.strip() for line in content.decode("ascii", errors="replace").split("\n")[:-1]]
            if any(re.fullmatch(end, line) for line in lines):
                return Dialogue(tuple(lines), is_complete=True)
            if not arrived:
                self._clock.sleep(POLL_S)
        return Dialogue(tuple(content.decode("ascii", errors="replace").split("\n")), is_complete=False)


def answers(port: serial.Serial, clock: Clock) -> bool:
    """Tell whether a GRBL controller is behind a port that was taken for something else."""
    try:
        port.baudrate = BAUD
        return ControllerWire(port, clock).state(2 * ASK_AGAIN_S) != ""
    except (serial.SerialException, OSError, ValueError):
        return False
