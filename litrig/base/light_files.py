"""The files that say where lights were: `.lp` and `.dome`."""

from pathlib import Path

from litrig.base.dome import read_dome
from litrig.base.lights import Lights
from litrig.base.lp import read_lp

ENDINGS = (".lp", ".dome")


def read_lights(path: Path) -> Lights:
    """Read an `.lp` or a RelightLab `.dome`; what ends in neither is taken for an `.lp`.

    Raises
    ------
    InputError, FormatError
        The file is missing or damaged.
    """
    return read_dome(path) if path.suffix.lower() == ".dome" else read_lp(path)
