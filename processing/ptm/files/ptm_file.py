"""`.ptm` files: PTM_FORMAT_RGB and PTM_FORMAT_LRGB of the HP format 1.1 and 1.2.

A header in ASCII (version, format, width, height, six scales, six biases), then bytes: value = (code − bias)·scale in
units where 255 is white, coefficients in the order u², v², uv, u, v, 1, rows from the bottom up. RGB holds three blocks
of six bytes a pixel; LRGB holds a block of six bytes a pixel and one of three for the colour, or nine bytes a pixel in
version 1.1. Colour times luminance is divided by 255.

The header has no place for a comment that all readers skip. Readers stop after the last byte that they expect, so what
litrig knows besides (the space of the values, the digest of the frames, the version that wrote it) follows there as one
line of JSON. A file without it holds display values, as the field has it, and names no source.
"""

import json
import os
import re
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, cast, get_args

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import FormatError, InputError
from litrig.base.files import replacing
from litrig.base.progress import Progress, Report, silent
from litrig.base.version import litrig_version
from processing.ptm.basis import PTM
from processing.ptm.files.balance import Balance, choose_balance
from processing.ptm.files.quantise import ScaleBias
from processing.ptm.files.rounding import Rounding, choose_rounding
from processing.ptm.model import Colour, Material, Ptm, Space, Strip

F32 = NDArray[np.float32]
U8 = NDArray[np.uint8]

TERMS = PTM.terms
LARGEST_PIXELS = 400_000_000
_HEADER_BYTES = 4096
_NUMBER, _WHOLE = rb"\s+([-+]?[\d.]+(?:[eE][-+]?\d+)?)", rb"\s+([-+]?\d+)(?:\.0*)?"
_HEADER = re.compile(
    rb"\s*PTM_1\.([12])\s+(PTM_FORMAT_\w+)\s+(\d{1,9})\s+(\d{1,9})" + _NUMBER * TERMS + _WHOLE * TERMS + rb"[ \t]*\r?\n"
)
_TRAILER = b"\n#litrig "
_LARGEST_SCALE, _LARGEST_BIAS = 1e9, 1_000_000
# PTMfitter leaves a byte after the pixels.
_SPARE_BYTES = 2
_STRIP_PIXELS = 16_384
_SAMPLES = 12_000
_AT_ONCE = min(4, os.cpu_count() or 1)
_FORMATS: dict[Colour, str] = {"rgb": "PTM_FORMAT_RGB", "lrgb": "PTM_FORMAT_LRGB"}
_BYTES_PER_PIXEL = {"PTM_FORMAT_RGB": 3 * TERMS, "PTM_FORMAT_LRGB": TERMS + 3}


class _Header(NamedTuple):
    interleaved: bool
    format: str
    width: int
    height: int
    steps: tuple[ScaleBias, ...]
    length: int

    @property
    def payload(self) -> int:
        return self.width * self.height * _BYTES_PER_PIXEL[self.format]


@dataclass(frozen=True)
class PtmCodes:
    """How a material becomes bytes: the rounding of its coefficients, and how LRGB shares brightness with colour."""

    rounding: Rounding
    balance: Balance | None = None

    @property
    def steps(self) -> tuple[ScaleBias, ...]:
        """Scale and bias of each term, as the header holds them."""
        return tuple(ScaleBias(float(f"{step.scale * 255:.8g}"), step.bias) for step in self.rounding.steps)

    def blocks(self, strip: Strip) -> list[U8]:
        """Return the blocks of the file for some rows, (h, W, bytes) each: six codes a pixel, or three of colour."""
        if self.balance is None:
            codes = self.rounding.encode(strip.coefficients)
            return [np.moveaxis(codes[..., channel], 0, -1) for channel in range(codes.shape[-1])]
        luminance, colour = self.balance.encode(strip)
        return [np.moveaxis(luminance, 0, -1), colour]

    def stored(self, strip: Strip) -> Strip:
        """Return what a reader of the file gets of coefficients (6 or 3, ..., C)."""
        terms, strip = len(strip.coefficients), _six_terms(strip)
        if self.balance is None:
            kept = Strip(self.rounding.decode(self.rounding.encode(strip.coefficients)), None)
        else:
            kept = self.balance.decode(*self.balance.encode(strip))
        return kept._replace(coefficients=kept.coefficients[-terms:])


