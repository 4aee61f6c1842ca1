"""`.rti` files: hemispherical harmonics as hshfitter and relight write them, HSH 1.2.

Lines of text that end in CR LF: comments, of which the first is `#HSH1.2`; `3` for HSH; width, height and 3 channels;
terms, 2 for channels of their own, 1 byte a code. Then float32, little-endian: a scale and a bias for each term. Then
bytes, row 0 on top: the codes of a pixel's red, its green, its blue. Value = code / 255 · scale + bias, where 1 is
white. litrig's remarks follow. Lines that end in LF alone are read too; some readers count two bytes for each.
"""

import re
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import FormatError, InputError
from litrig.base.files import replacing
from litrig.base.progress import Progress, Report, silent
from processing.ptm.basis import Basis
from processing.ptm.files.coder import Coder, checked, coder_for, multiplied_out, worked_out
from processing.ptm.files.remarks import LARGEST_BYTES, Remarks, format_remarks, parse_remarks
from processing.ptm.model import Material, Ptm

F32 = NDArray[np.float32]

BASES = (Basis("hsh", 4), Basis("hsh", 9))
LARGEST_PIXELS = 400_000_000
_HEADER_BYTES = 4096
_LARGEST_VALUE = 1e9
# Some writers leave a byte after the pixels.
_SPARE_BYTES = 2
_HEADER = re.compile(
    rb"#HSH[^\n]*\n(?:#[^\n]*\n)*[ \t]*(\d{1,3})[ \t]*\r?\n"
    rb"[ \t]*(\d{1,9})[ \t]+(\d{1,9})[ \t]+(\d{1,3})[ \t]*\r?\n"
    rb"[ \t]*(\d{1,3})[ \t]+(\d{1,3})[ \t]+(\d{1,3})[ \t]*\r?\n"
)
_HSH, _CHANNELS, _OF_THEIR_OWN, _BYTES_A_CODE = 3, 3, 2, 1


class _Header(NamedTuple):
    width: int
    height: int
    scales: F32
    biases: F32
    length: int
    remarks: Remarks

    @property
    def basis(self) -> Basis:
        return Basis("hsh", len(self.scales))

    @property
    def payload(self) -> int:
        return self.width * self.height * _CHANNELS * len(self.scales)


def write_rti(path: Path, material: Material, coder: Coder | None = None, report: Report = silent) -> None:
    """Write an `.rti`; it is whole or not there. Colour and luminance that are apart are multiplied out.

    Parameters
    ----------
    coder : as `rti_coder` chooses it, if that has been done

    Raises
    ------
    InputError
        The basis is not HSH of 4 or 9 terms, a coefficient is not finite, or the path cannot be written.
    """
    coder = coder or rti_coder(path, material)
    height, width = material.shape
    steps = coder.roundings[0].steps
    with replacing(path) as temporary, temporary.open("wb") as file:
        file.write(f"#HSH1.2\r\n{_HSH}\r\n{width} {height} {_CHANNELS}\r\n".encode("ascii"))
        file.write(f"{len(steps)} {_OF_THEIR_OWN} {_BYTES_A_CODE}\r\n".encode("ascii"))
        file.write(np.array([255 * step.scale for step in steps], "<f4").tobytes())
        file.write(np.array([-step.scale * step.bias for step in steps], "<f4").tobytes())
        for rows, codes in worked_out(material, lambda rows: coder.encode(checked(path, material.strip(rows)))):
            file.write(codes.coefficients.transpose(1, 2, 3, 0).tobytes())
            report(Progress("fitting", rows.stop, height))
        file.write(format_remarks(material))


def rti_coder(path: Path, material: Material) -> Coder:
    """Choose the codes of an `.rti`.

    Raises
    ------
    InputError
        The basis is not HSH of 4 or 9 terms, or a coefficient is not finite.
    """
    if material.basis not in BASES:
        raise InputError(
            f"{path}: .rti readers know HSH of 4 and 9 terms, not {material.basis}; write a .ptm.exr, or fit again"
        )
    return coder_for(path, material, seen=multiplied_out, same_for_channels=True)


