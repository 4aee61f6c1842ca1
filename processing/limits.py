"""How much a file may unpack to before it is taken for a bomb."""

LARGEST_RATIO = 200
"""Unpacked to packed. Pictures stay below 10; what unpacks to little may pack as well as it likes."""
FREE_BYTES = 64 << 20
"""What may be unpacked from a file of any size."""
