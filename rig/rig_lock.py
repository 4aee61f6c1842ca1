"""One litrig at a time on a rig, however it is described: the lock is keyed by the ports, not by the file.

It covers parts that a command leaves alone, too: an arm that is homed by hand has no business in a running session.
"""

import fcntl
import hashlib
import os
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from rig.config import RigConfig
from rig.errors import PortError

PORT_KEYS = frozenset({"port", "device"})
SHARED_FOLDER = Path("/run/lock")
HOLDER_BYTES = 200


class RigLock:
    """The lock, held until `release` or the end of the process, whichever comes first."""

    def __init__(self, ports: list[str], folder: Path | None = None) -> None:
        """Take it.

        Parameters
        ----------
        ports : device paths, in any order and by any of their names
        folder : where locks lie; by default one that all users of the machine share

        Raises
        ------
        PortError
            Another process has it; the message names it.
        """
        real = sorted({os.path.realpath(port) for port in ports})
        key = hashlib.sha256("\0".join(real).encode()).hexdigest()[:16]
        self._path = (folder or _shared_folder()) / f"litrig-{key}.lock"
        self._descriptor = self._locked(", ".join(ports))

    def release(self) -> None:
        """Give it back; safe twice."""
        if self._descriptor >= 0:
            with suppress(OSError):  # another user's file stays
                self._path.unlink()  # while it is still held: see `_locked`
            os.close(self._descriptor)
            self._descriptor = -1

    def _locked(self, ports: str) -> int:
        while True:
            descriptor = self._opened()
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                holder = os.pread(descriptor, HOLDER_BYTES, 0).decode(errors="replace").strip()
                os.close(descriptor)
                raise PortError(
                    f"rig on {ports}: in use by {holder or 'another litrig'}; wait for its end, or end it"
                ) from error
            if self._is_still_there(descriptor):
                os.ftruncate(descriptor, 0)
                os.pwrite(descriptor, f"litrig, process {os.getpid()}\n".encode(), 0)
                return descriptor
            os.close(descriptor)  # it was given back, and removed, between our opening and our locking

    def _opened(self) -> int:
        flags = os.O_RDWR | os.O_CLOEXEC | os.O_NOFOLLOW
        try:
            while True:
                try:
                    return os.open(self._path, flags)
                except FileNotFoundError:
                    pass
                try:
                    descriptor = os.open(self._path, flags | os.O_CREAT | os.O_EXCL, 0o666)
                except FileExistsError:
                    continue
                os.fchmod(descriptor, 0o666)  # other users of the rig lock the same file
                return descriptor
        except OSError as error:
            raise PortError(
                f"{self._path}: the rig's lock cannot be made ({error.strerror}); check that folder"
            ) from error

    def _is_still_there(self, descriptor: int) -> bool:
        try:
            return os.path.samestat(os.fstat(descriptor), self._path.stat())
        except FileNotFoundError:
            return False


def lock_rig(config: RigConfig) -> RigLock | None:
    """Lock the rig of a RIG.toml; None for one without ports, which nobody can share.

    Raises
    ------
    PortError
        Another process uses it; the message names it.
    """
    ports = ports_of(config.model_dump())
    return RigLock(ports) if ports else None


def ports_of(sections: Mapping[str, Any]) -> list[str]:
    """Return the device paths that a configuration names, section by section."""
    return [
        value
        for section in sections.values()
        if isinstance(section, Mapping)
        for key, value in section.items()
        if key in PORT_KEYS and isinstance(value, str)
    ]


def _shared_folder() -> Path:
    return SHARED_FOLDER if os.access(SHARED_FOLDER, os.W_OK) else Path(tempfile.gettempdir())
