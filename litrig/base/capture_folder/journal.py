"""The journal of a session: one JSON object a line, append-only, and true up to its last whole line.

Every line carries its own CRC-32, so that a torn tail is recognised for what it is. What is in the journal happened;
what is not may have happened but does not count.
"""

import errno
import json
import os
import time
import zlib
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from litrig.base.errors import FormatError, InputError
from litrig.base.files import sync_folder

VERSION = 1
Entry = dict[str, Any]


def _wall_clock() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds")


class Journal:
    """Appends entries; each is on the disk when `append` returns."""

    def __init__(
        self,
        path: Path,
        *,
        wall_clock: Callable[[], str] = _wall_clock,
        monotonic_ns: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        self._seq = 0
        self._wall_clock = wall_clock
        self._monotonic_ns = monotonic_ns
        created = not path.exists()
        self._path = path
        self._file = path.open("ab", buffering=0)
        if created:
            sync_folder(path.parent)

    def append(self, event: str, **fields: Any) -> Entry:
        """Write one entry and wait until it is durable."""
        entry = {
            "v": VERSION,
            "seq": self._seq,
            "t": self._wall_clock(),
            "mono_ns": self._monotonic_ns(),
            "ev": event,
            **fields,
        }
        try:
            # Unbuffered: what a full disk refuses must not go out later, behind a line that says otherwise.
            self._write_whole(encode_entry(entry))
            os.fsync(self._file.fileno())
        except OSError as error:
            raise InputError(f"{self._path}: cannot be written ({error.strerror}); free space on that disk") from error
        self._seq += 1
        return entry

    def _write_whole(self, line: bytes) -> None:
        start = os.fstat(self._file.fileno()).st_size
        try:
            written = self._file.write(line)
            if written != len(line):
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))  # noqa: TRY301  # as a full disk says it
        except OSError:
            os.ftruncate(self._file.fileno(), start)  # half a line would hide the lines behind it
            raise

    def close(self) -> None:
        """Close the file; every entry is already durable."""
        self._file.close()


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
    try:
        lines = path.read_bytes().splitlines(keepends=True)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); is this a capture folder?") from error
    entries = [decode_entry(line) for line in lines]
    whole = entries.index(None) if None in entries else len(entries)
    if any(entry is not None for entry in entries[whole:]):
        raise FormatError(f"{path}, line {whole + 1}: damaged in the middle; restore the folder from a copy")
    return [entry for entry in entries[:whole] if entry is not None]
