"""`.lp` files: one light direction a picture, as RTI tools exchange them.

The first line is a count, then `name x y z` a line, from sample to light in the view frame. The numbers are the last
three words, so that a name may hold blanks. Met in the field and read: no count, no names, Windows paths, CRLF, tabs,
semicolons or commas between the words, decimal commas, names in the code page of the writer's country, and vectors that
are not of length 1.
"""

import codecs
import math
import re
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path, PureWindowsPath

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import FormatError, InputError
from litrig.base.files import read_limited, write_atomically
from litrig.base.lights import MOST_LIGHTS, Lights

F64 = NDArray[np.float64]

LARGEST_LP_BYTES = 4_000_000
_SHORTEST = 1e-4
_ABOUT_ONE = 0.02
_OLD_WINDOWS = "cp1252"
_CODE_PAGES = ("utf-8", "cp949", "cp932", "gb18030", "cp1250", "cp1251")


def read_lp(path: Path) -> Lights:
    """Read an `.lp` file.

    Raises
    ------
    InputError, FormatError
        The file is missing, a line has no three numbers, a direction has no length, a name stands twice, only some
        lines have a name, or the count differs from the lines that follow.
    """
    text = _decode(read_limited(path, LARGEST_LP_BYTES))
    lines = [(number, line.strip()) for number, line in enumerate(text.splitlines(), 1) if line.strip()]
    if not lines:
        raise FormatError(f"{path}: empty; it should name a light direction for each picture")
    promised = int(lines.pop(0)[1]) if re.fullmatch(r"[0-9]{1,6}", lines[0][1]) else None
    if len(lines) > MOST_LIGHTS:
        raise FormatError(f"{path}: {len(lines)} lights are more than {MOST_LIGHTS}; not an .lp file?")
    if promised is not None and promised != len(lines):
        raise FormatError(f"{path}: promises {promised} lights and has {len(lines)}; mend the first line or the list")
    if not lines:
        raise FormatError(f"{path}: names no light; write a line `name x y z` for each picture")
    entries = [_parse_line(path, number, line) for number, line in lines]
    vectors = np.array([vector for _, vector in entries])
    lengths = np.linalg.norm(vectors, axis=1)
    return Lights(
        _names(path, [name for name, _ in entries]),
        vectors / lengths[:, None],
        vectors if np.any(np.abs(lengths - 1) > _ABOUT_ONE) else None,
    )


def write_lp(path: Path, lights: Lights) -> None:
    """Write an `.lp` file.

    Raises
    ------
    InputError
        The lights have no names, or it cannot be written.
    """
    write_atomically(path, lp_text(path, lights))


def lp_text(path: Path, lights: Lights) -> bytes:
    """Return what an `.lp` file says that every RTI tool reads: count, then `name x y z`.

    Raises
    ------
    InputError
        The lights have no names, without which other tools refuse the file, which `path` names.
    """
    if lights.names is None:
        raise InputError(f"{path}: an .lp file names a picture for each light, and these have no names; give them some")
    lines = [str(len(lights.names))]
    for name, (x, y, z) in zip(lights.names, lights.directions, strict=True):
        lines.append(f"{name} {x:.6f} {y:.6f} {z:.6f}")
    return ("\n".join(lines) + "\n").encode("utf-8", "surrogateescape")


def spellings(name: str) -> Iterator[str]:
    """Yield a name as it was read, and as it would have been in the code pages of other countries."""
    yield name
    with suppress(UnicodeEncodeError):
        stored = name.encode(_OLD_WINDOWS, "surrogateescape")
        for code_page in _CODE_PAGES:
            with suppress(UnicodeDecodeError):
                yield stored.decode(code_page)


def _decode(content: bytes) -> str:
    """Read text so that the bytes of a name can be had again, should the code page prove wrong."""
    with suppress(UnicodeDecodeError):
        wide = content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
        return content.decode("utf-16" if wide else "utf-8-sig")
    return content.decode(_OLD_WINDOWS, "surrogateescape")


def _parse_line(path: Path, number: int, line: str) -> tuple[str, F64]:
    for words in _split(line):
        with suppress(ValueError):
            vector = np.array([float(word.replace(",", ".")) for word in words[-3:]])
            name = PureWindowsPath(words[0].strip("\"'")).name if len(words) == 4 else ""
            _check_length(path, number, name or "this light", vector)
            return name, vector
    raise FormatError(f"{path}, line {number}: expected `name x y z`, found {line[:60]!r}; mend that line")


def _split(line: str) -> Iterator[list[str]]:
    """Yield the ways to cut a line into a name, if there is one, and three numbers."""
    bare = line.rstrip(" \t;,")
    for words in (bare.rsplit(";", 3), [word.rstrip(",") for word in bare.rsplit(maxsplit=3)], bare.rsplit(",", 3)):
        if len(words) in (3, 4):
            yield [word.strip() for word in words]


def _check_length(path: Path, number: int, name: str, vector: F64) -> None:
    length = float(np.linalg.norm(vector))
    if not (math.isfinite(length) and length > _SHORTEST):
        raise FormatError(f"{path}, line {number}: the direction of {name} has no length; measure that light again")


def _names(path: Path, names: list[str]) -> tuple[str, ...] | None:
    unnamed = names.count("")
    if unnamed == len(names):
        return None
    if unnamed:
        raise FormatError(f"{path}: {unnamed} of {len(names)} lines have no picture's name; give all a name, or none")
    name, times = Counter(names).most_common(1)[0]
    if times > 1:
        raise FormatError(f"{path}: names {name} twice; keep one line a picture")
    return tuple(names)
