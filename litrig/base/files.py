"""Files that are either whole or not there.

The order is that of a database log: write beside, check, fsync, rename, fsync the folder. A reader, a kill or a power
cut in between finds the old file or the new one, never half of it.
"""

import itertools
import os
import shutil
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from litrig.base.errors import InputError
from litrig.base.store import DISK, Store

_temporary_numbers = itertools.count()


@contextmanager
def replacing(path: Path, store: Store = DISK) -> Iterator[Path]:
    """Hand out a temporary name beside `path`; what is written there takes the place of `path` at the end.

    Raises
    ------
    InputError
        The folder does not exist, or the file cannot be written. Nothing is left behind, also if the body raises.
    """
    # Short, for the name may be as long as names can be; its ending stays last, since writers choose formats by it.
    temporary = path.parent / f".{os.getpid()}-{next(_temporary_numbers)}.part{path.suffix}"
    try:
        if not path.parent.is_dir():
            raise InputError(f"{path}: the folder {path.parent} does not exist; create it first")
        if path.is_dir():
            raise InputError(f"{path}: is a folder; name a file")
        yield temporary
        store.sync(temporary)
        store.rename(temporary, path)
        store.sync_folder(path.parent)
    except OSError as error:
        raise InputError(
            f"{path}: cannot be written ({error.strerror or error}); free space, or choose another name or folder"
        ) from error
    finally:
        with suppress(OSError):  # nothing was made where the name itself is refused
            if os.path.lexists(temporary):
                store.remove(temporary)


def write_atomically(path: Path, *content: bytes, store: Store = DISK) -> None:
    """Write a whole file, part after part, or leave what was there."""
    with replacing(path, store) as temporary:
        store.write(temporary, *content)
        stored, wanted = temporary.stat().st_size, sum(map(len, content))
        if stored != wanted:
            raise InputError(f"{path}: only {stored} of {wanted} bytes could be written; free space and try again")


def _replaces_nothing(_: Path) -> bool:
    return False


@contextmanager
def making_folder(path: Path, replaces: Callable[[Path], bool] = _replaces_nothing) -> Iterator[Path]:
    """Hand out a temporary folder beside `path`; what is written there becomes `path` at the end, all or nothing.

    Parameters
    ----------
    replaces : tells whether a folder that is there and holds files may go, such as an earlier one of the same kind

    Raises
    ------
    InputError
        The folder above does not exist, `path` is there and is no empty folder, or the files cannot be written. Nothing
        is left behind, also if the body raises.
    """
    number = next(_temporary_numbers)
    temporary, old = (path.parent / f".{os.getpid()}-{number}.{kind}" for kind in ("part", "old"))
    try:
        goes = is_folder(path) and any(path.iterdir()) and replaces(path)
        if not goes:
            check_new_folder(path)
        temporary.mkdir()
        yield temporary
        for written in temporary.iterdir():
            DISK.sync(written)
        DISK.sync_folder(temporary)
        if goes:
            path.rename(old)
        try:
            temporary.rename(path)
        except OSError:
            if goes:
                old.rename(path)
            raise
        DISK.sync_folder(path.parent)
        shutil.rmtree(old, ignore_errors=True)
    except OSError as error:
        raise InputError(
            f"{path}: cannot be written ({error.strerror or error}); free space, or choose another name or folder"
        ) from error
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def check_new_folder(path: Path) -> None:
    """Refuse before the work a folder that could not be made after it, as `making_folder` does."""
    if is_folder(path):
        if any(path.iterdir()):
            raise InputError(f"{path}: holds files already, which are never mixed; remove it, or choose another name")
    elif os.path.lexists(path):
        raise InputError(f"{path}: is there already and is no folder; choose another name")
    elif not is_folder(path.absolute().parent):
        raise InputError(f"{path}: the folder {path.parent} does not exist; create it first")


def is_folder(path: Path) -> bool:
    """Tell whether a path is a folder; one that no name could be is none."""
    try:
        return path.is_dir()
    except OSError:
        return False


def read_limited(path: Path, most_bytes: int) -> bytes:
    """Read a small file whole, and nothing that has no end.

    Raises
    ------
    InputError
        The file is missing, unreadable, a folder, a device or a pipe, or larger than `most_bytes`.
    """
    try:
        if not stat.S_ISREG(path.stat().st_mode):
            raise InputError(f"{path}: is a {'folder' if path.is_dir() else 'device or a pipe'}; name a file")
        with path.open("rb") as file:
            content = file.read(most_bytes + 1)
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file; check the path") from error
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path and its permissions") from error
    if len(content) > most_bytes:
        raise InputError(f"{path}: larger than {most_bytes:,} bytes; that is not what is asked for here")
    return content


def decode_text(content: bytes) -> str:
    """Read text as UTF-8, with or without a byte order mark, else as old Windows programs write it."""
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")


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
