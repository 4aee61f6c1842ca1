"""What a low-rank AMC file says of itself, checked before anything is allocated for its pixels."""

from dataclasses import dataclass
from pathlib import Path

from processing.amc.files.ktx2_check import LARGEST_BYTES, LARGEST_SIDE
from processing.amc.files.meaning import Meaning, read_meaning
from processing.exr_parts import Size, check_budget, check_part, listed, read_heads, require

KIND = "amc-low-rank"
KEY = "litrig.amc"
MEND = "copy it, or compress the AMC again"


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
    heads = read_heads(path, KEY)
    kinds = sorted({head.kind or "none" for head in heads})
    require(path, kinds == [KIND], f"is of kind {listed(kinds)}, not {KIND}; give a low-rank AMC")
    names = [head.name for head in heads]
    rank = len(heads) - 2
    require(path, rank >= 1 and names == part_names(rank), f"has parts {listed(names)}; {MEND}")
    size, depth = _sizes(path, heads[0].data, heads[rank].data, rank)
    for head in heads:
        channels = ["B", "G", "R"] if head.name.startswith("picture.") else ["Y"]
        check_part(path, head, channels, (rank, depth) if head.name == "curves" else (size, size), (size, size), MEND)
    check_budget(path, 4 * (rank * (3 * size * size + depth) + size * size), LARGEST_BYTES)
    return Layout(size, depth, rank, read_meaning(heads[0].meaning, depth, f"{path}: {KEY}"))


def _sizes(path: Path, picture: Size, curves: Size, rank: int) -> Size:
    """Return S and D."""
    (size, rows), (columns, depth) = picture, curves
    require(
        path,
        0 < size == rows <= LARGEST_SIDE and 0 < depth <= LARGEST_SIDE and columns == rank <= depth,
        f"claims {rank} pictures of {size} × {rows} with {columns} curves over {depth} slices; an AMC has square "
        f"slices, 1 to {LARGEST_SIDE} on a side, and as many curves as pictures, not more than slices; {MEND}",
    )
    return size, depth