def write_ptm(path: Path, material: Material, codes: PtmCodes | None = None, report: Report = silent) -> None:
    """Write a PTM_1.2 file, RGB or LRGB as the material is, strip by strip; it is whole or not there.

    Parameters
    ----------
    codes : how coefficients are rounded; by default chosen for this material

    Raises
    ------
    InputError
        The material has another basis than the format, a coefficient is not finite, or the path cannot be written.
    """
    codes = codes or choose_codes(material, str(path))
    height, width = material.shape
    header = _format_header(material, codes.steps)
    rows = max(1, _STRIP_PIXELS // width)

    def write(top: int, file: int) -> int:
        bottom = min(height, top + rows)
        strip = _six_terms(material.strip(slice(top, bottom)))
        if not np.isfinite(np.sum(strip.coefficients)):
            raise InputError(f"{path}: coefficients that are not numbers cannot be written; fit again")
        offset = len(header)
        for block in codes.blocks(strip):  # each (h, W, bytes a pixel), and in the file the bottom row comes first
            stride = width * block.shape[2]
            _write_all(file, block[::-1].tobytes(), offset + (height - bottom) * stride)
            offset += height * stride
        return bottom

    with replacing(path) as temporary, temporary.open("wb") as out, ThreadPoolExecutor(_AT_ONCE) as workers:
        _write_all(out.fileno(), header, 0)
        for bottom in workers.map(lambda top: write(top, out.fileno()), range(0, height, rows)):
            report(Progress("fitting", bottom, height))
        payload = height * width * _BYTES_PER_PIXEL[_FORMATS[material.kind]]
        _write_all(out.fileno(), _format_trailer(material), len(header) + payload)


def choose_codes(material: Material, source: str = "") -> PtmCodes:
    """Choose the codes of a `.ptm` from a sample of a material's pixels; `source` names it in errors.

    Raises
    ------
    InputError
        The material has another basis than the format, or a coefficient is not finite.
    """
    if material.basis.kind != "ptm":
        raise InputError(f"{source}: a .ptm file holds a {PTM}, this is a {material.basis}; write .rti or .ptm.exr")
    gram = material.gram if material.basis == PTM else PTM.gram
    sample = _six_terms(material.sample(_SAMPLES))
    if not np.all(np.isfinite(sample.coefficients)):
        raise InputError(f"{source}: coefficients that are not numbers cannot be written; fit again")
    if material.kind == "lrgb":
        balance = choose_balance(sample, gram)
        return PtmCodes(balance.rounding, balance)
    return PtmCodes(choose_rounding(sample.coefficients.reshape(TERMS, -1), gram))


def read_ptm(path: Path) -> Ptm:
    """Read an RGB or LRGB `.ptm` of version 1.1 or 1.2.

    Raises
    ------
    InputError, FormatError
        The file is missing, is no PTM, holds a kind that is not read (LUM, JPEG, look-up tables), or is shorter or
        longer than its header says. Sizes are checked before memory is taken.
    """
    try:
        with path.open("rb") as file:
            header = _parse_header(path, file.read(_HEADER_BYTES))
            rest = path.stat().st_size - header.length
            if rest < header.payload:
                raise FormatError(
                    f"{path}: {header.width} × {header.height} pixels want {header.payload:,} bytes, the file has "
                    f"{rest:,}; it was cut short, copy it again"
                )
            file.seek(header.length)
            payload = np.frombuffer(file.read(header.payload), np.uint8)
            remarks = _parse_trailer(path, file.read(_HEADER_BYTES))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path") from error
    coefficients, colour = _decode(header, payload)
    return Ptm(coefficients, colour, cast(Space, remarks["space"]), remarks["source"])


def _format_header(material: Material, steps: tuple[ScaleBias, ...]) -> bytes:
    height, width = material.shape
    lines = [
        "PTM_1.2",
        _FORMATS[material.kind],
        str(width),
        str(height),
        " ".join(f"{step.scale:.8g}" for step in steps),
        " ".join(str(step.bias) for step in steps),
    ]
    return ("\n".join(lines) + "\n").encode("ascii")


def _six_terms(strip: Strip) -> Strip:
    """Fill up a polynomial of first degree."""
    lacking = TERMS - len(strip.coefficients)
    if not lacking:
        return strip
    missing = np.zeros((lacking, *strip.coefficients.shape[1:]), np.float32)
    return strip._replace(coefficients=np.concatenate([missing, strip.coefficients]))


def _write_all(file: int, content: bytes, offset: int) -> None:
    """Write at a place; a full disk may take part of it and say nothing."""
    while content:
        written = os.pwrite(file, content, offset)
        content, offset = content[written:], offset + written


def _format_trailer(material: Material) -> bytes:
    remarks = {"space": material.space, "source": material.source, "litrig": litrig_version()}
    return _TRAILER + json.dumps(remarks).encode("ascii") + b"\n"


def _parse_header(path: Path, start: bytes) -> _Header:
    found = _HEADER.match(start)
    if found is None:
        raise FormatError(f"{path}: not a PTM file of version 1.1 or 1.2, or its header is damaged; export it again")
    kind = found[2].decode()
    width, height = int(found[3]), int(found[4])
    if kind not in _BYTES_PER_PIXEL:
        raise FormatError(f"{path}: is a {kind}, which is not read; export it as PTM_FORMAT_LRGB or PTM_FORMAT_RGB")
    if not 0 < width * height <= LARGEST_PIXELS:
        raise FormatError(f"{path}: claims {width} × {height} pixels; at most {LARGEST_PIXELS:,} are read")
    try:
        scales = [float(token) for token in found.groups()[4 : 4 + TERMS]]
    except ValueError as error:
        raise FormatError(f"{path}: a scale is not a number ({error}); export it again") from error
    biases = [int(token) for token in found.groups()[4 + TERMS :]]
    if max(map(abs, scales)) > _LARGEST_SCALE or max(map(abs, biases)) > _LARGEST_BIAS:
        raise FormatError(f"{path}: scale or bias is out of all range; export it again")
    steps = tuple(ScaleBias(scale, bias) for scale, bias in zip(scales, biases, strict=True))
    return _Header(found[1] == b"1" and kind == "PTM_FORMAT_LRGB", kind, width, height, steps, found.end())


def _parse_trailer(path: Path, rest: bytes) -> dict[str, str]:
    remarks = {"space": "srgb", "source": ""}
    if not rest.startswith(_TRAILER):
        if len(rest) > _SPARE_BYTES:
            raise FormatError(f"{path}: goes on after its last pixel; header and pixels do not fit, export it again")
        return remarks
    try:
        written = json.loads(rest[len(_TRAILER) :])
        remarks |= {key: str(written[key]) for key in remarks}
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise FormatError(f"{path}: litrig's line after the pixels is damaged; copy or write it again") from error
    if remarks["space"] not in get_args(Space):
        raise FormatError(f"{path}: holds values in a space {remarks['space']!r}, neither srgb nor linear")
    return remarks


def _decode(header: _Header, payload: U8) -> tuple[F32, F32 | None]:
    size = (header.height, header.width)
    if header.format == "PTM_FORMAT_RGB":
        return _decode_terms(header, payload.reshape(3, *size, TERMS).transpose(1, 2, 0, 3)), None
    if header.interleaved:
        pixels = payload.reshape(*size, TERMS + 3)
        terms, colour = pixels[..., :TERMS], pixels[..., TERMS:]
    else:
        split = size[0] * size[1] * TERMS
        terms, colour = payload[:split].reshape(*size, TERMS), payload[split:].reshape(*size, 3)
    return _decode_terms(header, terms[:, :, None]), colour[::-1].astype(np.float32) / np.float32(255)


def _decode_terms(header: _Header, codes: U8) -> F32:
    """Turn codes (H, W, C, 6), the bottom row first, into coefficients (6, H, W, C) where 1 is white."""
    planes = [step.decode(codes[::-1, ..., term]) / np.float32(255) for term, step in enumerate(header.steps)]
    return np.stack(planes)
