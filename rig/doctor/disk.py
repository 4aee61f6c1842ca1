"""The folder that sessions go to: can it be written as sessions are, and is there room."""

import errno
import os
import shutil
from pathlib import Path

from litrig.base.errors import InputError
from litrig.base.files import write_atomically
from rig.doctor.finding import Findings, Part

LEAST_BYTES = 500_000_000
SCARCE_BYTES = 5_000_000_000
PROBE_BYTES = 100_000


def check_disk(folder: Path) -> Findings:
    """Write, fsync, rename and delete a small file, as each frame of a session will be; and look at the room left."""
    part = Part("disk")
    place = folder.resolve()
    while not os.path.lexists(place):  # a folder that is yet to be made lies on the disk of the one above
        place = place.parent
    probe = place / f".litrig-doctor-{os.getpid()}"
    try:
        write_atomically(probe, bytes(PROBE_BYTES))
        probe.unlink()
    except (InputError, OSError) as error:
        cause = error if isinstance(error, OSError) else error.__cause__
        if isinstance(cause, OSError) and cause.errno in (errno.ENOSPC, errno.EDQUOT):
            yield part.fault("room", f"{place}: full", "free space, or name another folder with --out")
            return
        reason = cause.strerror if isinstance(cause, OSError) else str(error)
        yield part.fault("writing", f"{place}: cannot be written ({reason})", "name another folder with --out")
        return
    yield part.ok("writing", f"{place}: written, synced, renamed and deleted")
    free = shutil.disk_usage(place).free
    room = f"{place}: {free / 1e9:.1f} GB free"
    if free < LEAST_BYTES:
        yield part.fault("room", room, "free space, or name another folder with --out")
    elif free < SCARCE_BYTES:
        yield part.warning("room", room, "that is a few sessions; free space soon")
    else:
        yield part.ok("room", room)
