"""The channels of an OpenEXR of many layers, in one part or in many, all brought to its display window."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
from numpy.typing import NDArray

from litrig.base.errors import FormatError, InputError
from litrig.base.quiet import quiet_library
from processing.exr_parts import check_budget, listed, require
from processing.limits import FLAT_RATIO

LARGEST_PIXELS = 100_000_000
MEND = "render it again"
_LARGEST_BYTES = 16 << 30
_PLAIN = (OpenEXR.scanlineimage, OpenEXR.tiledimage)
_PICTURE_PARTS = frozenset({"", "rgba", "rgb", "beauty", "combined", "main", "default", "root", "c"})
Window = tuple[int, int, int, int]


@dataclass(frozen=True)
class Stored:
    """What a file holds.

    Attributes
    ----------
    planes : (H, W) each, by the channel's whole name, `layer.channel`; what the file has no pixels for is 0
    header : of the first part
    cropped : the file holds less than the picture it is of, or more
    """

    planes: Mapping[str, NDArray[Any]]
    header: Mapping[str, Any]
    cropped: bool

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width of the picture."""
        height, width = next(iter(self.planes.values())).shape
        return height, width


def read_channels(path: Path) -> Stored:
    """Read all channels, after the heads were found to be true to the file's size.

    Raises
    ------
    InputError
        The file cannot be read.
    FormatError
        It is no EXR, is damaged, or its channels are not a value a pixel.
    """
    try:
        with path.open("rb"):
            pass
        with quiet_library(), OpenEXR.File(str(path), separate_channels=True, header_only=True) as exr:
            heads = [dict(part.header) for part in exr.parts]
        windows = _check_heads(path, heads)
        with quiet_library(), OpenEXR.File(str(path), separate_channels=True) as exr:
            parts = [
                {name: np.asarray(channel.pixels) for name, channel in part.channels.items()} for part in exr.parts
            ]
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file; check the path") from error
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path") from error
    except (RuntimeError, ValueError, LookupError, TypeError) as error:
        raise FormatError(f"{path}: no EXR, or a damaged one ({error}); {MEND}") from error
    # What OpenEXR cannot decode it leaves out.
    whole = len(parts) == len(heads) and all(parts)
    require(path, whole, "damaged EXR (a part cannot be decoded); copy it again")
    display = _corners(heads[0]["displayWindow"])
    planes: dict[str, NDArray[Any]] = {}
    for index, (head, window, channels) in enumerate(zip(heads, windows, parts, strict=True)):
        size = (window[3] - window[1] + 1, window[2] - window[0] + 1)
        broken = [name for name, values in channels.items() if values.shape != size]
        require(path, not broken, f"damaged EXR ({listed(broken)}); copy it again")
        for name, values in channels.items():
            planes.setdefault(_whole_name(name, head, index), _placed(values, window, display))
    return Stored(planes, heads[0], any(window != display for window in windows))


def _check_heads(path: Path, heads: list[dict[str, Any]]) -> list[Window]:
    require(path, bool(heads), f"no part in it; {MEND}")
    left, top, right, bottom = _corners(heads[0]["displayWindow"])
    windows, unpacked = [_corners(head["dataWindow"]) for head in heads], 0
    width, height = right - left + 1, bottom - top + 1
    require(path, 0 < width * height <= LARGEST_PIXELS and width > 0, f"claims {width} × {height} pixels; refused")
    for head, window in zip(heads, windows, strict=True):
        require(path, head["type"] in _PLAIN, "holds deep pixels; render flat ones")
        wide, high = window[2] - window[0] + 1, window[3] - window[1] + 1
        require(path, 0 < wide * high <= LARGEST_PIXELS and wide > 0, f"claims {wide} × {high} pixels; refused")
        unpacked += 4 * len(head["channels"]) * wide * high
        unpacked += 4 * len(head["channels"]) * width * height if window != _corners(head["displayWindow"]) else 0
        halved = [channel.name for channel in head["channels"] if channel.xSampling != 1 or channel.ySampling != 1]
        require(path, not halved, f"{listed(halved)} hold less than a value a pixel; {MEND}")
    check_budget(path, unpacked, _LARGEST_BYTES, ratio=FLAT_RATIO)
    return windows


def _whole_name(channel: str, head: Mapping[str, Any], index: int) -> str:
    """Put the part's name before a channel that does not name its layer itself."""
    part = head.get("name") or ""
    if "." in channel or not isinstance(part, str) or part.lower() in _PICTURE_PARTS:
        return channel
    if index == 0 and channel.upper() in {"R", "G", "B", "A"}:
        return channel
    return f"{part}.{channel}"


def _placed(values: NDArray[Any], data: Window, display: Window) -> NDArray[Any]:
    """Cut what sticks out of the display window, and fill with 0 what is missing in it."""
    if data == display:
        return values
    left, top, right, bottom = display
    placed = np.zeros((bottom - top + 1, right - left + 1), values.dtype)
    x0, y0, x1, y1 = max(left, data[0]), max(top, data[1]), min(right, data[2]), min(bottom, data[3])
    if x0 <= x1 and y0 <= y1:
        placed[y0 - top : y1 - top + 1, x0 - left : x1 - left + 1] = values[
            y0 - data[1] : y1 - data[1] + 1, x0 - data[0] : x1 - data[0] + 1
        ]
    return placed


def _corners(window: Any) -> Window:
    (left, top), (right, bottom) = (corner.tolist() for corner in window)
    return int(left), int(top), int(right), int(bottom)
