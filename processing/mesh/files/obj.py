"""Wavefront OBJ: places, texture coordinates, normals and faces; materials and the files they name are not looked at.

Written here although trimesh reads OBJ: that takes relative indices for those of the whole file, the index 0 for 1, and
drops texture coordinates without a word if one index is wrong (docs/decisions/0006-obj-read-here.md).
"""

import warnings
from collections import defaultdict
from dataclasses import dataclass, field
from itertools import compress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import FormatError
from litrig.base.files import read_limited
from processing.mesh.files.pieces import MOST_BYTES, MOST_LINES, MOST_TRIANGLES, Piece

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

_TABLES = {b"v": "v", b"vt": "vt", b"vn": "vn"}
_WIDTHS = {"v": 3, "vt": 2, "vn": 3}
_NOUGHT = (0, 0, 0)
_LONGEST = 1 << 20
"""Of a line, in bytes: a polygon of some hundred thousand corners."""


@dataclass
class _Faces:
    """Faces that are written alike: as many corners, and the same kinds of index at each."""

    lines: list[bytes] = field(default_factory=list)
    numbers: list[int] = field(default_factory=list)
    """Of the lines in the file."""
    counts: list[tuple[int, int, int]] = field(default_factory=list)
    """Rows of v, vt and vn before each line, from which negative indices count back; 0 where there are none."""


def read_obj(path: Path) -> list[Piece]:
    """Read an OBJ file; polygons are cut into fans of triangles.

    Raises
    ------
    InputError, FormatError
        The file is missing, too large, or a line of it makes no sense; the message names the line.
    """
    content = read_limited(path, MOST_BYTES)
    if max(content.count(b"\n"), content.count(b"\r")) > MOST_LINES:
        raise FormatError(f"{path}: has more than {MOST_LINES:,} lines; reduce it")
    if sum(content.count(start) for start in (b"\nf ", b"\nf\t", b"\rf ", b"\rf\t")) > MOST_TRIANGLES:
        raise FormatError(f"{path}: has more than {MOST_TRIANGLES:,} faces; reduce it")
    tables, faces = _sort_lines(path, content)
    rows = {name: _numbers(path, name, lines, numbers) for name, (lines, numbers) in tables.items()}
    triangles = sum(len(alike.lines) * (corners - 2) for (corners, _), alike in faces.items())
    if triangles > MOST_TRIANGLES:
        raise FormatError(f"{path}: has {triangles:,} triangles, {MOST_TRIANGLES:,} are the most; reduce it")
    if not triangles:
        raise FormatError(f"{path}: holds no faces; export it again, as triangles")
    return [_piece(path, rows, corners, kinds, alike) for (corners, kinds), alike in faces.items()]


def _sort_lines(
    path: Path, content: bytes
) -> tuple[dict[str, tuple[list[bytes], list[int]]], dict[tuple[int, str], _Faces]]:
    """Part the lines by what they tell, each with its number."""
    tables: dict[str, tuple[list[bytes], list[int]]] = {name: ([], []) for name in _WIDTHS}
    faces: dict[tuple[int, str], _Faces] = defaultdict(_Faces)
    places, layouts, uprights = (tables[name][0] for name in _WIDTHS)
    for number, line in enumerate(_lines(content), start=1):
        if len(line) > _LONGEST:
            raise FormatError(f"{path}: line {number} has more than {_LONGEST:,} bytes; export it again, as triangles")
        keyword, _, rest = line.strip().partition(b" ")
        if keyword == b"f":
            rest = rest.partition(b"#")[0]
            alike = faces[_way_of_writing(path, number, rest)]
            alike.lines.append(rest)
            alike.numbers.append(number)
            alike.counts.append((len(places), len(layouts), len(uprights)) if b"-" in rest else _NOUGHT)
        elif (name := _TABLES.get(keyword)) is not None:
            tables[name][0].append(rest.partition(b"#")[0])
            tables[name][1].append(number)
    return tables, dict(faces)


def _lines(content: bytes) -> list[bytes]:
    """Cut at any kind of line end; a continued line stays where it begins, with empty ones after it."""
    lines = content.replace(b"\r\n", b"\n").replace(b"\r", b"\n").replace(b"\t", b" ").split(b"\n")
    if b"\\\n" not in content.replace(b"\r", b""):
        return lines
    for index in range(len(lines) - 2, -1, -1):
        if lines[index].endswith(b"\\"):
            lines[index] = lines[index][:-1] + b" " + lines[index + 1]
            lines[index + 1] = b""
    return lines


