"""The few operations by which a session's folder is written, behind an interface.

What they promise is what a disk promises: until a file and the folder that names it are synced, a power cut may lose,
tear or zero them. A test that records the operations can therefore try what every cut would leave.
"""

import os
from pathlib import Path
from typing import Protocol


class Store(Protocol):
    """Where files go; every operation raises `OSError`, as the disk says it."""

    def make_folder(self, folder: Path) -> None:
        """Make a folder that is not there yet, in one that is."""

    def write(self, path: Path, *parts: bytes) -> None:
        """Write a new file, part after part."""

    def append(self, path: Path, content: bytes) -> None:
        """Add to the end of a file, which is made if it is not there; all of it, or an error."""

    def cut(self, path: Path, size: int) -> None:
        """Shorten a file."""

    def sync(self, path: Path) -> None:
        """Make what a file holds durable."""

    def rename(self, source: Path, target: Path) -> None:
        """Give a file its name, in place of what has that name."""

    def remove(self, path: Path) -> None:
        """Remove a file."""

    def sync_folder(self, folder: Path) -> None:
        """Make the names in a folder durable."""


class DiskStore:
    """The disk itself."""

    def make_folder(self, folder: Path) -> None:
        """Make it."""
        folder.mkdir()

    def write(self, path: Path, *parts: bytes) -> None:
        """Write it."""
        with path.open("wb") as file:
            file.writelines(parts)

    def append(self, path: Path, content: bytes) -> None:
        """Add to it, past every buffer: what a full disk refuses must not go out later."""
        with path.open("ab", buffering=0) as file:
            left = memoryview(content)
            while left:
                left = left[file.write(left) :]

    def cut(self, path: Path, size: int) -> None:
        """Shorten it."""
        os.truncate(path, size)

    def sync(self, path: Path) -> None:
        """Wait for the disk."""
        _sync(path, os.O_RDONLY)

    def rename(self, source: Path, target: Path) -> None:
        """Rename it."""
        source.replace(target)

    def remove(self, path: Path) -> None:
        """Remove it."""
        path.unlink()

    def sync_folder(self, folder: Path) -> None:
        """Wait for the disk."""
        _sync(folder, os.O_RDONLY | os.O_DIRECTORY)


def _sync(path: Path, flags: int) -> None:
    handle = os.open(path, flags)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


DISK: Store = DiskStore()
