"""Low-rank AMC files: `X.amc.exr`, a multi-part OpenEXR that any program can look into.

Parts `picture.0` to `picture.N` hold a basis picture each (R, G, B; signed linear light, row 0 at n_y = +1), part
`curves` a row for each slice and a column for each picture (Y), part `valid` 1 where every slice has seen something and
0 elsewhere (Y). All parts share the pictures' display window, and each says `litrig.kind` and, as JSON, `litrig.amc`.
"""

from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
from numpy.typing import NDArray

from litrig.base.errors import FormatError, InputError
from litrig.base.version import litrig_version
from processing.amc.files.low_rank_check import KEY, KIND, MEND, part_names, read_layout
from processing.amc.low_rank import LowRankAmc
from processing.exr_parts import read_parts, write_parts

F32 = NDArray[np.float32]


def write_low_rank(path: Path, low: LowRankAmc) -> None:
    """Write a low-rank AMC; the file is whole or not there.

    Raises
    ------
    InputError
        The name does not end in .exr, the arrays do not make a low-rank AMC or hold what is no number, or the file
        cannot be written.
    """
    _check(path, low)
    stored: list[tuple[str, NDArray[np.floating]]] = [("RGB", picture.astype(np.float32)) for picture in low.pictures]
    stored += [("Y", low.curves.astype(np.float32)), ("Y", low.valid.astype(np.float32))]
    parts = [
        OpenEXR.Part({**_header(low), "name": name}, {channel: np.ascontiguousarray(values)})
        for name, (channel, values) in zip(part_names(len(low.pictures)), stored, strict=True)
    ]
    write_parts(path, parts)


def read_low_rank(path: Path) -> LowRankAmc:
    """Read a low-rank AMC. What was stored as float32 comes back bit by bit.

    Raises
    ------
    InputError
        The file cannot be read.
    FormatError
        It is no low-rank AMC, contradicts itself, or is damaged.
    """
    layout = read_layout(path)
    parts = read_parts(path, layout.shapes(), MEND)
    valid = parts["valid"]["Y"]
    if not np.all((valid == 0) | (valid == 1)):
        raise FormatError(f"{path}: part valid holds other values than 0 and 1; compress the AMC again")
    pictures = np.stack([parts[name]["RGB"] for name in part_names(layout.rank)[: layout.rank]])
    return LowRankAmc(pictures, parts["curves"]["Y"], valid == 1, layout.meaning)


def _header(low: LowRankAmc) -> dict[str, Any]:
    last = np.array([low.valid.shape[1] - 1, low.valid.shape[0] - 1], np.int32)
    return {
        "type": OpenEXR.scanlineimage,
        "compression": OpenEXR.ZIP_COMPRESSION,
        "displayWindow": (np.zeros(2, np.int32), last),
        "litrig.kind": KIND,
        KEY: low.meaning.model_copy(update={"litrig": litrig_version()}).model_dump_json(),
    }


def _check(path: Path, low: LowRankAmc) -> None:
    if path.suffix.lower() != ".exr":
        raise InputError(f"{path}: cannot hold a low-rank AMC; end the name in .amc.exr")
    pictures, curves, valid = low.pictures.shape, low.curves.shape, low.valid.shape
    size = valid[0] if valid else 0
    if 0 in pictures or pictures != (*pictures[:1], size, size, 3) or curves != (*curves[:1], *pictures[:1]):
        raise InputError(
            f"{path}: pictures {pictures} with curves {curves} and validity {valid} are no low-rank AMC; "
            "give (rank, S, S, 3), (D, rank) and (S, S)"
        )
    if not (np.all(np.isfinite(low.pictures)) and np.all(np.isfinite(low.curves))):
        raise InputError(f"{path}: pictures or curves hold what is no number; mend them")
