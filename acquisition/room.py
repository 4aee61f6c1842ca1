"""Whether the disk has room for what is still to be shot."""

import shutil
from pathlib import Path

from litrig.base.errors import InputError

MARGIN = 1.2
RESERVE_FRAMES = 3
RESERVE_BYTES = 500_000
"""What journal, thumbnails and the closing of the bag need besides frames."""


class Room:
    """Watches the disk that a session goes to."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._largest_bytes = 0

    def check(self, frame_bytes: int, frames_left: int) -> None:
        """Refuse to go on if, by the first frame's size, the others will not fit, or if the disk is all but full.

        Raises
        ------
        InputError
            Free space first.
        """
        is_first, self._largest_bytes = self._largest_bytes == 0, max(self._largest_bytes, frame_bytes)
        needed = round(MARGIN * self._largest_bytes * frames_left)
        wanted = RESERVE_BYTES + (needed if is_first else min(needed, RESERVE_FRAMES * self._largest_bytes))
        free = shutil.disk_usage(self._folder).free
        if frames_left and free < wanted:
            raise InputError(
                f"{self._folder}: has {free / 1e6:.1f} MB left on its disk, and the {frames_left} frames to come need "
                f"about {needed / 1e6:.1f} MB; free space there"
            )
