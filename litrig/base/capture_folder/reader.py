"""Reading what was captured: a session's folder, or a plain folder of pictures with their poses beside.

A plain folder holds pictures and an `.lp` (one light direction a picture) or an `angles.csv` (`name,deg`), paired by
file name. What such a list does not name is left alone; what it names and is not there is an error.
"""

import csv
import hashlib
import tomllib
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from litrig.base.capture_folder import layout
from litrig.base.capture_folder.bag import sha256_of
from litrig.base.capture_folder.capture import Capture, CapturedFrame, Role
from litrig.base.capture_folder.journal import Entry, read_journal
from litrig.base.errors import FormatError, InputError
from litrig.base.files import resolve_inside
from litrig.base.lp import LightDirections, read_lp
from litrig.base.pictures import is_picture

ANGLES = "angles.csv"


def read_capture(folder: Path) -> Capture:
    """Read a capture folder or a plain folder.

    Raises
    ------
    InputError, FormatError
        The folder is missing, holds no picture, names a picture that is not there, or a frame is not the one that was
        captured (its digest differs from the journal's).
    """
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder; check the path")
    return _read_session(folder) if layout.is_capture_folder(folder) else _read_plain(folder)


def good_frames(entries: Iterable[Entry]) -> list[Entry]:
    """Pick from a journal the frame that counts for each step: the last good one."""
    latest: dict[Any, Entry] = {}
    for entry in entries:
        if entry["ev"] == "frame" and entry.get("verdict") == "good":
            latest[entry["step"]] = entry
    return [latest[step] for step in sorted(latest)]


def pair_lights(capture: Capture, lights: LightDirections, source: Path) -> Capture:
    """Give each frame the direction that a list names for it; frames that it does not name are left out.

    Raises
    ------
    InputError
        The list names a picture that is not there.
    """
    frames = {frame.path.name: frame for frame in capture.frames if frame.role is Role.FRAME}
    missing = [name for name in lights.names if name not in frames]
    if missing:
        raise InputError(
            f"{source}: names {_some(missing)}, not found in {capture.folder}; copy the pictures or mend the names"
        )
    paired = zip(lights.names, lights.directions, strict=True)
    return replace(capture, frames=tuple(replace(frames[name], light=light) for name, light in paired))


def _read_session(folder: Path) -> Capture:
    entries = good_frames(read_journal(folder / layout.JOURNAL))
    if not entries:
        raise InputError(f"{folder}: the session holds no good frame; capture it again")
    settings = _read_settings(folder)
    return Capture(
        folder=folder,
        object_id=str(settings.get("session", {}).get("object", folder.name)),
        frames=tuple(_session_frame(folder, entry) for entry in entries),
        tangent_zero_deg=float(settings.get("session", {}).get("tangent_zero_deg", 0.0)),
        sphere_distance_radii=settings.get("rig", {}).get("sample", {}).get("sphere_distance_radii"),
        digest=_digest((Path(entry["file"]).name, entry["sha256"]) for entry in entries),
    )


def _session_frame(folder: Path, entry: Entry) -> CapturedFrame:
    path = resolve_inside(folder, entry["file"])
    if not path.is_file():
        raise InputError(f"{path}: is in the journal and not on the disk; restore it from a copy")
    if sha256_of(path) != entry["sha256"]:
        raise FormatError(f"{path}: changed since it was captured (its sha256 differs); restore it from a copy")
    light = entry.get("light")
    pose = entry.get("pose_after") or {}
    return CapturedFrame(
        path=path,
        role=Role(entry.get("role", "frame")),
        angle_deg=pose.get("angle_deg"),
        light=None if light is None else np.array(light, np.float64),
    )


def _read_settings(folder: Path) -> dict[str, Any]:
    path = folder / layout.SESSION
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise FormatError(f"{path}: cannot be read ({error}); restore it from a copy") from error


def _read_plain(folder: Path) -> Capture:
    pictures = sorted(path for path in folder.iterdir() if path.is_file() and is_picture(path))
    if not pictures:
        raise InputError(f"{folder}: holds no picture; name a capture folder or a folder of pictures")
    digest = _digest((path.name, sha256_of(path)) for path in pictures)
    capture = Capture(folder, folder.resolve().name, tuple(CapturedFrame(path) for path in pictures), digest=digest)
    lists = sorted(folder.glob("*.lp"))
    if len(lists) > 1:
        raise InputError(f"{folder}: holds {_some([path.name for path in lists])}; keep one .lp, or name it with --lp")
    if lists:
        return pair_lights(capture, read_lp(lists[0]), lists[0])
    if (folder / ANGLES).is_file():
        return _pair_angles(capture, folder / ANGLES)
    return capture


def _pair_angles(capture: Capture, path: Path) -> Capture:
    frames = {frame.path.name: frame for frame in capture.frames}
    paired: dict[str, CapturedFrame] = {}
    with path.open(newline="", encoding="utf-8-sig") as file:
        for number, row in enumerate(csv.reader(file), 1):
            if not row or row[0].strip() == "name":
                continue
            try:
                name, angle_deg = row[0].strip(), float(row[1])
            except (IndexError, ValueError) as error:
                raise FormatError(
                    f"{path}, line {number}: expected `name,deg`, found {','.join(row)[:60]!r}"
                ) from error
            if name not in frames:
                raise InputError(f"{path}, line {number}: {name} is not in the folder; copy it or mend the name")
            if name in paired:
                raise FormatError(f"{path}, line {number}: {name} stands twice; keep one line a picture")
            paired[name] = replace(frames[name], angle_deg=angle_deg)
    return replace(capture, frames=tuple(paired.values()))


def _digest(items: Iterable[tuple[str, str]]) -> str:
    return hashlib.sha256("".join(f"{digest}  {name}\n" for name, digest in items).encode()).hexdigest()


def _some(names: list[str]) -> str:
    return ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
