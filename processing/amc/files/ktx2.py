"""AMC files: `X.amc.ktx2`, a KTX 2.0 volume with its meaning in the key `litrig.amc`.

The volume has columns from left to right, rows from top to bottom (row 0 at n_y = +1) and slices along k. Colours are
sRGB codes or linear half floats, straight, and reach past the disc of normals; alpha is validity.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import zstandard
from numpy.typing import NDArray

from litrig.base.errors import FormatError, InputError
from litrig.base.files import write_atomically
from litrig.base.radiometry import decode_srgb, encode_srgb, to_u8
from litrig.base.table_normals import TableNormal
from litrig.base.version import litrig_version
from processing.amc.files.ktx2_check import read_container
from processing.amc.files.ktx2_container import Container, Scheme, VkFormat, assemble
from processing.amc.files.meaning import Meaning, read_meaning
from processing.amc.mips import MipLevel, first_level, mip_chain
from processing.amc.model import Amc, Invariance, TangentAngle

KEY = "litrig.amc"
_ZSTD_LEVEL = 9
_ZSTD_WINDOW = 1 << 27
_HALF_A_CODE_UP = 0.0045
"""By so much may linear light exceed 1 before its sRGB code would no longer round to 255."""
_HALF_A_CODE_DOWN = 0.5 / 255 / 12.92
_DIM = 0.02
_LARGEST_HALF = float(np.finfo(np.float16).max)


@dataclass(frozen=True)
class AmcHeader:
    """What a file says of itself before its texels are read."""

    size: int
    depth: int
    levels: int
    half_float: bool
    compressed: bool
    invariance: Invariance
    table_normal: TableNormal
    slice_angles_deg: tuple[float, ...]
    source: str
    tangent_angle: TangentAngle
    written_by: str


def write_amc(
    path: Path, amc: Amc, *, half_float: bool | None = None, mip_levels: bool = True, compress: bool = True
) -> None:
    """Write an AMC; the file is whole or not there.

    Parameters
    ----------
    half_float : store linear half floats instead of 8-bit sRGB codes; None does so if a colour exceeds 0..1, or if all
        are dim
    mip_levels : store the smaller levels too, for renderers that do not make their own
    compress : pack every level by Zstandard

    Raises
    ------
    InputError
        The arrays do not make an AMC, a colour does not fit the asked form, or the file cannot be written.
    """
    _check(path, amc)
    if half_float is None:
        half_float = not _fits_codes(amc)
    elif not half_float and not _fits_codes(amc):
        raise InputError(f"{path}: colours reach {_extremes(amc)}, outside 0..1 of 8-bit codes; store half floats")
    levels = mip_chain(amc) if mip_levels else [first_level(amc)]
    packed = [_pack(level, half_float, compress) for level in levels]
    vk_format = VkFormat.R16G16B16A16_SFLOAT if half_float else VkFormat.R8G8B8A8_SRGB
    depth, size = amc.slices.shape[:2]
    scheme = Scheme.ZSTANDARD if compress else Scheme.NONE
    write_atomically(path, *assemble(vk_format, size, depth, scheme, _keys(amc), packed))


def read_amc(path: Path) -> Amc:
    """Read an AMC without its smaller levels.

    Raises
    ------
    InputError, FormatError
        As `read_header`, or level 0 is damaged.
    """
    return read_levels(path, only_first=True)[0]


def read_levels(path: Path, *, only_first: bool = False) -> tuple[Amc, list[MipLevel]]:
    """Read an AMC and every mip level that its file has, the full one first."""
    container = read_container(path)
    meaning = _meaning(path, container)
    count = 1 if only_first else len(container.places)
    levels = [_read_level(path, container, level) for level in range(count)]
    return meaning.table(levels[0].colours, levels[0].coverage > 0.5), levels


def read_header(path: Path) -> AmcHeader:
    """Read what a file says of itself; its texels are not touched.

    Raises
    ------
    InputError
        The file cannot be read.
    FormatError
        It is no KTX 2.0 file, holds no AMC, or contradicts itself or its own length.
    """
    container = read_container(path)
    meaning = _meaning(path, container)
    return AmcHeader(
        size=container.size,
        depth=container.depth,
        levels=len(container.places),
        half_float=container.vk_format is VkFormat.R16G16B16A16_SFLOAT,
        compressed=container.scheme is Scheme.ZSTANDARD,
        invariance=meaning.invariance,
        table_normal=meaning.table_normal,
        slice_angles_deg=meaning.slice_angles_deg,
        source=meaning.source,
        tangent_angle=meaning.tangent_angle,
        written_by=meaning.litrig,
    )


def _check(path: Path, amc: Amc) -> None:
    shape = amc.slices.shape
    if len(shape) != 4 or shape[1] != shape[2] or shape[3] != 3 or 0 in shape or amc.valid.shape != shape[:3]:
        raise InputError(
            f"{path}: slices {shape} with validity {amc.valid.shape} are no AMC; give (D, S, S, 3) and (D, S, S)"
        )
    if amc.invariance == "isotropic" and shape[0] != 1:
        raise InputError(f"{path}: an isotropic AMC has one slice, not {shape[0]}; average them first")
    if not -_LARGEST_HALF <= amc.slices.min() <= amc.slices.max() <= _LARGEST_HALF:
        raise InputError(f"{path}: colours reach {_extremes(amc)}; half floats end at {_LARGEST_HALF:g}. Scale them")


def _extremes(amc: Amc) -> str:
    return f"{float(amc.slices.min()):g}..{float(amc.slices.max()):g}"


def _fits_codes(amc: Amc) -> bool:
    """Tell whether codes of 8 bits hold the colours: none is beyond them, and some are well above the first."""
    if 0 < amc.slices.max() < _DIM:
        return False
    return bool(amc.slices.min() >= -_HALF_A_CODE_DOWN and amc.slices.max() <= 1 + _HALF_A_CODE_UP)


def _keys(amc: Amc) -> dict[str, bytes]:
    texts = {"KTXorientation": "rdi", "KTXwriter": f"litrig {litrig_version()}", KEY: Meaning.of(amc).model_dump_json()}
    return {key: text.encode() + b"\0" for key, text in texts.items()}


def _meaning(path: Path, container: Container) -> Meaning:
    stored = container.keys.get(KEY)
    if stored is None:
        raise FormatError(f"{path}: has no key {KEY}, so that R is not known; give a file that litrig amc build wrote")
    return read_meaning(stored.removesuffix(b"\0"), container.depth, f"{path}: {KEY}")


def _pack(level: MipLevel, half_float: bool, compress: bool) -> bytes:
    """Encode and pack slice by slice, for the floats of a whole level are four times as large as its codes."""
    if not compress:
        return b"".join(_encoded(level, half_float))
    texel_bytes = 8 if half_float else 4
    packer = zstandard.ZstdCompressor(_ZSTD_LEVEL).compressobj(size=level.coverage.size * texel_bytes)
    return b"".join([*(packer.compress(plain) for plain in _encoded(level, half_float)), packer.flush()])


def _encoded(level: MipLevel, half_float: bool) -> Iterator[bytes]:
    """Yield the texels of one slice after the other."""
    for colours, coverage in zip(level.colours, level.coverage, strict=True):
        stored = np.zeros((*coverage.shape, 4), "<f2" if half_float else np.uint8)
        if half_float:
            stored[..., :3], stored[..., 3] = colours, coverage
        else:
            stored[..., :3], stored[..., 3] = to_u8(encode_srgb(colours)), to_u8(coverage)
        yield stored.tobytes()


def _read_level(path: Path, container: Container, level: int) -> MipLevel:
    place = container.places[level]
    with path.open("rb") as file:
        file.seek(place.offset)
        stored = file.read(place.packed_bytes)
    plain = stored if container.scheme is Scheme.NONE else _unpack(path, stored, level, place.unpacked_bytes)
    return _decode(path, plain, container, level)


def _unpack(path: Path, stored: bytes, level: int, expected: int) -> bytes:
    """Unpack one level, and stop as soon as it yields more than it should."""
    try:
        reader = zstandard.ZstdDecompressor(max_window_size=_ZSTD_WINDOW).stream_reader(stored)
        plain: bytes = reader.read(expected + 1)
    except zstandard.ZstdError as error:
        raise FormatError(f"{path}: level {level} is damaged ({error}); build or copy it again") from error
    if len(plain) != expected:
        found = "more" if len(plain) > expected else f"{len(plain):,}"
        raise FormatError(f"{path}: level {level} unpacks to {found}, not {expected:,} bytes; build or copy it again")
    return plain


def _decode(path: Path, plain: bytes, container: Container, level: int) -> MipLevel:
    shape = (*container.shape(level), 4)
    if container.vk_format is VkFormat.R16G16B16A16_SFLOAT:
        halves = np.frombuffer(plain, "<f2").reshape(shape).astype(np.float32)
        if not np.all(np.isfinite(halves)):
            raise FormatError(f"{path}: level {level} holds values that are no numbers; build or copy it again")
        return MipLevel(np.ascontiguousarray(halves[..., :3]), np.ascontiguousarray(halves[..., 3]))
    codes: NDArray[np.uint8] = np.frombuffer(plain, np.uint8).reshape(shape)
    light = decode_srgb(np.arange(256, dtype=np.float32) / 255)
    return MipLevel(light[codes[..., :3]], codes[..., 3].astype(np.float32) / np.float32(255))