def _way_of_writing(path: Path, number: int, face: bytes) -> tuple[int, str]:
    """Tell the number of a face's corners, and which indices each has: v, v/vt, v//vn or v/vt/vn."""
    corners, slashes, doubles = len(face.split()), face.count(b"/"), face.count(b"//")
    kinds = {(0, 0): "v", (corners, 0): "v/vt", (2 * corners, corners): "v//vn", (2 * corners, 0): "v/vt/vn"}
    if corners < 3 or (slashes, doubles) not in kinds:
        raise FormatError(f"{path}: line {number} is no face ({_shown(face)}); export it again")
    return corners, kinds[slashes, doubles]


def _numbers(path: Path, name: str, lines: list[bytes], numbers: list[int]) -> F64:
    """Read a table's rows, (rows, 2 or 3); what more a row has (a weight, a colour) is left."""
    width = _WIDTHS[name]
    lengths = [len(line.split()) for line in lines]
    columns = min(lengths, default=width)
    if columns < width:
        at = lengths.index(columns)
        raise FormatError(f"{path}: line {numbers[at]} has no {width} numbers ({_shown(lines[at])}); export it again")
    if columns != max(lengths, default=width):
        lines, columns = [b" ".join(line.split()[:width]) for line in lines], width
    try:
        return _parsed(b" ".join(lines), np.float64).reshape(len(lines), columns)[:, :width].astype(np.float64)
    except ValueError:
        at = next(compress(range(len(lines)), (not _is_all(np.float64, line) for line in lines)), 0)
        raise FormatError(f"{path}: line {numbers[at]} holds no numbers ({_shown(lines[at])})") from None


def _piece(path: Path, rows: dict[str, F64], corners: int, kinds: str, alike: _Faces) -> Piece:
    names = [name for name in kinds.split("/") if name]
    try:
        words = _parsed(b" ".join(alike.lines).replace(b"/", b" "), np.int64)
        indices = words.reshape(len(alike.lines), corners, len(names))
    except ValueError:
        bad = (not _is_all(np.int64, line.replace(b"/", b" "), corners * len(names)) for line in alike.lines)
        at = next(compress(range(len(alike.lines)), bad), 0)
        raise FormatError(
            f"{path}: line {alike.numbers[at]} is no face ({_shown(alike.lines[at])}); export it again"
        ) from None
    found: dict[str, I64] = {}
    before = np.array(alike.counts, np.int64)
    for column, name in enumerate(names):
        index = indices[..., column]
        count = before[:, list(_WIDTHS).index(name), None]
        index = np.where(index < 0, index + count, index - 1)
        wrong = np.any((index < 0) | (index >= len(rows[name])) | (indices[..., column] == 0), axis=1)
        if np.any(wrong):
            at = int(np.argmax(wrong))
            raise FormatError(
                f"{path}: line {alike.numbers[at]} names a {name} that is not among the file's {len(rows[name])}; "
                "export it again"
            )
        found[name] = _fan(index)
    return Piece(
        rows["v"],
        found["v"],
        uvs=rows["vt"] if "vt" in found else None,
        uv_triangles=found.get("vt"),
        normals=rows["vn"] if "vn" in found else None,
        normal_triangles=found.get("vn"),
    )


def _fan(polygons: I64) -> I64:
    """Cut polygons (F, corners) into triangles round their first corner."""
    corners = polygons.shape[1]
    second = np.arange(1, corners - 1)
    first = np.broadcast_to(polygons[:, :1], (len(polygons), corners - 2))
    return np.stack([first, polygons[:, second], polygons[:, second + 1]], axis=2).reshape(-1, 3)


def _parsed(text: bytes, kind: type[np.float64] | type[np.int64]) -> NDArray[Any]:
    """Read numbers parted by spaces; raises ValueError for anything else."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)  # NumPy's word for what it could not read
        try:
            return np.fromstring(text, kind, sep=" ")
        except DeprecationWarning as warning:
            raise ValueError(str(warning)) from warning


def _is_all(kind: type[np.float64] | type[np.int64], line: bytes, count: int | None = None) -> bool:
    try:
        found = len(_parsed(line, kind))
    except ValueError:
        return False
    return found == (len(line.split()) if count is None else count)


def _shown(line: bytes) -> str:
    """Return the start of a line for a message."""
    text = line.strip()[:40].decode("ascii", errors="replace")
    return repr("".join(letter if letter.isprintable() else "?" for letter in text))
