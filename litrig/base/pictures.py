"""Pictures in and out: files on one side, linear float32 on the other.

Row 0 is the top row. Display-encoded formats (JPEG, PNG, 8-bit and 16-bit TIFF) are sRGB; EXR, Radiance and camera
RAW are linear. A damaged file is an error: a decoder that paints what is missing grey would pass for a picture.
"""

import struct
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import OpenEXR
import rawpy
import simplejpeg
from numpy.typing import NDArray

from litrig.base.errors import FormatError, InputError
from litrig.base.files import replacing
from litrig.base.quiet import quiet_library
from litrig.base.radiometry import F32, U8, Codes, decode_srgb_codes, encode_srgb, to_u8

RAW_ENDINGS = frozenset({".dng", ".nef", ".cr2", ".cr3", ".arw", ".raf", ".orf", ".rw2", ".pef"})
JPEG_ENDINGS = frozenset({".jpg", ".jpeg"})
DISPLAY_ENDINGS = JPEG_ENDINGS | {".png", ".tif", ".tiff"}
PICTURE_ENDINGS = DISPLAY_ENDINGS | RAW_ENDINGS | {".exr", ".hdr"}

LARGEST_PIXELS = 400_000_000
_PNG_START, _PNG_END = b"\x89PNG\r\n\x1a\n", b"IEND\xaeB`\x82"
_PNG_SIZE = struct.Struct(">2L")
_PNG_SIZE_AT = 16


def is_picture(path: Path) -> bool:
    """Tell by its ending whether a file is a picture that `read_linear` knows."""
    return path.suffix.lower() in PICTURE_ENDINGS


def read_linear(path: Path) -> F32:
    """Read a picture as linear light.

    Returns
    -------
    picture : (H, W, 3) float32, linear; 0..1, or unbounded for EXR

    Raises
    ------
    InputError, FormatError
        The file is missing, of an unknown format, or damaged.
    """
    ending = path.suffix.lower()
    if ending == ".exr":
        return _read_exr_rgb(path)
    if ending == ".hdr":
        return _read_radiance(path)
    if ending in RAW_ENDINGS:
        return _read_raw(path)
    return decode_srgb_codes(read_codes(path))


def read_encoded(path: Path) -> F32:
    """Read a picture as display values 0..1: as stored for display formats, sRGB-encoded for linear ones."""
    if path.suffix.lower() in DISPLAY_ENDINGS:
        codes = read_codes(path)
        return codes.astype(np.float32) / np.float32(np.iinfo(codes.dtype).max)
    return encode_srgb(read_linear(path))


