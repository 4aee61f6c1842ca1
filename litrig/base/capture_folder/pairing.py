"""Which picture a list means: names as other programs write them, against the files that are there."""

import re
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from litrig.base.errors import InputError
from litrig.base.lp import spellings

_SHOWN = 3
_Key = Callable[[str], str]
_KEYS: tuple[_Key, ...] = (str, str.casefold, lambda name: name.casefold().rsplit(".", 1)[0])


def find_pictures(names: Sequence[str], pictures: Iterable[str], source: Path, folder: Path) -> list[str]:
    """Find the picture that each name means: by its name, else without regard to case, else by its name without ending.

    So a list of `IMG_1.TIF` fits a folder of `img_1.jpg`, as happens when pictures are developed after the lights were
    measured.

    Raises
    ------
    InputError
        A name fits no picture, several, or one that another name fits too.
    """
    there = list(pictures)
    indexes = [(key, _index(there, key)) for key in _KEYS]
    found = [_candidates(name, indexes) for name in names]
    missing = [name for name, candidates in zip(names, found, strict=True) if not candidates]
    if missing:
        left = sorted(set(there) - {picture for candidates in found for picture in candidates})
        others = f", which holds {listed(left)} instead" if left else ""
        raise InputError(
            f"{source}: names {listed(missing)}, not found in {folder}{others}; copy the pictures or mend the names"
        )
    meant_by: dict[str, str] = {}
    for name, candidates in zip(names, found, strict=True):
        if len(candidates) > 1:
            raise InputError(
                f"{source}: {listed([name])} fits {listed(candidates)}; keep one of them, or name it exactly"
            )
        if candidates[0] in meant_by:
            both = listed([meant_by[candidates[0]], name])
            raise InputError(f"{source}: {both} both mean {listed(candidates)}; keep one line a picture")
        meant_by[candidates[0]] = name
    return list(meant_by)


def in_order(pictures: Iterable[str]) -> list[str]:
    """Sort names as people count: 2 before 10."""

    def counted(name: str) -> list[tuple[int, str]]:
        return [
            (int(digits), other) if digits else (-1, other) for digits, other in re.findall(r"([0-9]+)|([^0-9]+)", name)
        ]

    return sorted(pictures, key=counted)


def listed(names: Sequence[str]) -> str:
    """Name a few, and say how many more there are; a byte that is of no letter is shown by its number."""
    shown = ", ".join(names[:_SHOWN]) + (f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else "")
    return shown.encode("utf-8", "backslashreplace").decode()


def _index(pictures: list[str], key: _Key) -> dict[str, list[str]]:
    index = defaultdict(list)
    for picture in pictures:
        index[key(picture)].append(picture)
    return index


def _candidates(name: str, indexes: list[tuple[_Key, dict[str, list[str]]]]) -> list[str]:
    for key, index in indexes:
        for spelling in spellings(name):
            if key(spelling) in index:
                return index[key(spelling)]
    return []
