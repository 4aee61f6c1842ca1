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
from litrig.base.files import replacing
from litrig.base.quiet import quiet_library
from litrig.base.version import litrig_version
from processing.amc.files.low_rank_check import KEY, KIND, MEND, Layout, part_names, read_layout
from processing.amc.low_rank import LowRankAmc

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
    with replacing(path) as temporary:
        try:
            OpenEXR.File(parts).write(str(temporary))
        except RuntimeError as error:  # OpenEXR's word for a disk or folder that refuses
            raise InputError(f"{path}: cannot be written as EXR; free space, or choose another folder") from error


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
    parts = _read_parts(path, layout)
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


def _read_parts(path: Path, layout: Layout) -> dict[str, dict[str, F32]]:
    """Read all pixels as float32 and see that they are what the head promised."""
    try:
        # OpenEXR says on standard output what it could not decode; it is said below, in one line.
        with quiet_library(), OpenEXR.File(str(path)) as exr:
            found = {
                part.name(): {name: np.asarray(channel.pixels) for name, channel in part.channels.items()}
                for part in exr.parts
            }
    except (RuntimeError, ValueError, OSError, IndexError) as error:
        raise FormatError(f"{path}: damaged EXR ({error}); {MEND}") from error
    # What OpenEXR cannot decode it leaves out: the part's pixels, or the part.
    missing = [name for name in layout.shapes() if not found.get(name)]
    if missing:
        raise FormatError(f"{path}: damaged EXR (part {missing[0]} cannot be decoded); {MEND}")
    return {name: _floats(path, name, found[name], shape) for name, shape in layout.shapes().items()}


def _floats(path: Path, part: str, channels: dict[str, NDArray[Any]], shape: tuple[int, ...]) -> dict[str, F32]:
    floats = {}
    for channel, values in channels.items():
        if values.dtype not in (np.float16, np.float32) or values.shape != shape:
            raise FormatError(
                f"{path}: part {part} holds {values.dtype} {values.shape}, not floats {shape}; compress the AMC again"
            )
        if not np.all(np.isfinite(values)):
            raise FormatError(f"{path}: part {part} holds values that are no numbers; compress the AMC again")
        floats[channel] = np.ascontiguousarray(values, np.float32)
    return floats