def read_coverage(path: Path) -> F32 | None:
    """Read the alpha (H, W) 0..1 of a PNG, TIFF or EXR; None if it has none.

    Raises
    ------
    InputError, FormatError
        The file is missing or damaged.
    """
    ending = path.suffix.lower()
    if ending == ".exr":
        channels = _read_exr_channels(path)
        found = channels["RGBA"][..., 3] if "RGBA" in channels else channels.get("A")
        return None if found is None else np.ascontiguousarray(found, np.float32)
    if ending not in DISPLAY_ENDINGS - JPEG_ENDINGS:
        return None
    try:
        codes = cv2.imdecode(np.frombuffer(_read_bytes(path), np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:  # empty, or larger than OpenCV reads
        codes = None
    if codes is None:
        raise FormatError(f"{path}: damaged, or too large; copy it again")
    if codes.ndim < 3 or codes.shape[2] != 4 or codes.dtype not in (np.uint8, np.uint16):
        return None
    alpha: F32 = codes[..., 3] / np.float32(255 if codes.dtype == np.uint8 else 65535)
    return alpha


def read_codes(path: Path, into: NDArray[Any] | None = None) -> Codes:
    """Read the stored integers of a JPEG, PNG or TIFF, (H, W, 3) uint8 or uint16, RGB.

    Parameters
    ----------
    into : (H·W·3,) uint8; a JPEG of that very size is decoded there, and what is returned is a view of it
    """
    content = _read_bytes(path)
    if into is not None and path.suffix.lower() in JPEG_ENDINGS:
        return decode_jpeg(content, str(path), into)
    return decode_codes(content, path.suffix.lower(), str(path))


def decode_codes(content: bytes, ending: str, source: str) -> Codes:
    """Decode a JPEG, PNG or TIFF as `read_codes` does; `source` names it in errors.

    Raises
    ------
    InputError, FormatError
        The ending is of no such format, or the data are cut short, damaged, or claim too many pixels.
    """
    if ending in JPEG_ENDINGS:
        return decode_jpeg(content, source)
    if ending not in DISPLAY_ENDINGS:
        raise InputError(f"{source}: unknown picture format; use JPEG, PNG, TIFF, EXR or a camera RAW file")
    if ending == ".png":
        _check_png(content, source)
    try:
        codes = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_COLOR | cv2.IMREAD_ANYDEPTH)
    except cv2.error:  # empty, or larger than OpenCV reads
        codes = None
    if codes is None or codes.dtype not in (np.uint8, np.uint16):
        raise FormatError(f"{source}: damaged, too large, or not a picture of 8 or 16 bits; copy or shoot it again")
    return cv2.cvtColor(codes, cv2.COLOR_BGR2RGB)  # type: ignore[return-value]  # dtype checked above


def decode_jpeg(content: bytes, source: str, into: NDArray[Any] | None = None) -> U8:
    """Decode a whole JPEG to (H, W, 3) uint8 RGB; `source` names it in errors.

    Parameters
    ----------
    into : (H·W·3,) uint8, taken for the result if the picture has that very size

    Raises
    ------
    FormatError
        The data are cut short or damaged anywhere; a partial picture is never returned.
    """
    try:
        height, width, _, _ = simplejpeg.decode_jpeg_header(content)
        _refuse_bomb(source, int(height), int(width))
        fits = into is not None and into.size == height * width * 3
        codes: U8 = simplejpeg.decode_jpeg(content, "RGB", buffer=into if fits else None)
    except ValueError as error:
        raise FormatError(f"{source}: damaged JPEG ({error}); copy or shoot it again") from error
    return codes


def write_picture(path: Path, linear: NDArray[np.floating]) -> None:
    """Write linear light (H, W, 3): sRGB-encoded to PNG, JPEG or TIFF, as it is to EXR."""
    ending = path.suffix.lower()
    if ending == ".exr":
        write_exr(path, {"RGB": np.ascontiguousarray(linear, np.float32)}, {"litrig.kind": "picture"})
    elif ending in DISPLAY_ENDINGS:
        write_codes(path, to_u8(encode_srgb(linear)))
    else:
        raise InputError(f"{path}: cannot write {ending or 'a file without ending'}; use .png, .jpg, .tif or .exr")


def write_codes(path: Path, codes: NDArray[np.integer]) -> None:
    """Write (H, W, 3) RGB, (H, W, 4) RGBA or (H, W) grey integers as they are to PNG, JPEG or TIFF."""
    if path.suffix.lower() not in DISPLAY_ENDINGS:
        raise InputError(f"{path}: cannot write {path.suffix or 'a file without ending'}; use .png, .jpg or .tif")
    order = {3: cv2.COLOR_RGB2BGR, 4: cv2.COLOR_RGBA2BGRA}
    stored = cv2.cvtColor(codes, order[codes.shape[-1]]) if codes.ndim == 3 else codes
    with replacing(path) as temporary:
        options = [cv2.IMWRITE_JPEG_QUALITY, 92] if path.suffix.lower() in JPEG_ENDINGS else []
        good, encoded = cv2.imencode(path.suffix, stored, options)
        if not good:
            raise InputError(f"{path}: this picture cannot be stored as {path.suffix}; choose another ending")
        temporary.write_bytes(encoded.tobytes())


def write_exr(path: Path, channels: Mapping[str, NDArray[np.floating]], header: Mapping[str, Any]) -> None:
    """Write a single-part OpenEXR; `header` must name `litrig.kind`, so that a reader can tell what it holds."""
    attributes = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **header}
    with replacing(path) as temporary:
        try:
            OpenEXR.File(attributes, dict(channels)).write(str(temporary))
        except RuntimeError as error:  # OpenEXR's word for a disk or folder that refuses
            raise InputError(f"{path}: cannot be written as EXR; free space, or choose another folder") from error


