"""One writer at a time in a capture folder: a lock on its journal, which ends with the process that has it."""

import fcntl
import os
from pathlib import Path

from litrig.base.capture_folder import layout
from litrig.base.errors import InputError

LOCKS = Path("/proc/locks")


class FolderLock:
    """The lock, held until `release` or the end of the process."""

    def __init__(self, folder: Path) -> None:
        """Take it.

        Raises
        ------
        InputError
            Another process writes there; the message names it.
        """
        journal = folder / layout.JOURNAL
        try:
            self._descriptor = os.open(journal, os.O_RDWR | os.O_CLOEXEC)
        except FileNotFoundError as error:
            raise InputError(
                f"{folder}: holds no session ({layout.JOURNAL} is missing): nothing was shot there; capture it anew"
            ) from error
        except OSError as error:
            raise InputError(
                f"{journal}: cannot be written ({error.strerror}); check the disk and its rights"
            ) from error
        try:
            fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            holder = _holder(os.fstat(self._descriptor).st_ino) or "another process"
            os.close(self._descriptor)
            raise InputError(f"{folder}: is being written by {holder}; wait for its end, or end it") from error

    def release(self) -> None:
        """Give it back; safe twice."""
        if self._descriptor >= 0:
            os.close(self._descriptor)
            self._descriptor = -1


def who_writes(folder: Path) -> str:
    """Name the process that writes into a capture folder, without getting into its way; empty if none is known.

    What the kernel lists may be a file of the same number on another disk, so a lock listed there is tried; where none
    is, nothing is touched.
    """
    try:
        with (folder / layout.JOURNAL).open("rb") as journal:
            holder = _holder(os.fstat(journal.fileno()).st_ino)
            if not holder:
                return ""
            fcntl.flock(journal, fcntl.LOCK_SH | fcntl.LOCK_NB)
            return ""
    except BlockingIOError:
        return holder
    except OSError:
        return ""


def _holder(inode: int) -> str:
    """Name the process that has a file locked, as the kernel lists it; empty if it lists none."""
    try:
        lines = LOCKS.read_text().splitlines()
    except OSError:
        lines = []
    for line in lines:
        words = line.split()
        if "FLOCK" in words and words[-3].endswith(f":{inode}"):
            return f"process {words[-4]}"
    return ""
