"""Web folders as relight writes and OpenLIME shows them: `info.json` and `plane_0.jpg`, `plane_1.jpg`, ….

Three planes of codes a JPEG, row 0 on top: value = (code / 255 − bias) · scale, where 1 is white; scale and bias stand
in `materials[0]`, one of each a plane. With `colorspace` rgb, plane 3t + c is term t of channel c. With lrgb, planes 0
to 2 are the colour and each further one a term of the luminance. Terms of a PTM come in the order 1, u, v, u², uv, v²,
those of HSH in that of the `.rti` format. The key `litrig` holds what others have no key for.
"""

import json
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from litrig.base.config import ForeignModel, parse_json_bytes
from litrig.base.errors import FormatError, InputError
from litrig.base.files import making_folder, read_limited
from litrig.base.progress import Progress, Report, silent
from litrig.base.version import litrig_version
from processing.ptm.basis import Basis
from processing.ptm.files.coder import Coder, as_it_is, checked, coder_for, multiplied_out, worked_out
from processing.ptm.files.plane_jpeg import check_side, decode_planes, encode_planes
from processing.ptm.files.quantise import ScaleBias
from processing.ptm.files.remarks import check_space
from processing.ptm.model import Colour, Material, Ptm, Space
from processing.room import make_room

F32 = NDArray[np.float32]

BASES = (Basis("ptm", 6), Basis("ptm", 3), Basis("hsh", 4), Basis("hsh", 9))
INFO = "info.json"
QUALITY = 100
LARGEST_PIXELS = 400_000_000
_LARGEST_INFO_BYTES, _LARGEST_PLANE_BYTES = 1_000_000, 1 << 30
_MOST_PLANES = 64
_ORDER = {6: (5, 3, 4, 0, 2, 1), 3: (2, 0, 1)}

_Number = Annotated[float, Field(ge=-1e6, le=1e6)]
_Numbers = Annotated[tuple[_Number, ...], Field(max_length=_MOST_PLANES)]
_Side = Annotated[int, Field(ge=1, le=1_000_000)]


class _Planes(ForeignModel):
    scale: _Numbers
    bias: _Numbers


class _Remarks(ForeignModel):
    space: str = "srgb"
    source: str = ""


class _Info(ForeignModel):
    width: _Side
    height: _Side
    type: str
    colorspace: str
    nplanes: Annotated[int, Field(ge=1, le=_MOST_PLANES)]
    materials: Annotated[tuple[_Planes, ...], Field(min_length=1, max_length=1)]
    litrig: _Remarks = _Remarks()


class _Layout(NamedTuple):
    shape: tuple[int, int]
    basis: Basis
    colour: Colour
    space: Space
    source: str
    scales: F32
    biases: F32

    def order(self) -> tuple[int, ...]:
        return order_of(self.basis)


def order_of(basis: Basis) -> tuple[int, ...]:
    """Return which term of a basis comes first in a folder, which second, and so on."""
    return _ORDER[basis.terms] if basis.kind == "ptm" else tuple(range(basis.terms))


def write_web_folder(
    path: Path, material: Material, coder: Coder | None = None, report: Report = silent, *, quality: int = QUALITY
) -> None:
    """Write a web folder; it is whole or not there. HSH is always rgb in it, multiplied out if it must be.

    Parameters
    ----------
    coder : as `web_folder_coder` chooses it, if that has been done
    quality : of the JPEGs, 1 to 100. The planes of a fit lose little at 100 only

    Raises
    ------
    InputError
        The basis is not one that readers know, a coefficient is not finite, `path` is there and is no empty folder, or
        it cannot be written.
    """
    coder = coder or web_folder_coder(path, material)
    check_side(path, material.shape)
    with making_folder(path) as folder:
        _write_planes(path, folder, material, coder, quality, report)
        (folder / INFO).write_text(json.dumps(_info(material, coder, quality), indent=1) + "\n", "utf-8")


def web_folder_coder(path: Path, material: Material) -> Coder:
    """Choose the codes of a web folder.

    Raises
    ------
    InputError
        The basis is not one that readers know, or a coefficient is not finite.
    """
    if material.basis not in BASES:
        raise InputError(
            f"{path}: readers of web folders know PTM of 3 and 6 terms and HSH of 4 and 9, not {material.basis}; "
            "write a .ptm.exr, or fit again"
        )
    # Readers know luminance and colour apart of polynomials only.
    return coder_for(path, material, seen=multiplied_out if material.basis.kind == "hsh" else as_it_is)


def read_web_folder(path: Path) -> Ptm:
    """Read a web folder of type ptm or hsh, in colour space rgb or lrgb.

    Raises
    ------
    InputError, FormatError
        The folder or a file in it is missing, of a kind that is not read, damaged, or contradicts the others. Sizes are
        checked before memory is taken.
    """
    layout = _read_layout(path)
    order = layout.order()
    lrgb = layout.colour == "lrgb"
    planes = _decoded(path, layout)
    # Memory is taken once a JPEG says the same size as the head.
    planes = chain([next(planes)], planes)
    colour = np.stack([next(planes) for _ in range(3)], axis=-1) if lrgb else None
    coefficients = np.zeros((len(order), *layout.shape, 1 if lrgb else 3), np.float32)
    for term in order:
        for channel in range(coefficients.shape[3]):
            coefficients[term, ..., channel] = next(planes)
    return Ptm(coefficients, colour, layout.space, layout.source, layout.basis)


