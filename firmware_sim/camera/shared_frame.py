"""The memory that camera and client share: wishes one way, pictures the other.

The first page holds the fields below, the picture follows. The simulator writes pictures and switches; the preloaded
shim, in the client's process, writes what the client asked for. `sequence` is a seqlock: odd while a picture is being
written, so that a reader takes the picture only if it read the same even number before and after.
"""

import fcntl
import mmap
import os
import struct
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Self

MAGIC = 0x4C52_4631
HEADER_BYTES = 4096
LARGEST_PICTURE_BYTES = 1280 * 720 * 2
"""Room for one picture; a YUYV picture of the largest size fills it."""
TOTAL_BYTES = HEADER_BYTES + LARGEST_PICTURE_BYTES
LONGEST_LAG = 30
"""By how many frames a picture may come late, if it is to."""
MJPG, YUYV = (int.from_bytes(name, "little") for name in (b"MJPG", b"YUYV"))

_C_TYPES = {"I": "uint32_t", "i": "int32_t", "Q": "uint64_t"}
FIELDS = (
    ("magic", "I"), ("hang", "I"), ("unplugged", "I"), ("frozen", "I"), ("best_focus", "i"),
    ("lag_frames", "I"), ("lost_percent", "I"),
    ("streaming", "I"), ("stream", "I"), ("pixel_format", "I"), ("width", "I"), ("height", "I"), ("fps", "I"),
    ("brightness", "i"), ("gain", "i"), ("exposure_auto", "i"), ("exposure_100us", "i"),
    ("white_balance_auto", "i"), ("white_balance_k", "i"), ("focus_auto", "i"), ("focus", "i"),
    ("sequence", "I"), ("picture_stream", "I"), ("picture_bytes", "I"),
    ("delivered", "Q"), ("dropped", "Q"), ("number", "Q"), ("exposure_start_ns", "Q"),
)  # fmt: skip
"""Every field with its struct code: 4-byte ones first, an even count of them, so that C adds no padding."""


def _offsets() -> dict[str, tuple[int, struct.Struct]]:
    place, offsets = 0, {}
    for name, code in FIELDS:
        packer = struct.Struct(f"<{code}")
        offsets[name] = (place, packer)
        place += packer.size
    return offsets


_OFFSETS = _offsets()


def c_header() -> str:
    """Return the same layout as a C struct: what the shim is compiled with."""
    lines = "".join(f"    {_C_TYPES[code]} {name};\n" for name, code in FIELDS)
    sizes = f"#define MAGIC {MAGIC}u\n#define HEADER_BYTES {HEADER_BYTES}\n#define TOTAL_BYTES {TOTAL_BYTES}\n"
    last, packer = _OFFSETS[FIELDS[-1][0]]
    check = f'_Static_assert(sizeof(struct shared_frame) == {last + packer.size}, "padding");\n'
    return f"#include <stdint.h>\n{sizes}struct shared_frame {{\n{lines}}};\n{check}"


@dataclass(frozen=True)
class Wish:
    """What the client has asked the camera for. Control values are in V4L2 units."""

    streaming: bool
    stream: int
    pixel_format: int
    width: int
    height: int
    fps: int
    brightness: int
    gain: int
    exposure_auto: int
    exposure_100us: int
    white_balance_auto: int
    white_balance_k: int
    focus_auto: int
    focus: int


class SharedFrame:
    """The simulator's end of the shared memory. Who creates the file closes it last."""

    def __init__(self, path: Path, *, create: bool = False) -> None:
        self._path = path
        handle = os.open(path, os.O_RDWR | (os.O_CREAT | os.O_EXCL if create else 0), 0o600)
        try:
            if create:
                os.ftruncate(handle, TOTAL_BYTES)
            self._memory = mmap.mmap(handle, TOTAL_BYTES)
        finally:
            os.close(handle)
        if create:
            self["magic"] = MAGIC

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._memory.close()

    def __getitem__(self, name: str) -> int:
        place, packer = _OFFSETS[name]
        return int(packer.unpack_from(self._memory, place)[0])

    def __setitem__(self, name: str, value: int) -> None:
        place, packer = _OFFSETS[name]
        packer.pack_into(self._memory, place, value)

    def is_held(self) -> bool:
        """Tell whether a client has the camera: its lock goes with it, also when it is killed."""
        with self._path.open("rb") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                return True
        return False

    def wish(self) -> Wish:
        values = {name: self[name] for name in Wish.__dataclass_fields__ if name != "streaming"}
        return Wish(streaming=bool(self["streaming"]), **values)

    def publish(self, picture: bytes, stream: int, number: int, exposure_start_s: float) -> None:
        """Hand a picture over, once.

        Parameters
        ----------
        picture : encoded as the client asked
        stream : the number of the STREAMON that it was made for; the shim drops what is older
        number : counts the camera's frames, dropped ones included
        exposure_start_s : CLOCK_MONOTONIC when the exposure began
        """
        if len(picture) > LARGEST_PICTURE_BYTES:
            raise ValueError(f"a picture of {len(picture)} bytes exceeds the room of {LARGEST_PICTURE_BYTES}")
        sequence = self["sequence"] | 1
        self["sequence"] = sequence
        self._memory[HEADER_BYTES : HEADER_BYTES + len(picture)] = picture
        self["picture_stream"], self["picture_bytes"], self["number"] = stream, len(picture), number
        self["exposure_start_ns"] = round(exposure_start_s * 1e9)
        self["sequence"] = (sequence + 1) % 2**32
