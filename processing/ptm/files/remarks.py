"""What litrig knows of a material and the formats of others have no field for: one line of JSON after the last pixel.

Readers stop after the last byte that they expect, so that none is disturbed. A file without the line holds display
values, as the field has it, and names no source.
"""

import json
from pathlib import Path
from typing import NamedTuple, cast, get_args

from litrig.base.errors import FormatError
from litrig.base.version import litrig_version
from processing.ptm.model import Material, Space

LARGEST_BYTES = 4096
_START = b"\n#litrig "


class Remarks(NamedTuple):
    """Which values a file holds, and the digest of the frames behind them."""

    space: Space = "srgb"
    source: str = ""


def format_remarks(material: Material) -> bytes:
    """Return the line for the end of a file."""
    written = {"space": material.space, "source": material.source, "litrig": litrig_version()}
    return _START + json.dumps(written).encode("ascii") + b"\n"


def parse_remarks(path: Path, rest: bytes, spare_bytes: int = 0) -> Remarks:
    """Read the line from what follows the last pixel.

    Parameters
    ----------
    spare_bytes : so many bytes may follow in files of other programs

    Raises
    ------
    FormatError
        Something else follows, or the line is damaged.
    """
    if not rest.startswith(_START):
        if len(rest) > spare_bytes:
            raise FormatError(f"{path}: goes on after its last pixel; header and pixels do not fit, export it again")
        return Remarks()
    try:
        written = json.loads(rest[len(_START) :])
        space, source = str(written["space"]), str(written["source"])
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise FormatError(f"{path}: litrig's line after the pixels is damaged; copy or write it again") from error
    return Remarks(check_space(path, space), source)


def check_space(path: Path, space: str) -> Space:
    """Return a space that litrig knows, or refuse the file."""
    if space not in get_args(Space):
        raise FormatError(f"{path}: holds values in a space {space!r}, neither srgb nor linear; write it again")
    return cast(Space, space)
