"""Read the head of a KTX 2.0 file and believe nothing of it before it is checked.

Sizes, places and ratios are compared with one another and with the length of the file, so that no lie in the head makes
the reader allocate or look outside.
"""

import struct
from dataclasses import replace
from pathlib import Path

from litrig.base.errors import FormatError, InputError
from processing.amc.files.ktx2_container import HEADER, IDENTIFIER, LEVEL_PLACE, Container, LevelPlace, Scheme, VkFormat
from processing.limits import FREE_BYTES, LARGEST_RATIO

LARGEST_SIDE = 2048
"""The side of a volume that every graphics card of the last decade takes."""
LARGEST_BYTES = 4 << 30
"""Of all unpacked levels together."""
_HEAD_BYTES = 1 << 20
_MEND = "build or copy it again"


def read_container(path: Path) -> Container:
    """Read and check what stands before the level data.

    Raises
    ------
    InputError
        The file cannot be read.
    FormatError
        It is no KTX 2.0 file, is of a kind that holds no AMC, or contradicts itself or its own length.
    """
    try:
        with path.open("rb") as file:
            head = file.read(_HEAD_BYTES)
            file_bytes = file.seek(0, 2)
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file; check the path") from error
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path") from error
    return _Head(path, head, file_bytes).container()


class _Head:
    """The first bytes of a file under suspicion."""

    def __init__(self, path: Path, head: bytes, file_bytes: int) -> None:
        self._path = path
        self._head = head
        self._file_bytes = file_bytes

    def container(self) -> Container:
        self._require(self._head[:12] == IDENTIFIER, "not a KTX 2.0 file; give one that litrig amc build has written")
        fields = HEADER.unpack(self._part(0, HEADER.size, "header"))
        vk_format, type_size, *geometry, scheme = fields[1:10]
        descriptor_at, descriptor_bytes, keys_at, keys_bytes, global_at, global_bytes = fields[10:]
        size, depth, levels = self._geometry(geometry)
        known = Container(self._format(vk_format, type_size), size, depth, self._scheme(scheme), (), {})
        self._require(
            global_at == 0 and global_bytes == 0, f"has global data, which its scheme has no use for; {_MEND}"
        )
        places = tuple(self._level_place(known, level) for level in range(levels))
        self._budget(places)
        self._descriptor(descriptor_at, descriptor_bytes)
        return replace(known, places=places, keys=self._keys(keys_at, keys_bytes))

    def _geometry(self, geometry: list[int]) -> tuple[int, int, int]:
        width, height, depth, layers, faces, levels = geometry
        self._require(
            0 < width == height <= LARGEST_SIDE and 0 < depth <= LARGEST_SIDE,
            f"claims {width} × {height} × {depth} texels; an AMC has square slices and 1 to {LARGEST_SIDE} on a side; "
            + _MEND,
        )
        self._require(layers == 0 and faces == 1, f"is an array or a cube map, not one volume; {_MEND}")
        most = max(width, depth).bit_length()
        self._require(levels <= most, f"claims {levels} mip levels where {most} reach a single texel; {_MEND}")
        return width, depth, max(1, levels)  # 0 leaves it to the reader to make smaller levels

    def _format(self, vk_format: int, type_size: int) -> VkFormat:
        known = vk_format in (VkFormat.R8G8B8A8_SRGB, VkFormat.R16G16B16A16_SFLOAT)
        self._require(known, f"has texel format {vk_format}; an AMC has RGBA8 sRGB (43) or RGBA16F (97); convert it")
        kind = VkFormat(vk_format)
        self._require(type_size == kind.channel_bytes, f"has type size {type_size}, not {kind.channel_bytes}; {_MEND}")
        return kind

    def _scheme(self, scheme: int) -> Scheme:
        known = scheme in (Scheme.NONE, Scheme.ZSTANDARD)
        self._require(known, f"is packed by scheme {scheme}; litrig reads plain (0) and Zstandard (2); repack it")
        return Scheme(scheme)

    def _level_place(self, known: Container, level: int) -> LevelPlace:
        at = HEADER.size + level * LEVEL_PLACE.size
        place = LevelPlace(*LEVEL_PLACE.unpack(self._part(at, LEVEL_PLACE.size, "level index")))
        expected = known.level_bytes(level)
        self._require(
            place.unpacked_bytes == expected,
            f"level {level} claims {place.unpacked_bytes:,} bytes, but its texels take {expected:,}; {_MEND}",
        )
        self._require(
            known.scheme is not Scheme.NONE or place.packed_bytes == expected,
            f"level {level} is plain, yet stored in {place.packed_bytes:,} bytes instead of {expected:,}; {_MEND}",
        )
        self._require(
            place.offset + place.packed_bytes <= self._file_bytes and place.packed_bytes > 0,
            f"cut short: level {level} ends at byte {place.offset + place.packed_bytes:,} of {self._file_bytes:,}; "
            + _MEND,
        )
        return place

    def _budget(self, places: tuple[LevelPlace, ...]) -> None:
        unpacked = sum(place.unpacked_bytes for place in places)
        packed = sum(place.packed_bytes for place in places)
        self._require(unpacked <= LARGEST_BYTES, f"unpacks to {unpacked:,} bytes, more than {LARGEST_BYTES:,}; refused")
        self._require(
            unpacked <= max(FREE_BYTES, packed * LARGEST_RATIO),
            f"unpacks from {packed:,} to {unpacked:,} bytes, more than {LARGEST_RATIO} to 1; refused",
        )

    def _descriptor(self, at: int, count: int) -> None:
        descriptor = self._part(at, count, "data format descriptor")
        self._require(count >= 28, f"its data format descriptor has {count} bytes, not 28 or more; {_MEND}")
        premultiplied = descriptor[15] & 1
        self._require(not premultiplied, "its colours are multiplied by alpha; store straight colours")

    def _keys(self, at: int, count: int) -> dict[str, bytes]:
        keys: dict[str, bytes] = {}
        left = self._part(at, count, "key/value data")
        while left:
            self._require(len(left) >= 4, f"its key/value data end within a length; {_MEND}")
            (length,) = struct.unpack_from("<L", left)
            key, end, value = left[4 : 4 + length].partition(b"\0")
            self._require(length <= len(left) - 4 and end != b"", f"its key/value data are damaged; {_MEND}")
            keys[key.decode("utf-8", "replace")] = value
            left = left[4 + length + -length % 4 :]
        return keys

    def _part(self, at: int, count: int, name: str) -> bytes:
        self._require(
            at + count <= len(self._head),
            f"cut short: its {name} ends at byte {at + count:,}, of {min(self._file_bytes, _HEAD_BYTES):,} "
            f"that can hold it; {_MEND}",
        )
        return self._head[at : at + count]

    def _require(self, holds: bool, otherwise: str) -> None:
        if not holds:
            raise FormatError(f"{self._path}: {otherwise}")
