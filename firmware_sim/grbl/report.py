"""What the firmware says: feedback messages, status reports, parameters."""

from dataclasses import dataclass, replace

from firmware_sim.grbl.dialect import Dialect
from firmware_sim.grbl.eeprom import COORDINATE_SYSTEMS, Eeprom
from firmware_sim.motion import Vector

HELP = "[HLP:$$ $# $G $I $N $x=val $Nx=line $J=line $SLP $C $X $H ~ ! ? ctrl-x]\r\n"
UNLOCK_HINT = "[MSG:'$H'|'$X' to unlock]\r\n"
UNLOCKED = "[MSG:Caution: Unlocked]\r\n"
RESET_TO_CONTINUE = "[MSG:Reset to continue]\r\n"
CHECK_DOOR = "[MSG:Check Door]\r\n"
ENABLED, DISABLED = "[MSG:Enabled]\r\n", "[MSG:Disabled]\r\n"
SLEEPING = "[MSG:Sleeping]\r\n"
PROGRAM_END = "[MSG:Pgm End]\r\n"
RESTORING = "[MSG:Restoring defaults]\r\n"

OFFSETS_EVERY = (10, 30)
OVERRIDES_EVERY = (10, 20)
"""Reports from one WCO or Ov to the next: at rest, and in motion."""


@dataclass(frozen=True)
class Snapshot:
    """What a status report is made of; positions in units of the report."""

    state: str
    position: Vector
    offset: Vector
    free_blocks: int
    free_bytes: int
    feed: float
    speed: float
    pins: str
    accessories: str
    overrides: tuple[int, int, int]
    homed: bool
    busy: bool


@dataclass(frozen=True)
class Rotation:
    """How many reports to go until WCO and Ov come again; the first report has WCO, the second Ov."""

    offsets: int = 0
    overrides: int = 0


def status(snapshot: Snapshot, mask: int, rotation: Rotation, dialect: Dialect) -> tuple[str, Rotation]:
    """Print a report, as `?` does, and turn the rotation by one.

    Parameters
    ----------
    snapshot : what to say
    mask : setting $10; bit 0 for machine instead of work position, bit 1 for the buffer field
    rotation : what was due
    dialect : of the firmware
    """
    work = tuple(p - o for p, o in zip(snapshot.position, snapshot.offset, strict=True))
    place = f"MPos:{_vector(snapshot.position)}" if mask & 1 else f"WPos:{_vector(work)}"
    fields = [snapshot.state, place]
    if mask & 2:
        fields.append(f"Bf:{snapshot.free_blocks},{snapshot.free_bytes}")
    fields.append(f"FS:{snapshot.feed:.0f},{snapshot.speed:.0f}")
    if snapshot.pins:
        fields.append(f"Pn:{snapshot.pins}")
    extra, rotation = _rotate(snapshot, rotation, dialect)
    return f"<{'|'.join(fields + extra)}>\r\n", rotation


def _rotate(snapshot: Snapshot, rotation: Rotation, dialect: Dialect) -> tuple[list[str], Rotation]:
    if rotation.offsets == 0:
        # WCO and Ov never share a report.
        rest = Rotation(OFFSETS_EVERY[snapshot.busy] - 1, max(rotation.overrides, 1) - 1)
        return [f"WCO:{_vector(snapshot.offset)}"], rest
    rotation = replace(rotation, offsets=rotation.offsets - 1)
    if rotation.overrides:
        return [], replace(rotation, overrides=rotation.overrides - 1)
    fields = ["Ov:{},{},{}".format(*snapshot.overrides)]
    if snapshot.accessories or dialect.extra_fields:
        fields.append(f"A:{snapshot.accessories}")
    if dialect.extra_fields:
        fields += [f"H:{int(snapshot.homed)}", "T:0", "TLR:0"]
    return fields, replace(rotation, overrides=OVERRIDES_EVERY[snapshot.busy] - 1)


def parameters(eeprom: Eeprom, shift: Vector) -> str:
    """Print coordinate systems, as `$#` does."""
    places = "".join(f"[{name}:{_vector(eeprom.places[name])}]\r\n" for name in (*COORDINATE_SYSTEMS, "G28", "G30"))
    return f"{places}[G92:{_vector(shift)}]\r\n[TLO:0.000]\r\n[PRB:{_vector(eeprom.zero)}:0]\r\n"


def _vector(values: Vector) -> str:
    return ",".join(f"{value + 0.0:.3f}" for value in values).replace("-0.000", "0.000")
