"""`.ptm` files: PTM_FORMAT_RGB and PTM_FORMAT_LRGB of the HP format 1.1 and 1.2, and their packed kinds when read.

A header in ASCII (version, format, width, height, six scales, six biases), then bytes: value = (code − bias)·scale in
units where 255 is white, coefficients in the order u², v², uv, u, v, 1, rows from the bottom up. RGB holds three blocks
of six bytes a pixel; LRGB holds a block of six bytes a pixel and one of three for the colour, or nine bytes a pixel in
version 1.1. Colour times luminance is divided by 255.

The header has no place for a comment that all readers skip. Readers stop after the last byte that they expect, so what
litrig knows besides (the space of the values, the digest of the frames, the version that wrote it) follows there as one
line of JSON. A file without it holds display values, as the field has it, and names no source.
"""

import os
import re
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import FormatError, InputError
from litrig.base.files import replacing
from litrig.base.progress import Progress, Report, silent
from processing.ptm.basis import PTM
from processing.ptm.files.coder import Coder, checked, coder_for, six_terms, worked_out
from processing.ptm.files.ptm_jpeg import PLAIN_KIND, unpack
from processing.ptm.files.quantise import ScaleBias
from processing.ptm.files.remarks import LARGEST_BYTES, Remarks, format_remarks, parse_remarks
from processing.ptm.model import Colour, Material, Ptm, Strip

F32 = NDArray[np.float32]
U8 = NDArray[np.uint8]

TERMS = PTM.terms
LARGEST_PIXELS = 400_000_000
_HEADER_BYTES = 4096
_NUMBER, _WHOLE = rb"\s+([-+]?[\d.]+(?:[eE][-+]?\d+)?)", rb"\s+([-+]?\d+)(?:\.0*)?"
_HEADER = re.compile(
    rb"\s*PTM_1\.([12])\s+(PTM_FORMAT_\w+)\s+(\d{1,9})\s+(\d{1,9})" + _NUMBER * TERMS + _WHOLE * TERMS + rb"[ \t]*\r?\n"
)
_LARGEST_SCALE, _LARGEST_BIAS = 1e9, 1_000_000
# PTMfitter leaves a byte after the pixels.
_SPARE_BYTES = 2
_FORMATS: dict[Colour, str] = {"rgb": "PTM_FORMAT_RGB", "lrgb": "PTM_FORMAT_LRGB"}
_BYTES_PER_PIXEL = {"PTM_FORMAT_RGB": 3 * TERMS, "PTM_FORMAT_LRGB": TERMS + 3}


class _Header(NamedTuple):
    interleaved: bool
    packed: str
    format: str
    width: int
    height: int
    steps: tuple[ScaleBias, ...]
    length: int

    @property
    def payload(self) -> int:
        return self.width * self.height * _BYTES_PER_PIXEL[self.format]


def write_ptm(path: Path, material: Material, coder: Coder | None = None, report: Report = silent) -> None:
    """Write a PTM_1.2 file, RGB or LRGB as the material is, strip by strip; it is whole or not there.

    Parameters
    ----------
    coder : as `ptm_coder` chooses it, if that has been done

    Raises
    ------
    InputError
        The basis is no polynomial, a coefficient is not finite, or the path cannot be written.
    """
    coder = coder or ptm_coder(path, material)
    height, width = material.shape
    header = _format_header(material, coder)

    def write(file: int, rows: slice) -> None:
        offset = len(header)
        for block in _blocks(coder, checked(path, material.strip(rows))):
            stride = width * block.shape[2]
            _write_all(file, block[::-1].tobytes(), offset + (height - rows.stop) * stride)
            offset += height * stride

    with replacing(path) as temporary, temporary.open("wb") as out:
        _write_all(out.fileno(), header, 0)
        for rows, _ in worked_out(material, partial(write, out.fileno())):
            report(Progress("fitting", rows.stop, height))
        payload = height * width * _BYTES_PER_PIXEL[_FORMATS[material.kind]]
        _write_all(out.fileno(), format_remarks(material), len(header) + payload)


