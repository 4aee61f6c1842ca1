"""Writing a capture folder, so that a frame that was acknowledged is never lost.

A frame goes to the disk whole and under its final name, and the folder that names it too, before its line goes into the
journal; only then does it count. A kill or a power cut at any instant leaves at most a file that no line speaks of.
"""

import hashlib
import json
import re
import shutil
from collections.abc import Iterable, Mapping
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any, Self

import cv2
import numpy as np
import tomli_w

from litrig.base.capture_folder import layout
from litrig.base.capture_folder.bag import close_bag
from litrig.base.capture_folder.crate import write_crate
from litrig.base.capture_folder.journal import Entry, Journal
from litrig.base.errors import InputError
from litrig.base.files import sync_folder, write_atomically
from litrig.base.lights import Lights
from litrig.base.lp import write_lp
from litrig.base.radiometry import U8

THUMB_WIDTH_PX = 160


class CaptureFolderWriter:
    """An open capture folder; a context manager that closes the journal, not the bag."""

    def __init__(self, folder: Path, journal: Journal, object_id: str) -> None:
        self.folder = folder
        self.object_id = object_id
        self._journal = journal
        self._digests: dict[str, str] = {}

    @classmethod
    def create(
        cls, folder: Path, object_id: str, session: Mapping[str, Any], plan: Iterable[Mapping[str, Any]]
    ) -> Self:
        """Lay out a new session: settings and plan first, then the journal that refers to them.

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
            undo.callback(_take_back, folder, absent)
            try:
                _lay_out(folder, settings, plan)
                journal = Journal(folder / layout.JOURNAL)
            except OSError as error:
                raise InputError(f"{folder}: cannot be created ({error.strerror}); choose another place") from error
            undo.callback(journal.close)
            writer = cls(folder, journal, object_id)
            writer.record("session", object=object_id, session_sha256=hashlib.sha256(settings).hexdigest())
            undo.pop_all()
        return writer

    def __enter__(self) -> Self:
        """Go on writing."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the journal; the folder stays an open session unless `close` was called."""
        self._journal.close()

    def record(self, event: str, **fields: Any) -> Entry:
        """Note that something happened; durable when it returns."""
        return self._journal.append(event, **fields)

    def add_frame(self, name: str, content: bytes, thumbnail: U8, **fields: Any) -> Entry:
        """Store a frame and acknowledge it.

        Parameters
        ----------
        name : file name below frames/
        content : the file as the camera made it; it is never rewritten
        thumbnail : (h, w, 3) uint8 RGB
        fields : what the journal says of it besides file, bytes and sha256
        """
        file = f"{layout.FRAMES}/{name}"
        if (self.folder / file).exists():
            raise InputError(f"{self.folder / file}: is there already; a frame is never overwritten")
        write_atomically(self.folder / file, content)
        self._write_thumb(name, thumbnail)
        digest = hashlib.sha256(content).hexdigest()
        entry = self.record("frame", file=file, bytes=len(content), sha256=digest, **fields)
        self._digests[file] = digest
        return entry

    def close(self, lights: Lights | None, *, version: str, instruments: Iterable[str], started: str) -> None:
        """End the session: exported light directions, description, and the manifests that make a valid bag of it."""
        if lights is not None:
            write_lp(self.folder / "data" / f"{self.object_id}.lp", lights)
        ended = str(self.record("close", frames=len(self._digests))["t"])
        self._journal.close()
        write_crate(
            self.folder,
            name=self.object_id,
            started=started,
            ended=ended,
            version=version,
            instruments=instruments,
        )
        info = {"Bag-Software-Agent": f"litrig {version}", "External-Identifier": self.object_id}
        close_bag(self.folder, self._digests, info)

    def _write_thumb(self, name: str, thumbnail: U8) -> None:
        # Convenience, not truth: no fsync, no word of it in the journal, and no session fails for want of one.
        good, encoded = cv2.imencode(".jpg", cv2.cvtColor(thumbnail, cv2.COLOR_RGB2BGR))
        with suppress(OSError):
            if good:
                (self.folder / layout.THUMBS / Path(name).with_suffix(".jpg").name).write_bytes(encoded.tobytes())


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


def _lay_out(folder: Path, settings: bytes, plan: Iterable[Mapping[str, Any]]) -> None:
    for name in (layout.FRAMES, layout.THUMBS):
        (folder / name).mkdir(parents=True, exist_ok=True)
    write_atomically(folder / layout.BAGIT, layout.BAGIT_DECLARATION.encode())
    write_atomically(folder / layout.SESSION, settings)
    steps = "".join(json.dumps(step, ensure_ascii=False) + "\n" for step in plan)
    write_atomically(folder / layout.PLAN, steps.encode())
    for made in (folder / "data", folder, folder.parent):
        sync_folder(made)


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
