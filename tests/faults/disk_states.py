"""What a power cut may leave of a folder: a store that notes its operations, and a model of what a disk promises.

Until a file is synced, a cut may lose what was written, tear it, turn it to zeros or keep it. Until a folder is synced,
a name that came, went or changed in it may have done so or not, each by itself; a rename alone is never half done.
(The model of crash-consistency checkers such as ALICE, Pillai et al., OSDI 2014.)
"""

import random
import threading
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Union

from litrig.base.store import DISK, Store

Tree = dict[str, Union[bytes, "Tree"]]
"""What lies in a folder, by name."""


@dataclass(frozen=True)
class Operation:
    """One operation of a store, by the name of its method; `target` is the new name of a rename."""

    kind: str
    path: Path
    content: bytes = b""
    size: int = 0
    target: Path = Path()


class RecordingStore:
    """Fits `litrig.base.store.Store`: does what it is told, and notes it."""

    def __init__(self, disk: Store = DISK) -> None:
        self.operations: list[Operation] = []
        self._disk = disk
        self._one_at_a_time = threading.Lock()

    def make_folder(self, folder: Path) -> None:
        self._do(lambda: self._disk.make_folder(folder), Operation("make_folder", folder))

    def write(self, path: Path, *parts: bytes) -> None:
        self._do(lambda: self._disk.write(path, *parts), Operation("write", path, b"".join(parts)))

    def append(self, path: Path, content: bytes) -> None:
        self._do(lambda: self._disk.append(path, content), Operation("append", path, content))

    def cut(self, path: Path, size: int) -> None:
        self._do(lambda: self._disk.cut(path, size), Operation("cut", path, size=size))

    def sync(self, path: Path) -> None:
        self._do(lambda: self._disk.sync(path), Operation("sync", path))

    def rename(self, source: Path, target: Path) -> None:
        self._do(lambda: self._disk.rename(source, target), Operation("rename", source, target=target))

    def remove(self, path: Path) -> None:
        self._do(lambda: self._disk.remove(path), Operation("remove", path))

    def sync_folder(self, folder: Path) -> None:
        self._do(lambda: self._disk.sync_folder(folder), Operation("sync_folder", folder))

    def _do(self, action: Callable[[], None], operation: Operation) -> None:
        with self._one_at_a_time:
            action()
            self.operations.append(operation)


class ForgetfulStore(RecordingStore):
    """Leaves an operation out, as a program does that was written without it."""

    def __init__(self, left_out: str) -> None:
        super().__init__()
        self._left_out = left_out

    def _do(self, action: Callable[[], None], operation: Operation) -> None:
        if operation.kind != self._left_out:
            super()._do(action, operation)


# What a disk holds, for certain and perhaps


@dataclass
class _File:
    """`durable` is what a cut cannot change; the first `kept` bytes of it have not been touched since."""

    durable: bytes = b""
    now: bytes = b""
    kept: int = 0

    def change(self, content: bytes, kept: int) -> None:
        self.now, self.kept = content, min(self.kept, kept)

    def sync(self) -> None:
        self.durable, self.kept = self.now, len(self.now)


@dataclass
class _Folder:
    """Names for certain, and the changes of names since: each sets names, or takes them away (None)."""

    durable: dict[str, Union[_File, "_Folder"]] = field(default_factory=dict)
    pending: list[dict[str, Union[_File, "_Folder", None]]] = field(default_factory=list)

    def names(self, is_kept: Callable[[], bool] = lambda: True) -> dict[str, Union[_File, "_Folder"]]:
        names = dict(self.durable)
        for change in self.pending:
            if is_kept():
                for name, node in change.items():
                    if node is None:
                        names.pop(name, None)
                    else:
                        names[name] = node
        return names

    def sync(self) -> None:
        self.durable, self.pending = self.names(), []


class ModelDisk:
    """Follows the operations on everything below a folder that is there from the start."""

    def __init__(self, root: Path) -> None:
        self._root_path, self._root = root, _Folder()

    def apply(self, operation: Operation) -> None:
        """Follow one operation."""
        path = operation.path
        if operation.kind == "sync_folder":
            self._folder(path).sync()
            return
        above = self._folder(path.parent)
        node = above.names().get(path.name)
        if operation.kind == "make_folder":
            above.pending.append({path.name: _Folder()})
        elif operation.kind == "remove":
            above.pending.append({path.name: None})
        elif operation.kind == "rename":
            assert operation.target.parent == path.parent
            above.pending.append({path.name: None, operation.target.name: node})
        else:
            if node is None:
                node = _File()
                above.pending.append({path.name: node})
            assert isinstance(node, _File)
            self._change(node, operation)

    def survivors(self, fate: "Fate") -> Tree:
        """Return what is there after a cut now."""
        return _survivors(self._root, fate)

    def _change(self, file: _File, operation: Operation) -> None:
        if operation.kind == "write":
            file.change(operation.content, 0)
        elif operation.kind == "append":
            file.change(file.now + operation.content, len(file.now))
        elif operation.kind == "cut":
            file.change(file.now[: operation.size], operation.size)
        else:
            file.sync()

    def _folder(self, path: Path) -> _Folder:
        folder = self._root
        for name in path.relative_to(self._root_path).parts:
            below = folder.names()[name]
            assert isinstance(below, _Folder)
            folder = below
        return folder


@dataclass(frozen=True)
class Fate:
    """What becomes of what was not synced: asked once for each change of a name, and once for each file.

    `content` chooses among "lost", "torn", "zeroed", "overlaid" and "whole"; `share` says where it is torn.
    """

    name: Callable[[], bool]
    content: Callable[[], str]
    share: Callable[[], float] = lambda: 0.5


CONTENTS = ("lost", "torn", "zeroed", "overlaid", "whole")
EXTREMES = tuple(
    Fate(lambda kept=kept: kept, lambda content=content: content)  # type: ignore[misc]
    for kept in (True, False)
    for content in CONTENTS
)


def random_fate(chance: random.Random) -> Fate:
    return Fate(lambda: chance.random() < 0.5, lambda: chance.choice(CONTENTS), chance.random)


def _survivors(folder: _Folder, fate: Fate) -> Tree:
    return {
        name: _survivors(node, fate) if isinstance(node, _Folder) else _content(node, fate)
        for name, node in sorted(folder.names(fate.name).items())
    }


def _content(file: _File, fate: Fate) -> bytes:
    if file.kept == len(file.durable) == len(file.now):
        return file.durable
    kept, changed = file.durable[: file.kept], file.now[file.kept :]
    match fate.content():
        case "lost":
            return file.durable
        case "torn":
            return kept + changed[: int(fate.share() * len(changed))]
        case "zeroed":
            return kept + bytes(len(changed))
        case "overlaid":  # written, and not cut short before that
            return file.now + file.durable[len(file.now) :]
        case _:
            return file.now


def paths(tree: Tree, above: str = "") -> Iterator[tuple[str, bytes | None]]:
    """Go through files with their content, and folders without."""
    for name, content in tree.items():
        if isinstance(content, bytes):
            yield above + name, content
        else:
            yield above + name, None
            yield from paths(content, f"{above}{name}/")


def lay_out(tree: Mapping[str, bytes | Tree], folder: Path) -> None:
    """Write a tree into a folder that is empty."""
    for name, content in tree.items():
        if isinstance(content, bytes):
            (folder / name).write_bytes(content)
        else:
            (folder / name).mkdir()
            lay_out(content, folder / name)