def _read_exr_rgb(path: Path) -> F32:
    channels = _read_exr_channels(path)
    for name in ("RGB", "RGBA"):
        if name in channels:
            return _finite(np.ascontiguousarray(channels[name][..., :3], np.float32), path)
    if "Y" in channels:
        return _finite(np.repeat(channels["Y"].astype(np.float32)[..., None], 3, axis=-1), path)
    found = ", ".join(sorted(channels)) or "none"
    raise FormatError(f"{path}: has no RGB channels (found {found}); give a picture that has R, G and B at its root")


def _read_exr_channels(path: Path) -> dict[str, NDArray[Any]]:
    _read_bytes(path, only_first=True)
    try:
        # OpenEXR says on standard output what it could not decode; it is said below, in one line.
        with quiet_library(), OpenEXR.File(str(path), header_only=True) as exr:
            (left, top), (right, bottom) = (corner.tolist() for corner in exr.header()["dataWindow"])
        _refuse_bomb(str(path), max(bottom - top + 1, 1), max(right - left + 1, 1))
        with quiet_library(), OpenEXR.File(str(path)) as exr:
            return {name: np.asarray(channel.pixels) for name, channel in exr.channels().items()}
    except (RuntimeError, ValueError, OSError, LookupError, TypeError) as error:
        raise FormatError(f"{path}: damaged EXR ({error}); copy or render it again") from error


def _read_radiance(path: Path) -> F32:
    try:
        stored = cv2.imdecode(np.frombuffer(_read_bytes(path), np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:  # empty, or larger than OpenCV reads
        stored = None
    if stored is None or stored.dtype != np.float32 or stored.ndim != 3:
        raise FormatError(f"{path}: damaged, or not a Radiance picture; copy or render it again")
    return _finite(np.asarray(cv2.cvtColor(stored, cv2.COLOR_BGR2RGB), np.float32), path)


def _finite(picture: F32, path: Path) -> F32:
    lost = int(np.count_nonzero(~np.isfinite(picture).all(axis=-1)))
    if lost:
        raise FormatError(f"{path}: {lost} pixels hold no finite number; render or develop it again")
    return picture


def _read_raw(path: Path) -> F32:
    content = _read_bytes(path, only_first=True)
    if not content:
        raise FormatError(f"{path}: empty; copy it again")
    try:
        with rawpy.imread(str(path)) as raw:
            codes = raw.postprocess(
                gamma=(1, 1),
                no_auto_bright=True,
                output_bps=16,
                user_wb=[1.0] * 4,
                output_color=rawpy.ColorSpace.raw,
                user_flip=0,
                # Else a picture whose brightest pixel nears white is stretched to it, each by its own factor.
                adjust_maximum_thr=0.0,
            )
    except rawpy.LibRawError as error:
        raise FormatError(f"{path}: damaged RAW file ({error}); copy it again") from error
    return codes.astype(np.float32) / np.float32(65535)


def _read_bytes(path: Path, *, only_first: bool = False) -> bytes:
    try:
        if only_first:
            with path.open("rb") as file:
                return file.read(1)
        return path.read_bytes()
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file; check the path") from error
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path and its permissions") from error


def _check_png(content: bytes, source: str) -> None:
    if _PNG_END not in content[-32:] or len(content) < _PNG_SIZE_AT + _PNG_SIZE.size:
        raise FormatError(f"{source}: PNG cut short after {len(content)} bytes; copy or shoot it again")
    if not content.startswith(_PNG_START):
        raise FormatError(f"{source}: not a PNG; give the file the ending of what it is")
    width, height = _PNG_SIZE.unpack_from(content, _PNG_SIZE_AT)
    _refuse_bomb(source, height, width)
    place = len(_PNG_START)
    while place < len(content):
        # Length, type, content, and the CRC-32 of type and content. libpng would say on its own what does not fit.
        end = place + 12 + int.from_bytes(content[place : place + 4], "big")
        if end > len(content) or zlib.crc32(content[place + 4 : end - 4]) != int.from_bytes(
            content[end - 4 : end], "big"
        ):
            raise FormatError(f"{source}: damaged PNG (at byte {place}); copy or shoot it again")
        if content[place + 4 : place + 8] == b"IEND":
            break
        place = end


def _refuse_bomb(source: str, height: int, width: int) -> None:
    if height * width > LARGEST_PIXELS:
        raise FormatError(f"{source}: claims {width} × {height} pixels, more than {LARGEST_PIXELS:,}; refused")
