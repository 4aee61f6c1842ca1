"""How much a file may unpack to before it is taken for a bomb."""

LARGEST_RATIO = 200
"""Unpacked to packed. Pictures stay below 10; what unpacks to little may pack as well as it likes."""
FLAT_RATIO = 1100
"""Of files that may well hold planes of one value, as light that is missing or background: deflate packs no closer."""
FREE_BYTES = 64 << 20
"""What may be unpacked from a file of any size."""
