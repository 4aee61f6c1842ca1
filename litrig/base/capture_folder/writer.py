"""Writing a capture folder, so that a frame that was acknowledged is never lost.

A frame goes to the disk whole and under its final name, and the folder that names it too, before its line goes into the
journal; only then does it count. A kill or a power cut at any instant leaves at most a file that no line speaks of.
"""

import hashlib
import json
import re
import shutil
from collections.abc import Iterable, Mapping, Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any, Self

import cv2
import numpy as np
import tomli_w

from litrig.base.capture_folder import layout
from litrig.base.capture_folder.bag import close_bag
from litrig.base.capture_folder.crate import Description, crate_of
from litrig.base.capture_folder.frame_line import check_frame_lines
from litrig.base.capture_folder.journal import Entry, Journal, known_harm, read_journal
from litrig.base.capture_folder.lock import FolderLock
from litrig.base.errors import FormatError, InputError
from litrig.base.files import TEMPORARY, write_atomically
from litrig.base.lights import Lights
from litrig.base.lp import lp_text
from litrig.base.radiometry import U8
from litrig.base.store import DISK, Store

THUMB_WIDTH_PX = 160


class CaptureFolderWriter:
    """An open capture folder; a context manager that lets go of the folder, and does not close the bag.

    Attributes
    ----------
    folder : where it lies
    object_id : what is on the table
    """

    def __init__(
        self, folder: Path, journal: Journal, object_id: str, lock: FolderLock | None = None, store: Store = DISK
    ) -> None:
        self.folder = folder
        self.object_id = object_id
        self._journal, self._lock, self._store = journal, lock, store
        self._digests: dict[str, str] = {}
        self._taken: set[str] = set()

    @classmethod
    def create(
        cls,
        folder: Path,
        object_id: str,
        session: Mapping[str, Any],
        plan: Iterable[Mapping[str, Any]],
        *,
        store: Store = DISK,
    ) -> Self:
        """Lay out a new session: settings and plan first, then the journal that vouches for them.

        Parameters
        ----------
        folder : absent or empty
        session : the resolved settings, frozen as session.toml
        plan : the wanted steps, one JSON object each

        Raises
        ------
        InputError
            The folder holds something, or cannot be written; nothing is left behind.
        """
        check_free(folder)
        absent = [place for place in (folder, *folder.parents) if not place.exists()]
        settings = tomli_w.dumps(session).encode()
        with ExitStack() as undo:
            try:
                _claim(folder, absent, store)
                undo.callback(_take_back, folder, absent)
                steps = "".join(json.dumps(step, ensure_ascii=False) + "\n" for step in plan).encode()
                _lay_out(folder, settings, steps, absent, store)
            except OSError as error:
                raise InputError(f"{folder}: cannot be created ({error.strerror}); choose another place") from error
            journal = Journal(folder / layout.JOURNAL, store=store)
            digests = {"session_sha256": _sha256(settings), "plan_sha256": _sha256(steps)}
            journal.append("session", object=object_id, **digests)
            undo.pop_all()  # from its first line on it is a session, which another process may go on with
        return cls(folder, journal, object_id, FolderLock(folder), store)

    @classmethod
    def reopen(cls, folder: Path, lock: FolderLock, *, store: Store = DISK) -> Self:
        """Go on with a session, whatever state it was left in; a closed bag is opened again.

        Parameters
        ----------
        lock : of that folder, held

        Raises
        ------
        InputError, FormatError
            Its journal is damaged or does not begin with a session, or the folder cannot be written.
        """
        path = folder / layout.JOURNAL
        entries = read_journal(path)
        check_frame_lines(entries, path)
        object_id = entries[0].get("object") if entries and entries[0]["ev"] == "session" else None
        if not isinstance(object_id, str):
            raise FormatError(f"{path}: does not begin with a session; nothing was shot, capture anew")
        writer = cls(folder, Journal(path, store=store), object_id, lock, store)
        digests = {entry["file"]: entry["sha256"] for entry in entries if entry["ev"] == "frame"}
        writer._taken = set(digests)
        writer._digests = {file: digest for file, digest in digests.items() if file not in known_harm(entries)}
        writer._open_bag()
        return writer

    def __enter__(self) -> Self:
        """Go on writing."""
        return self

    def __exit__(self, *_: object) -> None:
        """Let go of the folder; it stays an open session unless `close` was called."""
        if self._lock is not None:
            self._lock.release()

    @property
    def torn_bytes(self) -> int:
        """How many bytes behind the journal's last whole line the next line will cut off."""
        return self._journal.torn_bytes

    def record(self, event: str, **fields: Any) -> Entry:
        """Write an entry into the journal; it is durable when this returns."""
        return self._journal.append(event, **fields)

    def unused_name(self, stem: str, ending: str) -> str:
        """Return a name below frames/ that no file has or had, for nothing is ever overwritten, counting or not.

        It is the stem with the ending, or with `_try2`, `_try3` and so on before the ending.
        """
        name, attempt = stem + ending, 1
        while f"{layout.FRAMES}/{name}" in self._taken or (self.folder / layout.FRAMES / name).exists():
            attempt += 1
            name = f"{stem}_try{attempt}{ending}"
        return name

    def add_frame(self, name: str, content: bytes, thumbnail: U8, **fields: Any) -> Entry:
        """Store a frame and acknowledge it; when this returns, no power cut can lose it.

        Parameters
        ----------
        name : file name below frames/
        content : the file as the camera made it; it is never rewritten
        thumbnail : (h, w, 3) uint8 RGB
        fields : what the journal says of it besides file, bytes and sha256

        Raises
        ------
        InputError
            A file of that name is there, or the disk is full or gone.
        """
        file = f"{layout.FRAMES}/{name}"
        if (self.folder / file).exists():
            raise InputError(f"{self.folder / file}: is there already; a frame is never overwritten")
        write_atomically(self.folder / file, content, store=self._store)
        self._write_thumb(name, thumbnail)
        digest = _sha256(content)
        entry = self.record("frame", file=file, bytes=len(content), sha256=digest, **fields)
        self._digests[file] = digest
        self._taken.add(file)
        return entry

    def recall(self, steps: Sequence[int], reason: str, harmed: Sequence[str] = ()) -> None:
        """Take note that frames count no longer.

        Parameters
        ----------
        harmed : files that are not as they were shot: the bag will vouch for what they are now
        """
        self.record("recall", steps=list(steps), reason=reason, **({"files": list(harmed)} if harmed else {}))
        for file in harmed:
            self._digests.pop(file, None)

    def add_settings(self, name: str, settings: Mapping[str, Any]) -> str:
        """Freeze further settings beside the first, and return their sha256."""
        content = tomli_w.dumps(settings).encode()
        write_atomically(self.folder / "data" / name, content, store=self._store)
        return _sha256(content)

    def add_note(self, text: str) -> None:
        """Add a paragraph to the notes, and to the journal."""
        notes = self.folder / layout.NOTES
        before = notes.read_bytes() + b"\n" if notes.exists() else b""
        write_atomically(notes, before + text.strip().encode() + b"\n", store=self._store)
        self.record("note", text=text.strip())

    def describe(self, about: Description) -> None:
        """Write the RO-Crate description of what lies there now."""
        write_atomically(self.folder / layout.CRATE, crate_of(self.folder, self.object_id, about), store=self._store)

    def close(self, lights: Lights | None, about: Description) -> None:
        """End the session: exported light directions, description, and the manifests that make a valid bag of it."""
        if lights is not None:
            path = self.folder / "data" / f"{self.object_id}.lp"
            write_atomically(path, lp_text(path, lights), store=self._store)
        ended = str(self.record("close", frames=len(self._digests))["t"])
        self.describe(about.ending(ended))
        info = {"Bag-Software-Agent": f"litrig {about.version}", "External-Identifier": self.object_id}
        if about.operator:
            info["Contact-Name"] = about.operator
        close_bag(self.folder, self._digests, info, self._store)

    def _open_bag(self) -> None:
        """Take the files away that make a bag complete; only then the journal, which they vouch for, may grow.

        The last written goes first, and for good before the others: what a kill or a power cut leaves in between is
        an open bag. Beside them may lie what a kill left of such a file under its temporary name.
        """
        tags = [self.folder / name for name in (layout.TAG_MANIFEST, layout.MANIFEST, layout.BAG_INFO)]
        standing = [tag for tag in tags if tag.exists()]
        remains = sorted(self.folder.glob(TEMPORARY))
        try:
            for path in (*standing, *remains):
                self._store.remove(path)
                self._store.sync_folder(self.folder)
        except OSError as error:
            raise InputError(f"{self.folder}: cannot be written ({error.strerror}); check the disk") from error
        if standing:
            self.record("reopened")

    def _write_thumb(self, name: str, thumbnail: U8) -> None:
        # Convenience, not truth: no fsync, no word of it in the journal, and no session fails for want of one.
        good, encoded = cv2.imencode(".jpg", cv2.cvtColor(thumbnail, cv2.COLOR_RGB2BGR))
        if good:
            path = self.folder / layout.THUMBS / Path(name).with_suffix(".jpg").name
            try:
                self._store.write(path, encoded.tobytes())
            except OSError:
                with suppress(OSError):  # rather none than half of one
                    self._store.remove(path)