def read_rti(path: Path) -> Ptm:
    """Read an `.rti` of HSH.

    Raises
    ------
    InputError, FormatError
        The file is missing, is no HSH, or is shorter or longer than its header says. Sizes are checked before memory is
        taken.
    """
    header = _read_header(path)
    terms = len(header.scales)
    with path.open("rb") as file:
        file.seek(header.length)
        codes = np.frombuffer(file.read(header.payload), np.uint8)
    if len(codes) != header.payload:
        raise FormatError(f"{path}: was cut short while it was read; copy it again")
    codes = codes.reshape(header.height, header.width, _CHANNELS, terms)
    coefficients = np.zeros((terms, header.height, header.width, _CHANNELS), np.float32)
    for term in range(terms):
        np.multiply(codes[..., term], header.scales[term] / np.float32(255), out=coefficients[term])
        coefficients[term] += header.biases[term]
    return Ptm(coefficients, None, header.remarks.space, header.remarks.source, header.basis)


def describe_rti(path: Path) -> dict[str, Any]:
    """Say what an `.rti` holds, from its header alone; coefficients as far as its codes reach."""
    header = _read_header(path)
    ends = zip(header.biases.tolist(), (header.biases + header.scales).tolist(), strict=True)
    return {
        "width": header.width,
        "height": header.height,
        "basis": str(header.basis),
        "colour": "rgb",
        "space": header.remarks.space,
        "coefficients": dict(zip(header.basis.names, ends, strict=True)),
        "source": header.remarks.source,
    }


def _read_header(path: Path) -> _Header:
    try:
        with path.open("rb") as file:
            start = file.read(_HEADER_BYTES)
            width, height, terms, text_bytes = _parse_text(path, start)
            length = text_bytes + 8 * terms
            payload = width * height * _CHANNELS * terms
            rest = path.stat().st_size - length
            if rest < payload:
                raise FormatError(
                    f"{path}: {width} × {height} pixels of {terms} terms want {payload:,} bytes, the file has "
                    f"{max(0, rest):,}; it was cut short, copy it again"
                )
            scales, biases = np.frombuffer(start[text_bytes:length], "<f4").reshape(2, terms).astype(np.float32)
            file.seek(length + payload)
            remarks = parse_remarks(path, file.read(LARGEST_BYTES), _SPARE_BYTES)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path") from error
    if not np.all(np.abs([scales, biases]) <= _LARGEST_VALUE):
        raise FormatError(f"{path}: scale or bias is out of all range, or no number; export it again")
    return _Header(width, height, scales, biases, length, remarks)


def _parse_text(path: Path, start: bytes) -> tuple[int, int, int, int]:
    """Return width, height, terms, and where the text ends."""
    found = _HEADER.match(start)
    if found is None:
        raise FormatError(f"{path}: not an .rti of HSH 1.2, or its header is damaged; export it again")
    kind, width, height, channels, terms, apart, code_bytes = (int(word) for word in found.groups())
    if kind != _HSH:
        raise FormatError(f"{path}: is an .rti of type {kind}, not of HSH (3); export it as HSH, or as .ptm")
    if terms not in [basis.terms for basis in BASES]:
        raise FormatError(f"{path}: is an HSH of {terms} terms; 4 or 9 are read, export it anew")
    if (channels, apart, code_bytes) != (_CHANNELS, _OF_THEIR_OWN, _BYTES_A_CODE):
        raise FormatError(
            f"{path}: has {channels} channels of type {apart}, {code_bytes} bytes a code; three of their own (2) with "
            "1 byte are read, export it so"
        )
    if not 0 < width * height <= LARGEST_PIXELS:
        raise FormatError(f"{path}: claims {width} × {height} pixels; 1 to {LARGEST_PIXELS:,} are read")
    if found.end() + 8 * terms > len(start):
        raise FormatError(f"{path}: ends in its header; it was cut short, copy it again")
    return width, height, terms, found.end()
