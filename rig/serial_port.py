"""Opening serial ports so that two programs never talk on one wire."""

import errno
import fcntl
import os
from pathlib import Path

import serial

from rig.errors import PortError


def open_serial(path: str, baud: int) -> serial.Serial:
    """Open a port exclusively, with reads that return at once.

    Raises
    ------
    PortError
        The port is missing, forbidden or taken; the message says which, and what to do.
    """
    try:
        return serial.Serial(path, baud, timeout=0, write_timeout=2, exclusive=True)
    except (serial.SerialException, OSError, ValueError) as error:
        raise port_error(path, error) from error


class PortLock:
    """The lock that `open_serial` takes, for a library that opens the port by itself and takes none."""

    def __init__(self, path: str) -> None:
        """Take it.

        Raises
        ------
        PortError
            The port is missing or forbidden, or another program holds it.
        """
        try:
            self._descriptor = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        except OSError as error:
            raise port_error(path, error) from error
        try:
            fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            os.close(self._descriptor)
            raise port_error(path, error) from error

    def release(self) -> None:
        """Give it back."""
        os.close(self._descriptor)


def port_error(path: str, error: Exception) -> PortError:
    """Say why a port cannot be opened, and what to do."""
    if not Path(path).exists():
        return PortError(
            f"{path}: no such port; check cable and power, and the port in RIG.toml (ls /dev/serial/by-id)"
        )
    code = getattr(error, "errno", None)
    if code in (errno.EACCES, errno.EPERM) or not os.access(path, os.R_OK | os.W_OK):
        return PortError(f"{path}: permission denied; add yourself to its group: sudo usermod -aG dialout $USER")
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
    return "; ".join(names)
