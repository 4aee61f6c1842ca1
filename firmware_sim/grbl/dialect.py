"""What differs between GRBL 1.1h and grblHAL, as far as a host can tell."""

from dataclasses import dataclass
from typing import Literal

DialectName = Literal["grbl", "grblHAL"]


@dataclass(frozen=True)
class Dialect:
    """One firmware.

    Attributes
    ----------
    banner : what it says when it has started
    blocks, rx_bytes : size of planner and receive buffer
    most_axes : letters beyond are unknown to it
    frame_s : `?` is answered at multiples of this
    extra_fields : whether reports have the fields H, T and TLR
    homes_single_axes : whether $HX, $HY, … exist
    limits_unhomed : whether soft limits hold before homing
    hangs_after_reset : whether a setting written after a soft reset hangs it, a bug that was met in the wild
    """

    banner: str
    build: str
    blocks: int
    rx_bytes: int
    most_axes: int
    frame_s: float
    extra_fields: bool
    homes_single_axes: bool
    limits_unhomed: bool
    hangs_after_reset: bool


GRBL = Dialect(
    banner="\r\nGrbl 1.1h ['$' for help]\r\n",
    build="[VER:1.1h.20190830:{info}]\r\n[OPT:V,15,128]\r\n",
    blocks=15,
    rx_bytes=128,
    most_axes=3,
    frame_s=0.0,
    extra_fields=False,
    homes_single_axes=False,
    limits_unhomed=True,
    hangs_after_reset=False,
)
GRBL_HAL = Dialect(
    banner="\r\nGrblHAL 1.1f ['$' or '$HELP' for help]\r\n",
    build="[VER:1.1f.20240928:{info}]\r\n[OPT:VNMSL,100,1023,4,0]\r\n[NEWOPT:ENUMS,RT+,HOME]\r\n[FIRMWARE:grblHAL]\r\n",
    blocks=100,
    rx_bytes=1023,
    most_axes=6,
    frame_s=0.02,
    extra_fields=True,
    homes_single_axes=True,
    limits_unhomed=False,
    hangs_after_reset=True,
)
DIALECTS: dict[DialectName, Dialect] = {"grbl": GRBL, "grblHAL": GRBL_HAL}
