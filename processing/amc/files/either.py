"""AMC files of either kind: whole tables in `X.amc.ktx2`, low-rank ones in `X.amc.exr`."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from processing.amc.files.ktx2 import AmcHeader, read_amc, read_header, write_amc
from processing.amc.files.low_rank_check import read_layout
from processing.amc.files.low_rank_exr import read_low_rank, write_low_rank
from processing.amc.files.meaning import Meaning
from processing.amc.low_rank import compress
from processing.amc.model import Amc

TABLE, LOW_RANK = ".amc.ktx2", ".amc.exr"
ENDINGS = (TABLE, LOW_RANK)
DEFAULT_RANK = 12


def read_any(path: Path) -> Amc:
    """Read a table, multiplied out if it is stored as a low-rank one.

    Raises
    ------
    InputError, FormatError
        The file is missing, damaged, or holds no AMC.
    """
    if not path.name.lower().endswith(LOW_RANK):
        return read_amc(path)
    table = read_low_rank(path).expand()
    # Sums of few pictures undershoot beside a sharp highlight; light does not.
    return replace(table, slices=np.maximum(table.slices, 0))


def write_any(path: Path, amc: Amc, *, rank: int | None = None) -> None:
    """Write a table in the form that the file's ending names.

    Parameters
    ----------
    rank : most pictures of a low-rank file; by default twelve, or half as many as there are slices
    """
    if path.name.lower().endswith(LOW_RANK):
        most = rank or min(DEFAULT_RANK, max(1, len(amc.slices) // 2))
        write_low_rank(path, compress(amc, min(most, len(amc.slices))))
    else:
        write_amc(path, amc)


def beside(path: Path, name: str) -> Path:
    """Name a companion: X.amc.ktx2 has X.low.amc.ktx2 beside it. Without a name it is the file itself."""
    ending = LOW_RANK if path.name.lower().endswith(LOW_RANK) else TABLE
    return path.with_name(f"{path.name[: -len(ending)]}.{name}{path.name[-len(ending) :]}") if name else path


def describe_file(path: Path) -> dict[str, Any]:
    """Say what a file holds, from its header alone."""
    if path.name.lower().endswith(LOW_RANK):
        layout = read_layout(path)
        shape: dict[str, Any] = {"size": layout.size, "depth": layout.depth, "rank": layout.rank}
        return {**shape, **_describe(layout.meaning), "written_by": f"litrig {layout.meaning.litrig}"}
    header = read_header(path)
    return {
        "size": header.size,
        "depth": header.depth,
        **_describe(header),
        "mip_levels": header.levels,
        "texels": "half float, linear" if header.half_float else "8 bits, sRGB",
        "compressed": header.compressed,
        "written_by": f"litrig {header.written_by}",
    }


def _describe(meaning: Meaning | AmcHeader) -> dict[str, Any]:
    return {
        "invariance": meaning.invariance,
        "table_normal": str(meaning.table_normal),
        "tangent_angle": str(meaning.tangent_angle),
        "captured_slices": len(meaning.slice_angles_deg),
        "source": meaning.source,
    }
