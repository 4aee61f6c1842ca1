"""`.ptm.exr` files: coefficients of any basis as float32, bit by bit, in a multi-part OpenEXR.

Parts `term.NAME`, one for each term of the basis in its order: R, G, B where each channel has its own coefficients, Y
where they give the luminance; then a part `colour` (R, G, B) stands first, so that a viewer shows it. Every part says
`litrig.kind` and, as JSON, `litrig.ptm`.
"""

from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
from numpy.typing import NDArray
from pydantic import ValidationError

from litrig.base.config import StrictModel
from litrig.base.errors import FormatError, InputError
from litrig.base.progress import Progress, Report, silent
from litrig.base.version import litrig_version
from processing.exr_parts import check_budget, check_part, listed, read_heads, read_parts, require, write_parts
from processing.ptm.basis import TERMS, Basis, Kind
from processing.ptm.files.coder import checked, worked_out
from processing.ptm.model import Colour, Material, Ptm, Space
from processing.room import make_room

F32 = NDArray[np.float32]

KIND = "ptm"
KEY = "litrig.ptm"
LARGEST_PIXELS = 400_000_000
LARGEST_BYTES = 64 << 30
_MEND = "copy it, or fit again"


class _Meaning(StrictModel):
    """The JSON itself."""

    basis: Kind
    terms: int
    colour: Colour
    space: Space
    source: str
    litrig: str


class _Layout:
    """What the heads say, checked."""

    def __init__(self, path: Path) -> None:
        heads = read_heads(path, KEY)
        kinds = sorted({head.kind or "none" for head in heads})
        require(path, kinds == [KIND], f"is of kind {listed(kinds)}, not {KIND}; give a .ptm.exr")
        meaning = _read_meaning(path, heads[0].meaning)
        self.basis = Basis(meaning.basis, meaning.terms)
        self.colour, self.space, self.source = meaning.colour, meaning.space, meaning.source
        names = part_names(self.basis, self.colour)
        found = [head.name for head in heads]
        require(path, found == names, f"has parts {listed(found)}, not {listed(names)}; {_MEND}")
        width, height = heads[0].data
        require(
            path,
            0 < width * height <= LARGEST_PIXELS,
            f"claims {width} × {height} pixels; 1 to {LARGEST_PIXELS:,} are read",
        )
        self.shape = height, width
        for head in heads:
            channels = ["Y"] if self.colour == "lrgb" and head.name != "colour" else ["B", "G", "R"]
            check_part(path, head, channels, (width, height), (width, height), _MEND)
        channels_in_all = self.basis.terms + 3 if self.colour == "lrgb" else 3 * self.basis.terms
        check_budget(path, 4 * channels_in_all * width * height, LARGEST_BYTES)

    def shapes(self) -> dict[str, tuple[int, ...]]:
        """Return the shape of every part's pixels."""
        height, width = self.shape
        of_terms = (height, width) if self.colour == "lrgb" else (height, width, 3)
        names = part_names(self.basis, self.colour)
        return {name: (height, width, 3) if name == "colour" else of_terms for name in names}


def part_names(basis: Basis, colour: Colour) -> list[str]:
    """Name the parts in their order."""
    return ["colour"] * (colour == "lrgb") + [f"term.{name}" for name in basis.names]


def write_ptm_exr(path: Path, material: Material, report: Report = silent) -> None:
    """Write the coefficients of a material as they are; the file is whole or not there.

    Raises
    ------
    InputError
        A coefficient is not finite, or the path cannot be written.
    """
    height, width = material.shape
    channels = 1 if material.kind == "lrgb" else 3
    coefficients = make_room((material.basis.terms, height, width, channels), folder=path.absolute().parent)
    colour = make_room((height, width, 3), folder=path.absolute().parent)
    for rows, strip in worked_out(material, lambda rows: checked(path, material.strip(rows))):
        coefficients.array[:, rows] = strip.coefficients
        if strip.colour is not None:
            colour.array[rows] = strip.colour
        coefficients.release()
        report(Progress("fitting", rows.stop, height))
    arrays = {f"term.{name}": term for name, term in zip(material.basis.names, coefficients.array, strict=True)}
    header = _header(material)
    write_parts(
        path,
        [
            OpenEXR.Part({**header, "name": name}, _channels(colour.array if name == "colour" else arrays[name]))
            for name in part_names(material.basis, material.kind)
        ],
    )


def read_ptm_exr(path: Path) -> Ptm:
    """Read a `.ptm.exr`; coefficients come back bit by bit.

    Raises
    ------
    InputError, FormatError
        The file is missing, holds something else, contradicts itself, or is damaged. Sizes are checked before memory is
        taken.
    """
    layout = _Layout(path)
    parts = read_parts(path, layout.shapes(), _MEND)
    channel = "Y" if layout.colour == "lrgb" else "RGB"
    terms = [parts[f"term.{name}"][channel] for name in layout.basis.names]
    coefficients = np.stack([term[..., None] if term.ndim == 2 else term for term in terms])
    colour = parts["colour"]["RGB"] if layout.colour == "lrgb" else None
    return Ptm(coefficients, colour, layout.space, layout.source, layout.basis)


def describe_ptm_exr(path: Path) -> dict[str, Any]:
    """Say what a `.ptm.exr` holds, from its heads alone."""
    layout = _Layout(path)
    return {
        "width": layout.shape[1],
        "height": layout.shape[0],
        "basis": str(layout.basis),
        "colour": layout.colour,
        "space": layout.space,
        "source": layout.source,
    }


def _header(material: Material) -> dict[str, Any]:
    height, width = material.shape
    meaning = _Meaning(
        basis=material.basis.kind,
        terms=material.basis.terms,
        colour=material.kind,
        space=material.space,
        source=material.source,
        litrig=litrig_version(),
    )
    return {
        "type": OpenEXR.scanlineimage,
        "compression": OpenEXR.ZIP_COMPRESSION,
        "displayWindow": (np.zeros(2, np.int32), np.array([width - 1, height - 1], np.int32)),
        "litrig.kind": KIND,
        KEY: meaning.model_dump_json(),
    }


def _channels(values: F32) -> dict[str, F32]:
    return {"RGB": values} if values.shape[2] == 3 else {"Y": values[..., 0]}


def _check(path: Path, values: F32) -> None:
    if not np.all(np.isfinite(values)):
        raise InputError(f"{path}: coefficients that are not numbers cannot be written; fit again")


def _read_meaning(path: Path, stored: str) -> _Meaning:
    try:
        meaning = _Meaning.model_validate_json(stored)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        raise FormatError(f"{path}: {KEY} {place}: {first['msg']}; {_MEND}") from error
    if meaning.terms not in TERMS[meaning.basis]:
        raise FormatError(f"{path}: {KEY} says {meaning.basis} of {meaning.terms} terms, which is none; {_MEND}")
    return meaning
