"""`.matcap.exr` files: decomposed MatCaps as multi-part OpenEXR that any program can look into.

Parts `low.front`, `low.back`, `high.front`, `high.back`, each R, G, B in linear light, all of one square size; then
`low.remainder` and `high.remainder`, R, G, B, where the maps lack something; then `low.picture.0` and so on,
R, G, B, A, for pictures that hang in the light. Every part says `litrig.kind` and, as JSON, `litrig.matcap`.
"""

from pathlib import Path

import numpy as np
import OpenEXR
from numpy.typing import NDArray
from pydantic import ValidationError

from litrig.base.errors import FormatError, InputError
from processing.exr_parts import check_budget, check_part, listed, read_heads, read_parts, require, write_parts
from processing.matcap.half_floats import compact
from processing.matcap.meaning import Meaning
from processing.matcap.model import DecomposedMatcap

KIND = "matcap-decomposed"
KEY = "litrig.matcap"
ENDING = ".matcap.exr"
LARGEST_SIDE = 8192
_LARGEST_BYTES = 8 << 30
_FREE_BYTES = 256 << 20
"""More than maps of 2048² take: where light is even, or black, they pack to nearly nothing."""
_NAMES = ("low.front", "low.back", "high.front", "high.back")
_REMAINDERS = ("low.remainder", "high.remainder")
_MEND = "copy it, or take the MatCap apart again"
_PICTURE_SIDE = 16384


def write_matcap(path: Path, matcap: DecomposedMatcap) -> None:
    """Write a decomposed MatCap; the file is whole or not there.

    Raises
    ------
    InputError
        The name does not end in .matcap.exr, the maps are not square, of one size and of finite numbers, a parameter is
        out of range, or the file cannot be written.
    """
    if not path.name.lower().endswith(ENDING):
        raise InputError(f"{path}: cannot hold a decomposed MatCap; end the name in {ENDING}")
    maps = [matcap.low.front, matcap.low.back, matcap.high.front, matcap.high.back]
    size = maps[0].shape[0] if maps[0].ndim else 0
    if not size or any(texels.shape != (size, size, 3) for texels in maps):
        shapes = ", ".join(str(texels.shape) for texels in maps)
        raise InputError(f"{path}: maps {shapes} are no decomposed MatCap; give four of (S, S, 3)")
    remainders = _remainder_parts(matcap)
    for name, texels in remainders.items():
        if texels.ndim != 3 or texels.shape != (len(texels), len(texels), 3) or not texels.size:
            raise InputError(f"{path}: an array {texels.shape} is no {name}; give (P, P, 3)")
    pictures = _picture_parts(matcap)
    if not all(np.all(np.isfinite(texels)) for texels in (*maps, *remainders.values(), *pictures.values())):
        raise InputError(f"{path}: a map holds what is no number; mend it")
    try:
        meaning = Meaning.of(matcap)
    except ValidationError as error:
        raise InputError(f"{path}: {_first(error)}; give finite parameters, and slopes of 0 to 1") from error
    last = np.array([size - 1, size - 1], np.int32)
    header = {
        "type": OpenEXR.scanlineimage,
        "compression": OpenEXR.ZIP_COMPRESSION,
        "displayWindow": (np.zeros(2, np.int32), last),
        "litrig.kind": KIND,
        KEY: meaning.model_dump_json(),
    }
    named = [*zip(_NAMES, maps, strict=True), *remainders.items(), *pictures.items()]
    parts = [
        OpenEXR.Part({**header, "name": name}, {"RGBA"[: texels.shape[2]]: compact(texels)}) for name, texels in named
    ]
    write_parts(path, parts)


def read_matcap(path: Path) -> DecomposedMatcap:
    """Read a decomposed MatCap. What was stored as float32 comes back bit by bit.

    Raises
    ------
    InputError
        The file cannot be read.
    FormatError
        It is no decomposed MatCap, contradicts itself, or is damaged.
    """
    heads = read_heads(path, KEY)
    kinds = sorted({head.kind or "none" for head in heads})
    require(path, kinds == [KIND], f"is of kind {listed(kinds)}, not {KIND}; give a decomposed MatCap")
    names = [head.name for head in heads]
    require(
        path,
        names[: len(_NAMES)] == list(_NAMES),
        f"has parts {listed(names)}, not {listed(list(_NAMES))} first; {_MEND}",
    )
    size, rows = heads[0].data
    require(
        path,
        0 < size == rows <= LARGEST_SIDE,
        f"claims maps of {size} × {rows}; they are square, 1 to {LARGEST_SIDE} on a side; {_MEND}",
    )
    try:
        meaning = Meaning.model_validate_json(heads[0].meaning)
    except ValidationError as error:
        raise FormatError(f"{path}: {KEY} {_first(error)}; {_MEND}") from error
    counts = {"low": len(meaning.low.pictures), "high": len(meaning.high.pictures)}
    hung = [_picture_name(which, number) for which, count in counts.items() for number in range(count)]
    remainders = [name for name in _REMAINDERS if name in names]
    wanted = [*_NAMES, *remainders, *hung]
    require(path, names == wanted, f"has parts {listed(names)}, not {listed(wanted)}; {_MEND}")
    shapes: dict[str, tuple[int, ...]] = dict.fromkeys(_NAMES, (size, size, 3))
    for head in heads[: len(_NAMES)]:
        check_part(path, head, ["B", "G", "R"], (size, size), (size, size), _MEND)
    for head in heads[len(_NAMES) :]:
        width, height = head.data
        require(path, 0 < width <= _PICTURE_SIDE and 0 < height <= _PICTURE_SIDE, f"part {head.name} is none; {_MEND}")
        channels = ["A", "B", "G", "R"]
        if head.name in remainders:
            require(path, width == height, f"part {head.name} is {width} × {height}, and not square; {_MEND}")
            channels = ["B", "G", "R"]
        check_part(path, head, channels, (width, height), (size, size), _MEND)
        shapes[head.name] = (height, width, len(channels))
    check_budget(path, sum(4 * int(np.prod(shape)) for shape in shapes.values()), _LARGEST_BYTES, free=_FREE_BYTES)
    parts = read_parts(path, shapes, _MEND)
    low, high = (
        told.component(
            parts[f"{which}.front"]["RGB"],
            parts[f"{which}.back"]["RGB"],
            [parts[_picture_name(which, number)]["RGBA"] for number in range(len(told.pictures))],
            parts[name]["RGB"] if (name := f"{which}.remainder") in parts else None,
        )
        for which, told in (("low", meaning.low), ("high", meaning.high))
    )
    return DecomposedMatcap(low, high, meaning.table_normal, meaning.source, meaning.picture_size)


def _remainder_parts(matcap: DecomposedMatcap) -> dict[str, NDArray[np.float32]]:
    both = zip(_REMAINDERS, (matcap.low.remainder, matcap.high.remainder), strict=True)
    return {name: texels for name, texels in both if texels is not None}


def _picture_parts(matcap: DecomposedMatcap) -> dict[str, NDArray[np.float32]]:
    return {
        _picture_name(which, number): hung.texels
        for which, component in (("low", matcap.low), ("high", matcap.high))
        for number, hung in enumerate(component.pictures)
    }


def _picture_name(which: str, number: int) -> str:
    return f"{which}.picture.{number}"


def _first(error: ValidationError) -> str:
    first = error.errors()[0]
    return f"{'.'.join(str(part) for part in first['loc'])}: {first['msg']}"
