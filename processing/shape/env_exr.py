"""`.env.exr` files: reconstructed environments as multi-part OpenEXR that any program can look into.

Parts `surface.N.front` and `surface.N.back` for each surface N (R, G, B; linear light), all of one square size; every
part says `litrig.kind` and, as JSON, `litrig.env`, which has the coefficients of the diffuse shading, and names the
surfaces whose diffuse or reflected light is that before their albedo.
"""

from pathlib import Path
from typing import Annotated, Self

import numpy as np
import OpenEXR
from pydantic import BaseModel, Field, ValidationError, model_validator

from litrig.base.errors import FormatError, InputError
from litrig.base.version import litrig_version
from processing.exr_parts import check_budget, check_part, listed, read_heads, read_parts, require, write_parts
from processing.shape.harmonics import TERMS
from processing.shape.model import Environments, SurfaceEnvironment

KIND = "environments"
KEY = "litrig.env"
ENDING = ".env.exr"
LARGEST_SIDE = 8192
MOST_SURFACES = 256
_LARGEST_BYTES = 8 << 30
_MEND = "copy it, or reconstruct the environments again"
_Number = Annotated[float, Field(allow_inf_nan=False)]
_Coefficients = Annotated[tuple[tuple[_Number, _Number, _Number], ...], Field(min_length=TERMS, max_length=TERMS)]
_Surface = Annotated[int, Field(ge=1, lt=1 << 32)]
_FLAGS = ("diffuse_is_illumination", "reflection_is_illumination")


class _Meaning(BaseModel, frozen=True, extra="forbid"):
    """The JSON itself."""

    diffuse: Annotated[dict[_Surface, _Coefficients], Field(min_length=1, max_length=MOST_SURFACES)]
    """Nine coefficients, red, green and blue each, by the number of the surface."""
    diffuse_is_illumination: tuple[_Surface, ...] = ()
    """Surfaces whose diffuse light is yet to be multiplied by their albedo."""
    reflection_is_illumination: tuple[_Surface, ...] = ()
    """Surfaces whose reflected light is yet to be multiplied by their albedo."""
    source: str = ""
    """Digest of the shading buffers."""
    litrig: str

    @model_validator(mode="after")
    def _names_surfaces_that_are_here(self) -> Self:
        for number in (*self.diffuse_is_illumination, *self.reflection_is_illumination):
            if number not in self.diffuse:
                raise ValueError(f"illumination of surface {number}, which has no coefficients")
        return self


def write_environments(path: Path, environments: Environments, source: str = "") -> None:
    """Write environments; the file is whole or not there.

    Parameters
    ----------
    source : digest of the shading buffers that they were reconstructed from

    Raises
    ------
    InputError
        The name does not end in .env.exr, the maps are not square, of one size and of finite numbers, or the file
        cannot be written.
    """
    if not path.name.lower().endswith(ENDING):
        raise InputError(f"{path}: cannot hold environments; end the name in {ENDING}")
    maps = {name: texels for number, one in sorted(environments.items()) for name, texels in _sides(number, one)}
    size = next(iter(maps.values())).shape[0] if maps else 0
    if not size or any(texels.shape != (size, size, 3) for texels in maps.values()):
        raise InputError(f"{path}: maps of {len(environments)} surfaces are not square and of one size; give (S, S, 3)")
    if not all(np.all(np.isfinite(texels)) for texels in maps.values()):
        raise InputError(f"{path}: a map holds what is no number; mend it")
    try:
        meaning = _Meaning.model_validate(
            {
                "diffuse": {number: one.diffuse.tolist() for number, one in sorted(environments.items())},
                **{
                    flag: tuple(number for number, one in sorted(environments.items()) if getattr(one, flag))
                    for flag in _FLAGS
                },
                "source": source,
                "litrig": litrig_version(),
            }
        )
    except ValidationError as error:
        raise InputError(f"{path}: {_first(error)}; give nine finite coefficients a channel and surface") from error
    header = {
        "type": OpenEXR.scanlineimage,
        "compression": OpenEXR.ZIP_COMPRESSION,
        "displayWindow": (np.zeros(2, np.int32), np.array([size - 1, size - 1], np.int32)),
        "litrig.kind": KIND,
        KEY: meaning.model_dump_json(),
    }
    write_parts(
        path,
        [
            OpenEXR.Part({**header, "name": name}, {"RGB": np.ascontiguousarray(texels, np.float32)})
            for name, texels in maps.items()
        ],
    )


def read_environments(path: Path) -> Environments:
    """Read environments. What was stored as float32 comes back bit by bit.

    Raises
    ------
    InputError
        The file cannot be read.
    FormatError
        It holds no environments, contradicts itself, or is damaged.
    """
    heads = read_heads(path, KEY)
    kinds = sorted({head.kind or "none" for head in heads})
    require(path, kinds == [KIND], f"is of kind {listed(kinds)}, not {KIND}; give reconstructed environments")
    try:
        meaning = _Meaning.model_validate_json(heads[0].meaning)
    except ValidationError as error:
        raise FormatError(f"{path}: {KEY} {_first(error)}; {_MEND}") from error
    names = [f"surface.{number}.{side}" for number in sorted(meaning.diffuse) for side in ("front", "back")]
    found = [head.name for head in heads]
    require(path, found == names, f"has parts {listed(found)}, not {listed(names)}; {_MEND}")
    size, rows = heads[0].data
    require(
        path,
        0 < size == rows <= LARGEST_SIDE,
        f"claims maps of {size} × {rows}; they are square, 1 to {LARGEST_SIDE} on a side; {_MEND}",
    )
    for head in heads:
        check_part(path, head, ["B", "G", "R"], (size, size), (size, size), _MEND)
    check_budget(path, len(heads) * 3 * 4 * size * size, _LARGEST_BYTES)
    parts = read_parts(path, dict.fromkeys(names, (size, size, 3)), _MEND)
    return {
        number: SurfaceEnvironment(
            np.array(coefficients, np.float32),
            parts[f"surface.{number}.front"]["RGB"],
            parts[f"surface.{number}.back"]["RGB"],
            **{flag: number in getattr(meaning, flag) for flag in _FLAGS},
        )
        for number, coefficients in sorted(meaning.diffuse.items())
    }


def _sides(number: int, one: SurfaceEnvironment) -> list[tuple[str, np.ndarray]]:
    return [(f"surface.{number}.front", one.front), (f"surface.{number}.back", one.back)]


def _first(error: ValidationError) -> str:
    first = error.errors()[0]
    return f"{'.'.join(str(part) for part in first['loc'])}: {first['msg']}"
