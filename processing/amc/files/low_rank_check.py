"""What a low-rank AMC file says of itself, checked before anything is allocated for its pixels."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import OpenEXR

from litrig.base.errors import FormatError, InputError
from processing.amc.files.ktx2_check import FREE_BYTES, LARGEST_BYTES, LARGEST_RATIO, LARGEST_SIDE
from processing.amc.files.meaning import Meaning, read_meaning

KIND = "amc-low-rank"
KEY = "litrig.amc"
MEND = "copy it, or compress the AMC again"
Size = tuple[int, int]


@dataclass(frozen=True)
class Layout:
    """How large the parts are, and what they mean."""

    size: int
    depth: int
    rank: int
    meaning: Meaning

    def shapes(self) -> dict[str, tuple[int, ...]]:
        """Return the shape of every part's pixels."""
        pictures = dict.fromkeys(part_names(self.rank)[: self.rank], (self.size, self.size, 3))
        return {**pictures, "curves": (self.depth, self.rank), "valid": (self.size, self.size)}


def part_names(rank: int) -> list[str]:
    """Name the parts in their order: the pictures first, so that a viewer shows the mean."""
    return [*(f"picture.{number}" for number in range(rank)), "curves", "valid"]


def read_layout(path: Path) -> Layout:
    """Read and check the heads of all parts.

    Raises
    ------
    InputError
        The file cannot be read.
    FormatError
        It is no low-rank AMC, or contradicts itself or its own length.
    """
    heads = _read_heads(path)
    kinds = sorted({head.kind or "none" for head in heads})
    _require(path, kinds == [KIND], f"is of kind {_listed(kinds)}, not {KIND}; give a low-rank AMC")
    names = [head.name for head in heads]
    rank = len(heads) - 2
    _require(path, rank >= 1 and names == part_names(rank), f"has parts {_listed(names)}; {MEND}")
    size, depth = _sizes(path, heads[0].data, heads[rank].data, rank)
    for head in heads:
        _check_part(path, head, (rank, depth) if head.name == "curves" else (size, size), size)
    _budget(path, 4 * (rank * (3 * size * size + depth) + size * size))
    return Layout(size, depth, rank, read_meaning(heads[0].meaning, depth, f"{path}: {KEY}"))


@dataclass(frozen=True)
class _Head:
    """What one part says of itself. A window is width and height from the origin; any other is of no size."""

    name: str
    kind: str
    meaning: str
    is_plain: bool
    channels: list[str]
    data: Size
    display: Size

    @classmethod
    def of(cls, header: Mapping[str, Any]) -> Self:
        channels = header["channels"]
        return cls(
            name=_text(header, "name"),
            kind=_text(header, "litrig.kind"),
            meaning=_text(header, KEY),
            is_plain=header["type"] == OpenEXR.scanlineimage
            and all(channel.xSampling == channel.ySampling == 1 for channel in channels),
            channels=sorted(channel.name for channel in channels),
            data=_window(header["dataWindow"]),
            display=_window(header["displayWindow"]),
        )


def _text(header: Mapping[str, Any], name: str) -> str:
    """Return a text attribute; what is no UTF-8, and so comes as bytes, is no text that litrig has written."""
    value = header.get(name)
    return value if isinstance(value, str) else ""


def _window(corners: Any) -> Size:
    (left, top), (right, bottom) = corners
    return (int(right) + 1, int(bottom) + 1) if int(left) == int(top) == 0 else (0, 0)


def _read_heads(path: Path) -> list[_Head]:
    try:
        with path.open("rb"):
            pass
        with OpenEXR.File(str(path), header_only=True) as exr:
            return [_Head.of(part.header) for part in exr.parts]
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file; check the path") from error
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path") from error
    except (RuntimeError, ValueError, LookupError, TypeError) as error:
        raise FormatError(f"{path}: no EXR, or a damaged one ({error}); give one that litrig wrote") from error


def _sizes(path: Path, picture: Size, curves: Size, rank: int) -> Size:
    """Return S and D."""
    (size, rows), (columns, depth) = picture, curves
    _require(
        path,
        0 < size == rows <= LARGEST_SIDE and 0 < depth <= LARGEST_SIDE and columns == rank <= depth,
        f"claims {rank} pictures of {size} × {rows} with {columns} curves over {depth} slices; an AMC has square "
        f"slices, 1 to {LARGEST_SIDE} on a side, and as many curves as pictures, not more than slices; {MEND}",
    )
    return size, depth


def _check_part(path: Path, head: _Head, data: Size, size: int) -> None:
    wanted = ["B", "G", "R"] if head.name.startswith("picture.") else ["Y"]
    _require(path, head.is_plain, f"part {head.name} is no plain picture; {MEND}")
    _require(path, head.channels == wanted, f"part {head.name} has channels {_listed(head.channels)}; {MEND}")
    _require(
        path,
        head.data == data and head.display == (size, size),
        f"part {head.name} is not {data[0]} × {data[1]} in a display window of {size} × {size}; {MEND}",
    )


def _budget(path: Path, unpacked: int) -> None:
    packed = path.stat().st_size
    _require(path, unpacked <= LARGEST_BYTES, f"unpacks to {unpacked:,} bytes, more than {LARGEST_BYTES:,}; refused")
    _require(
        path,
        unpacked <= max(FREE_BYTES, packed * LARGEST_RATIO),
        f"unpacks from {packed:,} to {unpacked:,} bytes, more than {LARGEST_RATIO} to 1; refused",
    )


def _listed(words: list[str]) -> str:
    return ", ".join(words[:8]) + (f" and {len(words) - 8} more" if len(words) > 8 else "")


def _require(path: Path, holds: bool, otherwise: str) -> None:
    if not holds:
        raise FormatError(f"{path}: {otherwise}")
