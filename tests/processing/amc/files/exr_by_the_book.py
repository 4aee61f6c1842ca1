"""Read multi-part OpenEXR from the format's description alone: scan lines, ZIP or plain."""

import struct
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

KINDS: dict[int, np.dtype[Any]] = {0: np.dtype("<u4"), 1: np.dtype("<f2"), 2: np.dtype("<f4")}
LINES_OF_ZIP = 16


@dataclass(frozen=True)
class ExrPart:
    """A part's attributes (raw values by name) and channels (by name)."""

    attributes: dict[str, bytes]
    channels: dict[str, NDArray[Any]]

    def text(self, name: str) -> str:
        return self.attributes[name].decode()

    def window(self, name: str) -> tuple[int, int, int, int]:
        left, top, right, bottom = struct.unpack("<4i", self.attributes[name])
        return left, top, right, bottom


class _Cursor:
    def __init__(self, content: bytes) -> None:
        self.content = content
        self.at = 0

    def word(self) -> str:
        end = self.content.index(b"\0", self.at)
        word = self.content[self.at : end].decode()
        self.at = end + 1
        return word

    def integers(self, form: str) -> tuple[int, ...]:
        values = struct.unpack_from(form, self.content, self.at)
        self.at += struct.calcsize(form)
        return values

    def take(self, count: int) -> bytes:
        self.at += count
        return self.content[self.at - count : self.at]


def read_exr(path: Path) -> list[ExrPart]:
    """Read every part, with its pixels."""
    cursor = _Cursor(path.read_bytes())
    magic, version = cursor.integers("<2I")
    assert magic == 20000630
    assert version & 0xFF == 2 and version & 0x1000, "version 2, with several parts"
    headers = []
    while header := _header(cursor):
        headers.append(header)
    chunk_counts = [struct.unpack("<i", header["chunkCount"])[0] for header in headers]
    parts = [ExrPart(header, _blank(header)) for header in headers]
    for number, count in enumerate(chunk_counts):
        for offset in cursor.integers(f"<{count}Q"):
            _chunk(_Cursor(cursor.content), offset, number, parts[number])
    return parts


def _header(cursor: _Cursor) -> dict[str, bytes]:
    attributes = {}
    while name := cursor.word():
        cursor.word()  # the attribute's type
        (size,) = cursor.integers("<i")
        attributes[name] = cursor.take(size)
    return attributes


def _channels(header: dict[str, bytes]) -> list[tuple[str, np.dtype[Any]]]:
    cursor = _Cursor(header["channels"])
    found = []
    while name := cursor.word():
        kind, _, across, down = cursor.integers("<i4s2i")
        assert (across, down) == (1, 1)
        found.append((name, KINDS[kind]))
    return found


def _blank(header: dict[str, bytes]) -> dict[str, NDArray[Any]]:
    left, top, right, bottom = struct.unpack("<4i", header["dataWindow"])
    shape = (bottom - top + 1, right - left + 1)
    return {name: np.zeros(shape, kind) for name, kind in _channels(header)}


def _chunk(cursor: _Cursor, offset: int, number: int, part: ExrPart) -> None:
    cursor.at = offset
    part_number, first_line, size = cursor.integers("<3i")
    assert part_number == number
    top = part.window("dataWindow")[1]
    height = len(next(iter(part.channels.values())))
    (compression,) = part.attributes["compression"]
    assert compression in (0, 3), "none, or ZIP of 16 lines"
    lines = min(LINES_OF_ZIP if compression else 1, height - (first_line - top))
    expected = lines * sum(values[0].nbytes for values in part.channels.values())
    stored = cursor.take(size)
    plain = _Cursor(_unzip(stored) if size < expected else stored)
    assert len(plain.content) == expected
    for line in range(first_line - top, first_line - top + lines):
        for values in part.channels.values():
            values[line] = np.frombuffer(plain.take(values[0].nbytes), values.dtype)


def _unzip(stored: bytes) -> bytes:
    """Inflate, sum the differences up, and shuffle the two halves of the bytes together."""
    differences = np.frombuffer(zlib.decompress(stored), np.uint8).astype(np.int64)
    differences[1:] -= 128
    summed = (np.cumsum(differences) % 256).astype(np.uint8)
    half = (len(summed) + 1) // 2
    plain = np.zeros(len(summed), np.uint8)
    plain[0::2], plain[1::2] = summed[:half], summed[half:]
    return plain.tobytes()
