"""Records of the wires: what went over each port and when, a line of JSON each, for bug reports and for replay.

Whoever opens a port with `rig.serial_port.open_serial` while `recording` lasts is heard, and need not know of it.
"""

import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, BinaryIO, Literal

import serial

from litrig.base.errors import FormatError, InputError
from litrig.base.files import read_limited
from litrig.base.version import litrig_version

KIND = "litrig wire record"
LARGEST_RECORD_BYTES = 500_000_000

Way = Literal["open", "out", "in", "lost", "close"]
"""Bytes go out to the device and come in from it; those that came in and were thrown away unread are lost."""


class WireRecorder:
    """Appends to a file. What was written is with the system after each line, so that a kill loses nothing."""

    def __init__(self, file: BinaryIO, beside: "WireRecorder | None" = None) -> None:
        self._file, self._beside = file, beside
        self._write({"kind": KIND, "litrig": litrig_version(), "started": datetime.now(UTC).isoformat(" ", "seconds")})

    def note(self, way: Way, port: str, content: bytes = b"", **more: int) -> None:
        """Write down what happened just now on a port."""
        self._write({"t": round(time.monotonic(), 6), "port": port, "way": way, "bytes": content.hex(), **more})
        if self._beside is not None:
            self._beside.note(way, port, content, **more)

    def _write(self, entry: dict[str, Any]) -> None:
        self._file.write(json.dumps(entry).encode() + b"\n")


_current: ContextVar[WireRecorder | None] = ContextVar("wire recorder", default=None)


def current_recorder() -> WireRecorder | None:
    """Return the recorder that is to hear what is opened now, if there is one."""
    return _current.get()


@contextmanager
def recording(path: Path) -> Iterator[WireRecorder]:
    """Record every port that is opened while the body lasts; a record that is there already goes on.

    Who records already goes on recording.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    try:
        file = path.open("ab", buffering=0)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror}); name another file for the record") from error
    with file:
        recorder = WireRecorder(file, _current.get())
        before = _current.set(recorder)
        try:
            yield recorder
        finally:
            _current.reset(before)


class RecordedSerial(serial.Serial):
    """A port that a recorder hears."""

    def __init__(self, recorder: WireRecorder, path: str, baud: int, **options: Any) -> None:
        self._recorder, self._path = recorder, path
        super().__init__(path, baud, **options)
        recorder.note("open", path, baud=baud)

    def read(self, size: int = 1) -> bytes:
        """Read, and note what came."""
        content = bytes(super().read(size))
        if content:
            self._recorder.note("in", self._path, content)
        return content

    def write(self, content: Any, /) -> int | None:
        """Note, and write."""
        self._recorder.note("out", self._path, bytes(content))
        return super().write(content)

    def reset_input_buffer(self) -> None:
        """Note what nobody reads any more: a late reply may be the clue."""
        if waiting := self.in_waiting:
            self._recorder.note("lost", self._path, bytes(super().read(waiting)))
        super().reset_input_buffer()

    def close(self) -> None:
        """Note, and close."""
        if self.is_open:
            self._recorder.note("close", self._path)
        super().close()


def read_record(path: Path) -> list[dict[str, Any]]:
    """Read a record's entries, without its headers; a last line that was cut off is left out.

    Raises
    ------
    InputError, FormatError
        The file is missing, or is no such record.
    """
    lines = read_limited(path, LARGEST_RECORD_BYTES).split(b"\n")
    entries = []
    for number, line in enumerate(lines[:-1], 1):  # what follows the last newline was cut off
        try:
            entry = json.loads(line)
            if entry.get("kind") == KIND:
                continue
            entries.append({**entry, "port": str(entry["port"]), "bytes": bytes.fromhex(entry["bytes"])})
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
            raise FormatError(f"{path}: line {number} is no line of a wire record; record it anew") from error
    if len(lines) < 2 or KIND.encode() not in lines[0]:
        raise FormatError(f"{path}: is no wire record; make one with --record")
    return entries
