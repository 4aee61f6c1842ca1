"""`.ptm` files: PTM_FORMAT_RGB and PTM_FORMAT_LRGB of the HP format 1.1 and 1.2, and their packed kinds when read.

A header in ASCII (version, format, width, height, six scales, six biases), then bytes: value = (code − bias)·scale in
units where 255 is white, coefficients in the order u², v², uv, u, v, 1, rows from the bottom up. RGB holds three blocks
of six bytes a pixel; LRGB holds a block of six bytes a pixel and one of three for the colour, or nine bytes a pixel in
version 1.1. Colour times luminance is divided by 255.

The header has no place for a comment that all readers skip. Readers stop after the last byte that they expect, so what
litrig knows besides (the space of the values, the digest of the frames, the version that wrote it) follows there as one
line of JSON. A file without it holds display values, as the field has it, and names no source.
"""

import json
import re
from pathlib import Path
from typing import Any, NamedTuple, cast, get_args

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import FormatError, InputError
from litrig.base.files import write_atomically
from litrig.base.version import litrig_version
from processing.ptm.basis import PTM
from processing.ptm.files.balance import balance
from processing.ptm.files.ptm_jpeg import PLAIN_KIND, unpack
from processing.ptm.files.quantise import ScaleBias, scale_bias
from processing.ptm.model import Ptm, Space

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


def write_ptm(path: Path, ptm: Ptm) -> None:
    """Write a PTM_1.2 file, RGB or LRGB as the PTM is; it is whole or not there.

    Raises
    ------
    InputError
        A coefficient is not finite, or the path cannot be written.
    """
    if not np.all(np.isfinite(ptm.coefficients)):
        raise InputError(f"{path}: coefficients that are not numbers cannot be written; fit again")
    luminance, colour = (ptm.coefficients, None) if ptm.colour is None else balance(ptm.coefficients, ptm.colour)
    steps = tuple(scale_bias(float(term.min()) * 255, float(term.max()) * 255) for term in luminance)
    # uint8 (H, W, C, 6): the six codes of a pixel side by side, the bottom row first.
    codes = np.stack(
        [step.encode(term.astype(np.float64) * 255) for step, term in zip(steps, luminance, strict=True)], axis=-1
    )[::-1]
    blocks = [np.ascontiguousarray(codes[:, :, channel]).tobytes() for channel in range(codes.shape[2])]
    if colour is not None:
        blocks.append(np.rint(colour[::-1] * 255).astype(np.uint8).tobytes())
    write_atomically(path, b"".join([_format_header(ptm, steps), *blocks, _format_trailer(ptm)]))


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
    return Ptm(coefficients, colour, cast(Space, remarks["space"]), remarks["source"])


def describe_ptm(path: Path) -> dict[str, Any]:
    """Say what a `.ptm` holds, from its header unless it is packed; coefficients as far as their codes reach."""
    header, remarks, _ = _read(path)
    ends = [[step.scale * (code - step.bias) / 255 for code in (0, 255)] for step in header.steps]
    return {
        "width": header.width,
        "height": header.height,
        "basis": str(PTM),
        "colour": "rgb" if header.format == "PTM_FORMAT_RGB" else "lrgb",
        "space": remarks["space"],
        "coefficients": {name: (min(pair), max(pair)) for name, pair in zip(PTM.names, ends, strict=True)},
        "source": remarks["source"],
    }


def _read(path: Path) -> tuple[_Header, dict[str, str], U8 | None]:
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
            return header, _parse_trailer(path, file.read(_HEADER_BYTES)), payload
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path") from error


def _format_header(ptm: Ptm, steps: tuple[ScaleBias, ...]) -> bytes:
    height, width = ptm.coefficients.shape[1:3]
    lines = [
        "PTM_1.2",
        "PTM_FORMAT_RGB" if ptm.colour is None else "PTM_FORMAT_LRGB",
        str(width),
        str(height),
        " ".join(f"{step.scale:.8g}" for step in steps),
        " ".join(str(step.bias) for step in steps),
    ]
    return ("\n".join(lines) + "\n").encode("ascii")


def _format_trailer(ptm: Ptm) -> bytes:
    remarks = {"space": ptm.space, "source": ptm.source, "litrig": litrig_version()}
    return _TRAILER + json.dumps(remarks).encode("ascii") + b"\n"


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