def check_free(folder: Path) -> None:
    """Refuse a folder that holds something: a session is never written over another.

    Raises
    ------
    InputError
        It is a file, the folder is not empty, or there can be none of that name.
    """
    try:
        if folder.exists() and not folder.is_dir():
            raise InputError(f"{folder}: is a file; a session needs a folder of its own, choose another name")
        if folder.exists() and any(folder.iterdir()):
            raise InputError(f"{folder}: is not empty; a session needs a folder of its own, choose another name")
    except OSError as error:
        raise InputError(f"{folder}: cannot be a session's folder ({error.strerror}); choose another name") from error


def _claim(folder: Path, absent: Iterable[Path], store: Store) -> None:
    """Make the folder and the one inside that only one of several writers can make."""
    try:
        for place in reversed(list(absent)):
            store.make_folder(place)
        store.make_folder(folder / "data")
    except FileExistsError as error:
        raise InputError(f"{folder}: another process makes a session there; choose another name") from error


def _lay_out(folder: Path, settings: bytes, steps: bytes, absent: Iterable[Path], store: Store) -> None:
    for name in (layout.FRAMES, layout.THUMBS):
        store.make_folder(folder / name)
    write_atomically(folder / layout.BAGIT, layout.BAGIT_DECLARATION.encode(), store=store)
    write_atomically(folder / layout.SESSION, settings, store=store)
    write_atomically(folder / layout.PLAN, steps, store=store)
    for made in (folder / "data", folder, *(place.parent for place in absent)):
        store.sync_folder(made)


def _take_back(folder: Path, absent: Iterable[Path]) -> None:
    """Remove what stands in a folder that was empty, and the folders that were not there, the innermost first."""
    with suppress(OSError):
        shutil.rmtree(folder / "data", ignore_errors=True)
        (folder / layout.BAGIT).unlink(missing_ok=True)
        for place in absent:
            place.rmdir()


def check_object_id(object_id: str) -> str:
    """Refuse an object id that cannot be part of a file name on every system."""
    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}", object_id):
        raise InputError(f"object id {object_id!r}: use up to 64 letters, digits, dots, dashes and underscores")
    return object_id


def make_thumbnail(codes: U8) -> U8:
    """Shrink a picture (H, W, 3) to a thumbnail's width."""
    height = max(1, round(codes.shape[0] * THUMB_WIDTH_PX / codes.shape[1]))
    return np.asarray(cv2.resize(codes, (THUMB_WIDTH_PX, height), interpolation=cv2.INTER_AREA), np.uint8)


def _sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
