"""`.env.exr` files: reconstructed environments as multi-part OpenEXR that any program can look into.

Parts `surface.N.front` and `surface.N.back` for each surface N (R, G, B; linear light), all of one square size; every
part says `litrig.kind` and, as JSON, `litrig.env`, which has the coefficients of the diffuse shading, and names the
surfaces whose diffuse or reflected light is that before their albedo. Extended surfaces have parts
`surface.N.region.K.front` and `.back` besides, and where they are in the JSON.
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Self

import numpy as np
import OpenEXR
from numpy.typing import NDArray
from pydantic import BaseModel, Field, ValidationError, model_validator

from litrig.base.errors import FormatError, InputError
from litrig.base.version import litrig_version
from processing.exr_parts import check_budget, check_part, listed, read_heads, read_parts, require, write_parts
from processing.limits import FLAT_RATIO
from processing.shape.harmonics import TERMS
from processing.shape.model import Environments, Region, SurfaceEnvironment

F32 = NDArray[np.float32]
KIND = "environments"
KEY = "litrig.env"
ENDING = ".env.exr"
LARGEST_SIDE = 8192
MOST_SURFACES = 256
MOST_REGIONS = 64
_LARGEST_BYTES = 8 << 30
_MEND = "copy it, or reconstruct the environments again"
_Number = Annotated[float, Field(allow_inf_nan=False)]
_Coefficients = Annotated[tuple[tuple[_Number, _Number, _Number], ...], Field(min_length=TERMS, max_length=TERMS)]
_Surface = Annotated[int, Field(ge=1, lt=1 << 32)]
_FLAGS = ("diffuse_is_illumination", "reflection_is_illumination")


class _Regions(BaseModel, frozen=True, extra="forbid"):
    """The parts of an extended surface."""

    falloff: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    centres: Annotated[tuple[tuple[_Number, _Number, _Number], ...], Field(min_length=1, max_length=MOST_REGIONS)]
    diffuse: Annotated[tuple[_Coefficients, ...], Field(min_length=1, max_length=MOST_REGIONS)]

    @model_validator(mode="after")
    def _all_have_both(self) -> Self:
        if len(self.centres) != len(self.diffuse):
            raise ValueError(f"{len(self.centres)} centres for {len(self.diffuse)} regions")
        return self


class _Meaning(BaseModel, frozen=True, extra="forbid"):
    """The JSON itself."""

    diffuse: Annotated[dict[_Surface, _Coefficients], Field(min_length=1, max_length=MOST_SURFACES)]
    """Nine coefficients, red, green and blue each, by the number of the surface."""
    diffuse_is_illumination: tuple[_Surface, ...] = ()
    """Surfaces whose diffuse light is yet to be multiplied by their albedo."""
    reflection_is_illumination: tuple[_Surface, ...] = ()
    """Surfaces whose reflected light is yet to be multiplied by their albedo."""
    regions: dict[_Surface, _Regions] = {}
    """Of extended surfaces."""
    source: str = ""
    """Digest of the shading buffers."""
    litrig: str

    @model_validator(mode="after")
    def _names_surfaces_that_are_here(self) -> Self:
        for number in (*self.diffuse_is_illumination, *self.reflection_is_illumination):
            if number not in self.diffuse:
                raise ValueError(f"illumination of surface {number}, which has no coefficients")
        for number in self.regions:
            if number not in self.diffuse:
                raise ValueError(f"regions of surface {number}, which has no coefficients")
        return self


def check_room(path: Path, surfaces: int, regions: int, size: int) -> None:
    """Refuse before the work more environments than a file holds.

    Parameters
    ----------
    regions : of each surface; 1 is none
    size : of the maps, texels a side

    Raises
    ------
    InputError
        They are too many, or too large together.
    """
    if surfaces > MOST_SURFACES:
        raise InputError(
            f"{path}: holds {MOST_SURFACES} surfaces at most, and not {surfaces}; choose those to edit with --surface"
        )
    total = surfaces * (1 + regions if regions > 1 else 1) * 2 * _texel_bytes(size)
    if total > _LARGEST_BYTES:
        raise InputError(
            f"{path}: would hold {total / 2**30:.1f} GiB of environments, and takes {_LARGEST_BYTES >> 30} at most; "
            "choose surfaces with --surface, or a smaller --size"
        )


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
    check_room(path, len(environments), max(len(one.regions) for one in environments.values()), size)
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
                "regions": {number: _told(one) for number, one in sorted(environments.items()) if one.regions},
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
    stems = [stem for number in sorted(meaning.diffuse) for stem in _stems(number, meaning)]
    names = [f"{stem}.{side}" for stem in stems for side in ("front", "back")]
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
    check_budget(path, len(heads) * _texel_bytes(size), _LARGEST_BYTES, ratio=FLAT_RATIO)
    parts = read_parts(path, dict.fromkeys(names, (size, size, 3)), _MEND)
    return {number: _surface(number, meaning, parts) for number in sorted(meaning.diffuse)}


def _texel_bytes(size: int) -> int:
    """Size of one half's texels."""
    return 3 * 4 * size * size


def _surface(number: int, meaning: _Meaning, parts: Mapping[str, Mapping[str, F32]]) -> SurfaceEnvironment:
    flags: dict[str, Any] = {flag: number in getattr(meaning, flag) for flag in _FLAGS}
    said = meaning.regions.get(number)
    coefficients = [meaning.diffuse[number], *(said.diffuse if said else ())]
    whole, *others = [
        SurfaceEnvironment(
            np.array(one, np.float32), parts[f"{stem}.front"]["RGB"], parts[f"{stem}.back"]["RGB"], **flags
        )
        for one, stem in zip(coefficients, _stems(number, meaning), strict=True)
    ]
    if said is None:
        return whole
    regions = [Region(np.array(at, np.float32), one) for at, one in zip(said.centres, others, strict=True)]
    return replace(whole, regions=tuple(regions), falloff=said.falloff)


def _stems(number: int, meaning: _Meaning) -> list[str]:
    """Name the environments of a surface, as parts are named: the whole one, and those of regions."""
    count = len(meaning.regions[number].centres) if number in meaning.regions else 0
    return [f"surface.{number}", *(f"surface.{number}.region.{index}" for index in range(1, count + 1))]


def _sides(number: int, one: SurfaceEnvironment) -> list[tuple[str, F32]]:
    named = [(f"surface.{number}", one)]
    named += [(f"surface.{number}.region.{index}", at.environment) for index, at in enumerate(one.regions, 1)]
    return [(f"{stem}.{side}", getattr(part, side)) for stem, part in named for side in ("front", "back")]


def _told(one: SurfaceEnvironment) -> dict[str, Any]:
    return {
        "falloff": one.falloff,
        "centres": [region.centre.tolist() for region in one.regions],
        "diffuse": [region.environment.diffuse.tolist() for region in one.regions],
    }


def _first(error: ValidationError) -> str:
    first = error.errors()[0]
    return f"{'.'.join(str(part) for part in first['loc'])}: {first['msg']}"
