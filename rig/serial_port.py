"""Opening serial ports so that two programs never talk on one wire.

Every driver opens its port here; so each is exclusive, can be recorded, and can be replaced by a record.
"""

import errno
import os
from functools import partial
from pathlib import Path

import serial

from rig.errors import PortError
from rig.replay import current_replay
from rig.udev import installing, rule_for
from rig.wire_record import RecordedSerial, current_recorder


def open_serial(path: str, baud: int) -> serial.Serial:
    """Open a port exclusively, with reads that return at once.

    Raises
    ------
    PortError
        The port is missing, forbidden or taken; the message says which, and what to do.
    """
    if (replay := current_replay()) is not None:
        return replay.open(path)
    recorder = current_recorder()
    opening = serial.Serial if recorder is None else partial(RecordedSerial, recorder)
    try:
        # Locked before anything of the port is changed, for somebody may be using it.
        return opening(path, baud, timeout=0, write_timeout=2, exclusive=True)
    except (serial.SerialException, OSError, ValueError) as error:
        raise port_error(path, error) from error


def port_error(path: str, error: Exception) -> PortError:
    """Say why a port cannot be opened, and what to do."""
    if not Path(path).exists():
        return PortError(
            f"{path}: no such port; check cable and power, and the port in RIG.toml (ls /dev/serial/by-id)"
        )
    code = getattr(error, "errno", None)
    if code in (errno.EACCES, errno.EPERM) or not os.access(path, os.R_OK | os.W_OK):
        return PortError(f"{path}: permission denied; {installing(rule_for(path))}")
    if code in (errno.EAGAIN, errno.EBUSY) or "exclusively lock" in str(error):
        return PortError(
            f"{path}: held by another program ({holders(path) or 'of another user'}); end it and try again"
        )
    return PortError(f"{path}: cannot be opened ({error}); check that it is a serial port")


def holders(path: str) -> str:
    """Name the processes that have a file open, as far as this user may see."""
    target = os.path.realpath(path)
    found = []
    for entry in Path("/proc").glob("[0-9]*/fd/*"):
        try:
            if os.path.realpath(entry) == target and entry.parts[2] != str(os.getpid()):
                found.append(entry.parts[2])
        except OSError:
            continue
    names = []
    for pid in dict.fromkeys(found):
        try:
            names.append(f"process {pid}, {Path('/proc', pid, 'comm').read_text().strip()}")
        except OSError:
            continue
    return " and ".join(names)