def ptm_coder(path: Path, material: Material) -> Coder:
    """Choose the codes of a `.ptm`.

    Raises
    ------
    InputError
        The basis is no polynomial, or a coefficient is not finite.
    """
    if material.basis.kind != "ptm":
        raise InputError(f"{path}: a .ptm holds a {PTM}, not {material.basis}; write .rti or .ptm.exr")
    return coder_for(path, material, seen=six_terms, same_for_channels=True)


def read_ptm(path: Path) -> Ptm:
    """Read an RGB or LRGB `.ptm` of version 1.1 or 1.2, plain or packed as JPEG.

    Raises
    ------
    InputError, FormatError
        The file is missing, is no PTM, holds a kind that is not read (LUM, JPEG-LS, look-up tables), or is shorter or
        longer than its header says. Sizes are checked before memory is taken.
    """
    header, remarks, payload = _read(path)
    if payload is None:
        with path.open("rb") as file:
            file.seek(header.length)
            payload = np.frombuffer(file.read(header.payload), np.uint8)
    coefficients, colour = _decode(header, payload)
    return Ptm(coefficients, colour, remarks.space, remarks.source)


def describe_ptm(path: Path) -> dict[str, Any]:
    """Say what a `.ptm` holds, from its header unless it is packed; coefficients as far as their codes reach."""
    header, remarks, _ = _read(path)
    ends = [[step.scale * (code - step.bias) / 255 for code in (0, 255)] for step in header.steps]
    return {
        "width": header.width,
        "height": header.height,
        "basis": str(PTM),
        "colour": "rgb" if header.format == "PTM_FORMAT_RGB" else "lrgb",
        "space": remarks.space,
        "coefficients": {name: (min(pair), max(pair)) for name, pair in zip(PTM.names, ends, strict=True)},
        "source": remarks.source,
    }


def _read(path: Path) -> tuple[_Header, Remarks, U8 | None]:
    """Read and check all but the pixels; of a packed file those too, for only they tell where it ends."""
    try:
        with path.open("rb") as file:
            header = _parse_header(path, file.read(_HEADER_BYTES))
            file.seek(header.length)
            payload = None
            if header.packed:
                payload = unpack(path, file, header.packed, (header.height, header.width))
            else:
                rest = path.stat().st_size - header.length
                if rest < header.payload:
                    raise FormatError(
                        f"{path}: {header.width} × {header.height} pixels want {header.payload:,} bytes, the file has "
                        f"{rest:,}; it was cut short, copy it again"
                    )
                file.seek(header.payload, 1)
            return header, parse_remarks(path, file.read(LARGEST_BYTES), _SPARE_BYTES), payload
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path") from error


def _format_header(material: Material, coder: Coder) -> bytes:
    height, width = material.shape
    steps = coder.roundings[0].steps
    lines = [
        "PTM_1.2",
        _FORMATS[material.kind],
        str(width),
        str(height),
        " ".join(f"{step.scale * 255:.8g}" for step in steps),
        " ".join(str(step.bias) for step in steps),
    ]
    return ("\n".join(lines) + "\n").encode("ascii")


def _blocks(coder: Coder, strip: Strip) -> list[U8]:
    """Return the blocks of the file for some rows, (h, W, bytes) each: six codes a pixel, or three of colour."""
    codes = coder.encode(strip)
    coefficients = [np.moveaxis(plane, 0, -1) for plane in np.moveaxis(codes.coefficients, -1, 0)]
    return coefficients if codes.colour is None else [*coefficients, codes.colour]


def _write_all(file: int, content: bytes, offset: int) -> None:
    """Write at a place; a full disk may take part of it and say nothing."""
    while content:
        written = os.pwrite(file, content, offset)
        content, offset = content[written:], offset + written


def _parse_header(path: Path, start: bytes) -> _Header:
    found = _HEADER.match(start)
    if found is None:
        raise FormatError(f"{path}: not a PTM file of version 1.1 or 1.2, or its header is damaged; export it again")
    packed = found[2].decode() if found[2].decode() in PLAIN_KIND else ""
    kind = PLAIN_KIND.get(packed, found[2].decode())
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
    interleaved = kind == "PTM_FORMAT_LRGB" and (found[1] == b"1" or bool(packed))
    return _Header(interleaved, packed, kind, width, height, steps, found.end())


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
