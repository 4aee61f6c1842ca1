"""Multi-part OpenEXR files that hold materials: heads that are believed only when checked, then pixels."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np
import OpenEXR
from numpy.typing import NDArray

from litrig.base.errors import FormatError, InputError
from litrig.base.files import replacing
from litrig.base.quiet import quiet_library
from processing.limits import FREE_BYTES, LARGEST_RATIO

F32 = NDArray[np.float32]
Size = tuple[int, int]


@dataclass(frozen=True)
class Head:
    """What one part says of itself. A window is width and height from the origin; any other is of no size."""

    name: str
    kind: str
    meaning: str
    is_plain: bool
    channels: list[str]
    data: Size
    display: Size

    @classmethod
    def of(cls, header: Mapping[str, Any], key: str) -> Self:
        """Pick what matters from a part's header; `key` names the attribute with the meaning."""
        channels = header["channels"]
        return cls(
            name=_text(header, "name"),
            kind=_text(header, "litrig.kind"),
            meaning=_text(header, key),
            is_plain=header["type"] == OpenEXR.scanlineimage
            and all(channel.xSampling == channel.ySampling == 1 for channel in channels),
            channels=sorted(channel.name for channel in channels),
            data=_window(header["dataWindow"]),
            display=_window(header["displayWindow"]),
        )


def read_heads(path: Path, key: str) -> list[Head]:
    """Read the heads of all parts, and no pixels.

    Raises
    ------
    InputError, FormatError
        The file cannot be read, or is no EXR.
    """
    try:
        with path.open("rb"):
            pass
        with quiet_library(), OpenEXR.File(str(path), header_only=True) as exr:
            return [Head.of(part.header, key) for part in exr.parts]
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file; check the path") from error
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path") from error
    except (RuntimeError, ValueError, LookupError, TypeError) as error:
        raise FormatError(f"{path}: no EXR, or a damaged one ({error}); give one that litrig wrote") from error


def check_part(path: Path, head: Head, channels: list[str], data: Size, display: Size, mend: str) -> None:
    """Refuse a part that is not as its kind wants it; `mend` is the next step."""
    require(path, head.is_plain, f"part {head.name} is no plain picture; {mend}")
    require(path, head.channels == channels, f"part {head.name} has channels {listed(head.channels)}; {mend}")
    require(
        path,
        head.data == data and head.display == display,
        f"part {head.name} is not {data[0]} × {data[1]} in a display window of {display[0]} × {display[1]}; {mend}",
    )


def check_budget(path: Path, unpacked: int, most: int, *, free: int = FREE_BYTES, ratio: int = LARGEST_RATIO) -> None:
    """Refuse a file that unpacks to more than `most` bytes, or to more than `free` and `ratio` times its length."""
    packed = path.stat().st_size
    require(path, unpacked <= most, f"unpacks to {unpacked:,} bytes, more than {most:,}; refused")
    require(
        path,
        unpacked <= max(free, packed * ratio),
        f"unpacks from {packed:,} to {unpacked:,} bytes, more than {ratio} to 1; refused",
    )


def read_parts(path: Path, shapes: Mapping[str, tuple[int, ...]], mend: str) -> dict[str, dict[str, F32]]:
    """Read all pixels as float32, by part and channel, and see that they are finite and what the heads promised.

    Raises
    ------
    FormatError
        The file is damaged, or its pixels are not as `shapes` has it for each part.
    """
    try:
        # OpenEXR says on standard output what it could not decode; it is said below, in one line.
        with quiet_library(), OpenEXR.File(str(path)) as exr:
            found = {
                part.name(): {name: np.asarray(channel.pixels) for name, channel in part.channels.items()}
                for part in exr.parts
            }
    except (RuntimeError, ValueError, OSError, IndexError) as error:
        raise FormatError(f"{path}: damaged EXR ({error}); {mend}") from error
    # What OpenEXR cannot decode it leaves out: the part's pixels, or the part.
    missing = [name for name in shapes if not found.get(name)]
    if missing:
        raise FormatError(f"{path}: damaged EXR (part {missing[0]} cannot be decoded); {mend}")
    return {name: _floats(path, name, found[name], shape, mend) for name, shape in shapes.items()}


def write_parts(path: Path, parts: list[OpenEXR.Part]) -> None:
    """Write all parts; the file is whole or not there."""
    with replacing(path) as temporary:
        try:
            OpenEXR.File(parts).write(str(temporary))
        except RuntimeError as error:  # OpenEXR's word for a disk or folder that refuses
            raise InputError(f"{path}: cannot be written as EXR; free space, or choose another folder") from error


def require(path: Path, holds: bool, otherwise: str) -> None:
    """Refuse a file for the reason given."""
    if not holds:
        raise FormatError(f"{path}: {otherwise}")


def listed(words: list[str]) -> str:
    """Name a few, and say how many more there are."""
    return ", ".join(words[:8]) + (f" and {len(words) - 8} more" if len(words) > 8 else "")


def _text(header: Mapping[str, Any], name: str) -> str:
    """Return a text attribute; what is no UTF-8, and so comes as bytes, is no text that litrig has written."""
    value = header.get(name)
    return value if isinstance(value, str) else ""


def _window(corners: Any) -> Size:
    (left, top), (right, bottom) = corners
    return (int(right) + 1, int(bottom) + 1) if int(left) == int(top) == 0 else (0, 0)


def _floats(
    path: Path, part: str, channels: dict[str, NDArray[Any]], shape: tuple[int, ...], mend: str
) -> dict[str, F32]:
    floats = {}
    for channel, values in channels.items():
        if values.dtype not in (np.float16, np.float32) or values.shape != shape:
            raise FormatError(f"{path}: part {part} holds {values.dtype} {values.shape}, not floats {shape}; {mend}")
        if not np.all(np.isfinite(values)):
            raise FormatError(f"{path}: part {part} holds values that are no numbers; {mend}")
        floats[channel] = np.ascontiguousarray(values, np.float32)
    return floats
