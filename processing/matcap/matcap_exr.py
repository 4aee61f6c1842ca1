"""`.matcap.exr` files: decomposed MatCaps as multi-part OpenEXR that any program can look into.

Parts `low.front`, `low.back`, `high.front`, `high.back`, each R, G, B in linear light, all of one square size; every
part says `litrig.kind` and, as JSON, `litrig.matcap`.
"""

from pathlib import Path
from typing import Annotated

import numpy as np
import OpenEXR
from pydantic import BaseModel, Field, ValidationError

from litrig.base.errors import FormatError, InputError
from litrig.base.table_normals import TableNormal
from litrig.base.version import litrig_version
from processing.exr_parts import check_budget, check_part, listed, read_heads, read_parts, require, write_parts
from processing.matcap.model import Component, DecomposedMatcap

KIND = "matcap-decomposed"
KEY = "litrig.matcap"
ENDING = ".matcap.exr"
LARGEST_SIDE = 8192
_LARGEST_BYTES = 8 << 30
_NAMES = ("low.front", "low.back", "high.front", "high.back")
_MEND = "copy it, or take the MatCap apart again"
_Channel = Annotated[float, Field(ge=0, allow_inf_nan=False)]


class _ComponentMeaning(BaseModel, frozen=True, extra="forbid"):
    base_colour: tuple[_Channel, _Channel, _Channel]
    slope: Annotated[float, Field(ge=0, le=1)]
    filter_size: _Channel


class _Meaning(BaseModel, frozen=True, extra="forbid"):
    """The JSON itself."""

    low: _ComponentMeaning
    high: _ComponentMeaning
    table_normal: TableNormal
    source: str = ""
    litrig: str


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
    if not all(np.all(np.isfinite(texels)) for texels in maps):
        raise InputError(f"{path}: a map holds what is no number; mend it")
    try:
        meaning = _Meaning.model_validate(
            {
                "low": _parameters(matcap.low),
                "high": _parameters(matcap.high),
                "table_normal": matcap.table_normal,
                "source": matcap.source,
                "litrig": litrig_version(),
            }
        )
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
    parts = [
        OpenEXR.Part({**header, "name": name}, {"RGB": np.ascontiguousarray(texels, np.float32)})
        for name, texels in zip(_NAMES, maps, strict=True)
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
    require(path, names == list(_NAMES), f"has parts {listed(names)}, not {listed(list(_NAMES))}; {_MEND}")
    size, rows = heads[0].data
    require(
        path,
        0 < size == rows <= LARGEST_SIDE,
        f"claims maps of {size} × {rows}; they are square, 1 to {LARGEST_SIDE} on a side; {_MEND}",
    )
    for head in heads:
        check_part(path, head, ["B", "G", "R"], (size, size), (size, size), _MEND)
    check_budget(path, 4 * 3 * 4 * size * size, _LARGEST_BYTES)
    try:
        meaning = _Meaning.model_validate_json(heads[0].meaning)
    except ValidationError as error:
        raise FormatError(f"{path}: {KEY} {_first(error)}; {_MEND}") from error
    parts = read_parts(path, dict.fromkeys(_NAMES, (size, size, 3)), _MEND)
    low, high = (
        Component(
            front=parts[f"{name}.front"]["RGB"],
            back=parts[f"{name}.back"]["RGB"],
            base_colour=told.base_colour,
            slope=told.slope,
            filter_size=told.filter_size,
        )
        for name, told in (("low", meaning.low), ("high", meaning.high))
    )
    return DecomposedMatcap(low, high, meaning.table_normal, meaning.source)


def _parameters(component: Component) -> dict[str, object]:
    return {
        "base_colour": component.base_colour,
        "slope": component.slope,
        "filter_size": component.filter_size,
    }


def _first(error: ValidationError) -> str:
    first = error.errors()[0]
    return f"{'.'.join(str(part) for part in first['loc'])}: {first['msg']}"
