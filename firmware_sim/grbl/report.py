"""What GRBL 1.1h says: banner, feedback messages, status reports."""

from dataclasses import dataclass, replace

from firmware_sim.motion import Vector

BANNER = "\r\nGrbl 1.1h ['$' for help]\r\n"
HELP = "[HLP:$$ $# $G $I $N $x=val $Nx=line $J=line $SLP $C $X $H ~ ! ? ctrl-x]\r\n"
BUILD_INFO = "[VER:1.1h.20190830:]\r\n[OPT:V,15,128]\r\n"
STARTUP_LINES = "$N0=\r\n$N1=\r\n"
UNLOCK_HINT = "[MSG:'$H'|'$X' to unlock]\r\n"
UNLOCKED = "[MSG:Caution: Unlocked]\r\n"
RESET_TO_CONTINUE = "[MSG:Reset to continue]\r\n"
CHECK_DOOR = "[MSG:Check Door]\r\n"

OFFSETS_EVERY = (10, 30)
OVERRIDES_EVERY = (10, 20)
"""Reports from one WCO or Ov to the next: at rest, and in motion."""


@dataclass(frozen=True)
class Snapshot:
    """What a status report is made of; positions in units of the report."""

    state: str
    position: Vector
    free_blocks: int
    free_bytes: int
    feed: float
    speed: float
    limits: str
    spindle: int
    busy: bool


@dataclass(frozen=True)
class Rotation:
    """How many reports to go until WCO and Ov come again; the first report has WCO, the second Ov."""

    offsets: int = 0
    overrides: int = 0


def status(snapshot: Snapshot, mask: int, rotation: Rotation) -> tuple[str, Rotation]:
    """Print a report, as `?` does, and turn the rotation by one.

    Parameters
    ----------
    snapshot : what to say
    mask : setting $10; bit 0 for machine instead of work position, bit 1 for the buffer field
    rotation : what was due
    """
    fields = [snapshot.state, f"{'MPos' if mask & 1 else 'WPos'}:{_vector(snapshot.position)}"]
    if mask & 2:
        fields.append(f"Bf:{snapshot.free_blocks},{snapshot.free_bytes}")
    fields.append(f"FS:{snapshot.feed:.0f},{snapshot.speed:.0f}")
    if snapshot.limits:
        fields.append(f"Pn:{snapshot.limits}")
    extra, rotation = _rotate(snapshot, rotation)
    return f"<{'|'.join(fields + extra)}>\r\n", rotation


def _rotate(snapshot: Snapshot, rotation: Rotation) -> tuple[list[str], Rotation]:
    if rotation.offsets == 0:
        # WCO and Ov never share a report.
        rest = Rotation(OFFSETS_EVERY[snapshot.busy] - 1, max(rotation.overrides, 1) - 1)
        return [f"WCO:{_vector((0.0,) * len(snapshot.position))}"], rest
    rotation = replace(rotation, offsets=rotation.offsets - 1)
    if rotation.overrides:
        return [], replace(rotation, overrides=rotation.overrides - 1)
    accessory = {3: ["A:S"], 4: ["A:C"]}.get(snapshot.spindle, [])
    return ["Ov:100,100,100", *accessory], replace(rotation, overrides=OVERRIDES_EVERY[snapshot.busy] - 1)


def parameters(home: Vector) -> str:
    """Print coordinate systems, as `$#` does."""
    zero = _vector((0.0,) * len(home))
    offsets = "".join(f"[G{number}:{zero}]\r\n" for number in range(54, 60))
    return f"{offsets}[G28:{_vector(home)}]\r\n[G30:{zero}]\r\n[G92:{zero}]\r\n[TLO:0.000]\r\n[PRB:{zero}:0]\r\n"


def _vector(values: Vector) -> str:
    return ",".join(f"{value + 0.0:.3f}" for value in values).replace("-0.000", "0.000")
