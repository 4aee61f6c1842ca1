"""Write the KTX 2.0 container, as far as an AMC needs it: one plain or Zstandard-packed volume with mip levels.

Everything is little-endian. The order in the file is header, level index (largest level first), data format
descriptor, key/value data, level data (smallest level first), by the Khronos KTX 2.0 and Data Format specifications.
"""

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum

IDENTIFIER = b"\xabKTX 20\xbb\r\n\x1a\n"
HEADER = struct.Struct("<12s13L2Q")
LEVEL_PLACE = struct.Struct("<3Q")


class VkFormat(IntEnum):
    """How a texel is stored, by Vulkan's numbers."""

    R8G8B8A8_SRGB = 43
    R16G16B16A16_SFLOAT = 97

    @property
    def channel_bytes(self) -> int:
        return 1 if self is VkFormat.R8G8B8A8_SRGB else 2

    @property
    def texel_bytes(self) -> int:
        return 4 * self.channel_bytes


class Scheme(IntEnum):
    """How level data are packed."""

    NONE = 0
    ZSTANDARD = 2


@dataclass(frozen=True)
class LevelPlace:
    """Where a level's bytes are in the file and how many they become."""

    offset: int
    packed_bytes: int
    unpacked_bytes: int


@dataclass(frozen=True)
class Container:
    """What stands before the level data. `places` has the largest level first."""

    vk_format: VkFormat
    size: int
    depth: int
    scheme: Scheme
    places: tuple[LevelPlace, ...]
    keys: Mapping[str, bytes]

    def shape(self, level: int) -> tuple[int, int, int]:
        """Return slices, rows and columns of a level: halves, rounded down, at least one."""
        return max(1, self.depth >> level), max(1, self.size >> level), max(1, self.size >> level)

    def level_bytes(self, level: int) -> int:
        """Count the unpacked bytes of a level."""
        slices, rows, columns = self.shape(level)
        return slices * rows * columns * self.vk_format.texel_bytes


def assemble(
    vk_format: VkFormat, size: int, depth: int, scheme: Scheme, keys: Mapping[str, bytes], packed: Sequence[bytes]
) -> list[bytes]:
    """Put a whole file together from the bytes of each level, the largest first, packed by `scheme`; in parts."""
    descriptor, key_values = data_format_descriptor(vk_format), _pack_keys(keys)
    descriptor_at = HEADER.size + LEVEL_PLACE.size * len(packed)
    keys_at = descriptor_at + len(descriptor)
    header = HEADER.pack(
        *(IDENTIFIER, vk_format, vk_format.channel_bytes, size, size, depth, 0, 1, len(packed), scheme),
        *(descriptor_at, len(descriptor), keys_at, len(key_values), 0, 0),
    )
    container = Container(vk_format, size, depth, scheme, (), keys)
    # Plain texels start at a multiple of their own size; packed levels follow one another without a gap.
    alignment = vk_format.texel_bytes if scheme is Scheme.NONE else 1
    places: list[bytes] = []
    body: list[bytes] = []
    at = keys_at + len(key_values)
    for level in reversed(range(len(packed))):
        body += [bytes(-at % alignment), packed[level]]
        at += len(body[-2])
        places.insert(0, LEVEL_PLACE.pack(at, len(packed[level]), container.level_bytes(level)))
        at += len(packed[level])
    return [header, *places, descriptor, key_values, *body]


def data_format_descriptor(vk_format: VkFormat) -> bytes:
    """Describe RGBA texels by a basic data format descriptor, version 2: RGBSDA, BT.709, straight alpha."""
    is_half = vk_format is VkFormat.R16G16B16A16_SFLOAT
    bits = 8 * vk_format.channel_bytes
    samples = b"".join(
        struct.pack("<HBB4x2L", number * bits, bits - 1, *_sample(channel, is_half))
        for number, channel in enumerate((0, 1, 2, 15))
    )
    block_bytes = 24 + len(samples)
    model_rgbsda, primaries_bt709, transfer, straight_alpha = 1, 1, (1 if is_half else 2), 0
    planes = bytes([vk_format.texel_bytes, *[0] * 7])
    return (
        struct.pack("<L", 4 + block_bytes)
        + struct.pack("<L2H4B4x", 0, 2, block_bytes, model_rgbsda, primaries_bt709, transfer, straight_alpha)
        + planes
        + samples
    )


def _sample(channel: int, is_half: bool) -> tuple[int, int, int]:
    """Return channel with qualifiers, and the stored values that mean the lower and the upper end."""
    if is_half:
        return channel | 0xC0, 0xBF800000, 0x3F800000  # signed, float, from −1.0 to 1.0
    # Alpha has no transfer function, also where the colours are sRGB-encoded.
    return (channel | 0x10 if channel == 15 else channel), 0, 255


def _pack_keys(keys: Mapping[str, bytes]) -> bytes:
    """Pack key/value pairs, sorted by key, each padded to four bytes."""
    packed = bytearray()
    for key in sorted(keys):
        pair = key.encode() + b"\0" + keys[key]
        packed += struct.pack("<L", len(pair)) + pair
        packed += bytes(-len(packed) % 4)
    return bytes(packed)
