"""Files that are either whole or not there.

The order is that of a database log: write beside, check, fsync, rename, fsync the folder. A reader, a kill or a power
cut in between finds the old file or the new one, never half of it.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from litrig.base.errors import InputError


def sync_folder(folder: Path) -> None:
    """Make the names in a folder durable."""
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Hand out a temporary name beside `path`; what is written there takes the place of `path` at the end.

    Raises
    ------
    InputError
        The folder does not exist or cannot be written. Nothing is left behind, also if the body raises.
    """
    if not path.parent.is_dir():
        raise InputError(f"{path}: the folder {path.parent} does not exist; create it first")
    if path.is_dir():
        raise InputError(f"{path}: is a folder; name a file")
    # The ending stays last, since many writers choose their format by it.
    temporary = path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
    try:
        try:
            yield temporary
            with temporary.open("rb") as written:
                os.fsync(written.fileno())
            temporary.replace(path)
        except OSError as error:
            raise InputError(
                f"{path}: cannot be written ({error.strerror or error}); free space or choose another folder"
            ) from error
        sync_folder(path.parent)
    finally:
        temporary.unlink(missing_ok=True)


def write_atomically(path: Path, content: bytes) -> None:
    """Write a whole file, or leave what was there."""
    with replacing(path) as temporary:
        temporary.write_bytes(content)
        stored = temporary.stat().st_size
        if stored != len(content):
            raise InputError(
                f"{path}: only {stored} of {len(content)} bytes could be written; free space and try again"
            )


def resolve_inside(root: Path, relative: str) -> Path:
    """Follow a name that came from a file, and refuse to leave `root` by it.

    Raises
    ------
    InputError
        The name is absolute, climbs out of `root`, or leaves it through a link.
    """
    path = (root / relative).resolve()
    if Path(relative).is_absolute() or not path.is_relative_to(root.resolve()):
        raise InputError(
            f"{root}: names a file outside itself ({relative!r}); the folder was tampered with or is broken"
        )
    return path
