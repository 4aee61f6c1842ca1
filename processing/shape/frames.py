"""Frames of a sequence: file names in which # stands for digits of a number."""

import re
from pathlib import Path

from litrig.base.errors import InputError


def is_pattern(path: Path) -> bool:
    """Tell whether a name has a place for the number of a frame."""
    return "#" in path.name


def frame_numbers(pattern: Path) -> list[int]:
    """Return the numbers of the frames that are there, in their order.

    Raises
    ------
    InputError
        The pattern has two places for numbers, or there is no frame.
    """
    hashes = _hashes(pattern)
    before, after = (re.escape(part) for part in pattern.name.split(hashes))
    digits = re.compile(rf"{before}(\d{{{len(hashes)},}}){after}")
    if not pattern.parent.is_dir():
        raise InputError(f"{pattern}: the folder {pattern.parent} does not exist; check the path")
    found = (digits.fullmatch(path.name) for path in pattern.parent.iterdir())
    numbers = {int(match[1]) for match in found if match and match[1] == f"{int(match[1]):0{len(hashes)}d}"}
    if not numbers:
        raise InputError(f"{pattern}: there is no such frame; # stands for a digit of its number")
    return sorted(numbers)


def frame(pattern: Path, number: int) -> Path:
    """Return the name of one frame; a name without # is the same for all."""
    if not is_pattern(pattern):
        return pattern
    hashes = _hashes(pattern)
    return pattern.with_name(pattern.name.replace(hashes, f"{number:0{len(hashes)}d}"))


def _hashes(pattern: Path) -> str:
    runs: list[str] = re.findall("#+", pattern.name)
    if len(runs) != 1:
        raise InputError(f"{pattern}: has {len(runs)} places for the number of a frame; give one, as in shot.####.exr")
    return runs[0]
