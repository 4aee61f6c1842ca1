"""`.lp` files: one light direction a picture, as RTI tools exchange them.

The first line is a count, then `name x y z` a line, from sample to light in the view frame. The numbers are the last
three tokens, so that a name may hold blanks; Windows paths, CRLF, decimal commas and a missing count are met in the
field.
"""

import math
import re
from dataclasses import dataclass
from pathlib import Path, PureWindowsPath

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import FormatError
from litrig.base.files import decode_text, read_limited, write_atomically

MOST_LIGHTS = 10_000
LARGEST_LP_BYTES = 4_000_000
_SHORTEST = 1e-4


@dataclass(frozen=True)
class LightDirections:
    """Picture names, and the direction of the light in each.

    Attributes
    ----------
    names : file names without folders, in the file's order
    directions : (N, 3) float64, unit, view frame, sample to light
    """

    names: tuple[str, ...]
    directions: NDArray[np.float64]


def read_lp(path: Path) -> LightDirections:
    """Read an `.lp` file.

    Raises
    ------
    InputError, FormatError
        The file is missing, a line has no three numbers, a direction has no length, a name stands twice, or the count
        differs from the lines that follow.
    """
    text = decode_text(read_limited(path, LARGEST_LP_BYTES))
    lines = [(number, line.strip()) for number, line in enumerate(text.splitlines(), 1) if line.strip()]
    if not lines:
        raise FormatError(f"{path}: empty; it should name a light direction for each picture")
    promised = int(lines.pop(0)[1]) if re.fullmatch(r"\d{1,6}", lines[0][1]) else None
    if len(lines) > MOST_LIGHTS:
        raise FormatError(f"{path}: {len(lines)} lights are more than {MOST_LIGHTS}; not an .lp file?")
    if promised is not None and promised != len(lines):
        raise FormatError(f"{path}: promises {promised} lights and has {len(lines)}; mend the first line or the list")
    entries = [_parse_line(path, number, line) for number, line in lines]
    names = tuple(name for name, _ in entries)
    for name in names:
        if names.count(name) > 1:
            raise FormatError(f"{path}: names {name} twice; keep one line a picture")
    if not names:
        raise FormatError(f"{path}: names no light")
    return LightDirections(names, np.array([direction for _, direction in entries]))


def write_lp(path: Path, lights: LightDirections) -> None:
    """Write an `.lp` file that every RTI tool reads: count, then `name x y z`."""
    lines = [str(len(lights.names))]
    for name, (x, y, z) in zip(lights.names, lights.directions, strict=True):
        lines.append(f"{name} {x:.6f} {y:.6f} {z:.6f}")
    write_atomically(path, ("\n".join(lines) + "\n").encode())


def _parse_line(path: Path, number: int, line: str) -> tuple[str, NDArray[np.float64]]:
    tokens = line.rsplit(maxsplit=3)
    try:
        if len(tokens) != 4:
            raise ValueError("too few words")  # noqa: TRY301  # one message for every way a line can be wrong
        vector = np.array([float(token.replace(",", ".")) for token in tokens[1:]])
    except ValueError as error:
        raise FormatError(f"{path}, line {number}: expected `name x y z`, found {line[:60]!r}") from error
    length = float(np.linalg.norm(vector))
    if not (math.isfinite(length) and length > _SHORTEST):
        raise FormatError(
            f"{path}, line {number}: the direction of {tokens[0]} has no length; measure that light again"
        )
    return PureWindowsPath(tokens[0]).name, vector / length
