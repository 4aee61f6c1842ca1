"""The journal of a session: one JSON object a line, append-only, and true up to its last whole line.

Every line carries its own CRC-32, so that a torn tail is recognised for what it is. What is in the journal happened;
what is not may have happened but does not count.
"""

import json
import threading
import time
import zlib
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from litrig.base.errors import FormatError, InputError
from litrig.base.store import DISK, Store

VERSION = 1
Entry = dict[str, Any]


def _wall_clock() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds")


class Journal:
    """Appends entries, from any thread; each is on the disk when `append` returns."""

    def __init__(
        self,
        path: Path,
        *,
        store: Store = DISK,
        wall_clock: Callable[[], str] = _wall_clock,
        monotonic_ns: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        """Go on behind the last whole line of a journal, or begin one; a torn tail is cut off with the first entry.

        Raises
        ------
        FormatError
            The journal is damaged in the middle.
        """
        self._path, self._store = path, store
        self._wall_clock, self._monotonic_ns = wall_clock, monotonic_ns
        self._one_at_a_time = threading.Lock()
        self._is_new = not path.exists()
        self._size = self._seq = self.torn_bytes = 0
        if not self._is_new:
            entries, self._size = read_whole_lines(path)
            self._seq = len(entries)
            self.torn_bytes = path.stat().st_size - self._size
        self._is_torn = self.torn_bytes > 0

    def append(self, event: str, **fields: Any) -> Entry:
        """Write one entry and wait until it is durable.

        Raises
        ------
        InputError
            The disk is full or gone; the journal is as it was.
        """
        with self._one_at_a_time:
            return self._append(event, fields)

    def _append(self, event: str, fields: Mapping[str, Any]) -> Entry:
        entry = {
            "v": VERSION,
            "seq": self._seq,
            "t": self._wall_clock(),
            "mono_ns": self._monotonic_ns(),
            "ev": event,
            **fields,
        }
        line = encode_entry(entry)
        try:
            self._write(line)
        except OSError as error:
            with suppress(OSError):
                self._cut()  # half a line would hide the lines behind it
            raise InputError(f"{self._path}: cannot be written ({error.strerror}); free space on that disk") from error
        self._size += len(line)
        self._seq += 1
        self._is_torn = False
        return entry

    def _write(self, line: bytes) -> None:
        if self._is_torn:
            self._cut()
        # Also an interrupt may come between here and the end: then the next entry cuts off what there is.
        self._is_torn = True
        self._store.append(self._path, line)
        self._store.sync(self._path)
        if self._is_new:
            self._store.sync_folder(self._path.parent)
            self._is_new = False

    def _cut(self) -> None:
        """Cut off what lies behind the last whole line."""
        if self._path.exists():
            self._store.cut(self._path, self._size)
        self._is_torn, self.torn_bytes = False, 0


def encode_entry(entry: Mapping[str, Any]) -> bytes:
    """Write an entry as a line, with the CRC-32 of the line without it as the last key."""
    body = json.dumps(entry, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return f'{body[:-1]},"crc":"{zlib.crc32(body.encode()):08x}"}}\n'.encode()


def decode_entry(line: bytes) -> Entry | None:
    """Read a line back; None if it is torn or was changed."""
    try:
        entry = json.loads(line)
        del entry["crc"]
        whole = encode_entry(entry) == line
    except (ValueError, KeyError, TypeError, RecursionError):
        return None
    return entry if whole else None


def read_journal(path: Path) -> list[Entry]:
    """Read every entry up to the first line that is not whole.

    Raises
    ------
    InputError, FormatError
        There is no journal; or a damaged line is followed by whole ones, which no interrupted write explains.
    """
    return read_whole_lines(path)[0]


def read_whole_lines(path: Path) -> tuple[list[Entry], int]:
    """Read a journal as `read_journal` does, and tell how many bytes its whole lines take."""
    try:
        lines = path.read_bytes().splitlines(keepends=True)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); is this a capture folder?") from error
    entries = [decode_entry(line) for line in lines]
    whole = entries.index(None) if None in entries else len(entries)
    if any(entry is not None for entry in entries[whole:]):
        raise FormatError(f"{path}, line {whole + 1}: damaged in the middle; restore the folder from a copy")
    return [entry for entry in entries[:whole] if entry is not None], sum(map(len, lines[:whole]))


def known_harm(entries: Iterable[Entry]) -> set[str]:
    """Return the files that a journal itself says are not as they were shot: found so, and shot again."""
    return {file for entry in entries if entry.get("ev") == "recall" for file in entry.get("files", ())}