def describe_web_folder(path: Path) -> dict[str, Any]:
    """Say what a web folder holds, from `info.json` alone; coefficients as far as their codes reach."""
    layout = _read_layout(path)
    per_term = 1 if layout.colour == "lrgb" else 3
    ends = np.stack([-layout.biases * layout.scales, (1 - layout.biases) * layout.scales])
    ends = ends[:, -per_term * layout.basis.terms :].reshape(2, layout.basis.terms, per_term)
    names = [layout.basis.names[term] for term in layout.order()]
    return {
        "width": layout.shape[1],
        "height": layout.shape[0],
        "basis": str(layout.basis),
        "colour": layout.colour,
        "space": layout.space,
        "coefficients": {
            name: (float(ends[:, place].min()), float(ends[:, place].max())) for place, name in enumerate(names)
        },
        "source": layout.source,
    }


def _write_planes(path: Path, folder: Path, material: Material, coder: Coder, quality: int, report: Report) -> None:
    height, width = material.shape
    order = list(order_of(material.basis))
    colours, channels = (0, 3) if coder.balance is None else (3, 1)
    room = make_room((colours + channels * len(order), height, width), np.uint8, folder=folder)
    for rows, codes in worked_out(material, lambda rows: coder.encode(checked(path, material.strip(rows)))):
        if codes.colour is not None:
            room.array[:3, rows] = codes.colour.transpose(2, 0, 1)
        terms = codes.coefficients[order].transpose(0, 3, 1, 2)
        room.array[colours:, rows] = terms.reshape(-1, *terms.shape[2:])
        room.release()
        report(Progress("fitting", rows.stop, height))
    for number, first in enumerate(range(0, len(room.array), 3)):
        (folder / f"plane_{number}.jpg").write_bytes(encode_planes(room.array[first : first + 3], quality))
        room.release()


def _info(material: Material, coder: Coder, quality: int) -> dict[str, Any]:
    height, width = material.shape
    steps = [step for term in order_of(material.basis) for step in coder.steps[term]]
    if coder.balance is not None:
        steps = [ScaleBias(1 / 255, 0)] * 3 + steps
    return {
        "width": width,
        "height": height,
        "format": "jpg",
        "type": material.basis.kind,
        "colorspace": "rgb" if coder.balance is None else "lrgb",
        "lights": [],
        "nplanes": len(steps),
        "quality": quality,
        "materials": [
            {"scale": [255 * step.scale for step in steps], "bias": [step.bias / 255 for step in steps]},
        ],
        "litrig": {"space": material.space, "source": material.source, "version": litrig_version()},
    }


def _read_layout(path: Path) -> _Layout:
    name = path / INFO
    info = parse_json_bytes(read_limited(name, _LARGEST_INFO_BYTES), _Info, str(name))
    if info.width * info.height > LARGEST_PIXELS:
        raise FormatError(f"{name}: claims {info.width} × {info.height} pixels; at most {LARGEST_PIXELS:,} are read")
    colour = _known(name, "colorspace", info.colorspace, ("rgb", "lrgb"))
    kind = _known(name, "type", info.type, ("ptm", "hsh"))
    terms = info.nplanes - 3 if colour == "lrgb" else info.nplanes / 3
    found = [basis for basis in BASES if (basis.kind, basis.terms) == (kind, terms)]
    if not found:
        raise FormatError(f"{name}: {info.nplanes} planes make no {colour} {kind} that is read; export it again")
    scales, biases = info.materials[0].scale, info.materials[0].bias
    if not len(scales) == len(biases) == info.nplanes:
        raise FormatError(
            f"{name}: {len(scales)} scales and {len(biases)} biases for {info.nplanes} planes; export it again"
        )
    return _Layout(
        (info.height, info.width),
        found[0],
        "lrgb" if colour == "lrgb" else "rgb",
        check_space(name, info.litrig.space),
        info.litrig.source,
        np.array(scales, np.float32),
        np.array(biases, np.float32),
    )


def _known(name: Path, key: str, value: str, known: tuple[str, ...]) -> str:
    if value not in known:
        raise FormatError(f"{name}: {key} is {value[:40]!r}; {' and '.join(known)} are read, export it so")
    return value


def _decoded(path: Path, layout: _Layout) -> Iterator[F32]:
    """Yield plane after plane (H, W), as values."""
    for first in range(0, len(layout.scales), 3):
        jpeg = path / f"plane_{first // 3}.jpg"
        if not jpeg.exists() and any(path.glob("plane_0*")) and not (path / "plane_0.jpg").exists():
            raise FormatError(f"{path}: is cut into tiles, which are not read; export it as plain images")
        codes = decode_planes(jpeg, read_limited(jpeg, _LARGEST_PLANE_BYTES), layout.shape)
        for plane in range(first, min(first + 3, len(layout.scales))):
            scale, bias = layout.scales[plane], layout.biases[plane]
            yield codes[..., plane - first] * (scale / np.float32(255)) - bias * scale
