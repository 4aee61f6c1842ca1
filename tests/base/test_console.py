import os
import sys
from contextlib import suppress
from pathlib import Path

import pytest

from litrig.base.console import PlainLines, reporting
from litrig.base.progress import Progress


def test_a_line_is_printed_when_a_job_ends(capsys: pytest.CaptureFixture[str]) -> None:
    PlainLines()(Progress("fitting", 3, 3, "c.png"))
    assert capsys.readouterr().err == "fitting: 3/3  c.png\n"


def test_a_job_goes_on_when_nobody_can_hear_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    lines = PlainLines()
    with Path("/dev/full").open("wb", buffering=0) as full:
        monkeypatch.setattr(sys, "stderr", Unbuffered(full))
        for done in range(4):
            lines(Progress("fitting", done, 3))


class Unbuffered:
    def __init__(self, file: object) -> None:
        self._file = file

    def write(self, text: str) -> None:
        self._file.write(text.encode())  # type: ignore[attr-defined]  # a raw file

    def flush(self) -> None:
        pass


def test_a_terminal_that_is_closed_does_not_end_the_job(monkeypatch: pytest.MonkeyPatch) -> None:
    master, slave = os.openpty()
    with os.fdopen(slave, "w") as terminal:
        monkeypatch.setattr(sys, "stderr", terminal)
        monkeypatch.setenv("TERM", "xterm")
        with reporting() as report:
            report(Progress("shooting", 1, 3))
            os.close(master)
            report(Progress("shooting", 3, 3))
            assert not report.ask("put the card there")
        monkeypatch.undo()
        with suppress(OSError):
            terminal.close()
