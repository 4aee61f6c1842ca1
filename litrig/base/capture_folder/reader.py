"""Reading what was captured: a session's folder, or a plain folder of pictures with their poses beside.

A plain folder holds pictures and an `.lp` or a `.dome` (one light a picture), an `angles.csv` (`name,deg`), or both,
paired by file name. What such a list does not name is left alone; what it names and is not there is an error.
"""

import csv
import hashlib
import io
import json
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from litrig.base.capture_folder import layout
from litrig.base.capture_folder.bag import sha256_of
from litrig.base.capture_folder.capture import Capture, CapturedFrame, Exposure, Role
from litrig.base.capture_folder.frame_line import check_frame_lines
from litrig.base.capture_folder.journal import Entry, read_journal
from litrig.base.capture_folder.pairing import find_pictures, in_order, listed
from litrig.base.capture_folder.session_file import LARGEST_ANGLE_DEG, read_session_file
from litrig.base.directions import turn_between_deg
from litrig.base.errors import FormatError, InputError
from litrig.base.files import decode_text, read_limited, resolve_inside
from litrig.base.light_files import read_lights
from litrig.base.lights import Lights
from litrig.base.pictures import is_picture

ANGLES = "angles.csv"
LARGEST_ANGLES_BYTES = 4_000_000


def read_capture(folder: Path, but_not: Path | None = None) -> Capture:
    """Read a capture folder or a plain folder.

    Parameters
    ----------
    but_not : an `.lp` that is about to be written, and which an earlier run may have left in a plain folder

    Raises
    ------
    InputError, FormatError
        The folder is missing, holds no picture, names a picture that is not there, or a frame is not the one that was
        captured (its digest differs from the journal's). So with a session's settings, and a list that cannot be read.
    """
    if folder.is_file():
        raise InputError(f"{folder}: is a file; name the folder that holds the pictures")
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder; check the path")
    return _read_session(folder) if layout.is_capture_folder(folder) else _read_plain(folder, but_not)


def good_frames(entries: Iterable[Entry]) -> list[Entry]:
    """Pick from a journal the frame that counts for each step: the last good one that was not called back since."""
    latest: dict[Any, Entry] = {}
    for entry in entries:
        if entry.get("ev") == "frame" and entry.get("verdict") == "good":
            latest[entry["step"]] = entry
        elif entry.get("ev") == "recall":
            for step in entry["steps"]:
                latest.pop(step, None)
    return [latest[step] for step in sorted(latest)]


def pair_lights(capture: Capture, lights: Lights, source: Path) -> Capture:
    """Give each frame its light: by name, or in order where the list names none.

    Frames that a list does not name are left out, and named in the capture's remarks.

    Raises
    ------
    InputError
        The list names a picture that is not there, or names none and has more or fewer lights than there are pictures.
    """
    frames = {frame.path.name: frame for frame in capture.frames if frame.role is Role.FRAME}
    if lights.names is not None:
        names = find_pictures(lights.names, frames, source, capture.folder)
        left = sorted(set(frames) - set(names))
        remarks = [f"{source}: has no light for {listed(left)}; left out"] if left else []
    elif len(lights) == len(frames):
        names = in_order(frames)
        remarks = [
            f"{source}: names no pictures; paired in their order, {names[0]} first; check that it is the lights'"
        ]
    else:
        raise InputError(
            f"{source}: has {len(lights)} lights without names, and {capture.folder} {len(frames)} pictures; name them"
        )
    paired = tuple(_lit(frames[name], lights, index) for index, name in enumerate(names))
    others = tuple(frame for frame in capture.frames if frame.role is not Role.FRAME)
    return replace(
        capture,
        frames=paired + others,
        picture_width_mm=lights.picture_width_mm,
        lights_from=source,
        remarks=(*capture.remarks, *remarks),
    )


def _lit(frame: CapturedFrame, lights: Lights, index: int) -> CapturedFrame:
    return replace(
        frame,
        light=lights.directions[index],
        light_position_mm=None if lights.positions_mm is None else lights.positions_mm[index],
        light_gain=None if lights.gains is None else lights.gains[index],
    )


def with_references(capture: Capture, white: Path | None, dark: Path | None) -> Capture:
    """Add a picture of a white card, and one in the dark, to the frames of a plain folder.

    Raises
    ------
    InputError
        The session has such frames already.
    """
    frames = capture.frames
    for role, path in ((Role.WHITE, white), (Role.DARK, dark)):
        if path is None:
            continue
        if any(frame.role is role for frame in frames):
            raise InputError(f"{capture.folder}: has frames of role {role} already; leave --{role} out")
        named = path.absolute()
        frames = (*(frame for frame in frames if frame.path.absolute() != named), CapturedFrame(path, role))
    return replace(capture, frames=frames)


def turn_evenly(capture: Capture) -> Capture:
    """Spread the frames of a plain folder evenly over one turn, in the order of their names.

    Raises
    ------
    InputError
        A frame has an angle already.
    """
    known = [frame.path.name for frame in capture.frames if frame.angle_deg is not None]
    if known:
        raise InputError(f"{capture.folder}: {listed(known)} have turntable angles already; leave --even out")
    if any(frame.light is not None for frame in capture.frames):
        raise InputError(f"{capture.folder}: was shot under many lights, not in a turn; give it to litrig ptm fit")
    frames = [frame for frame in capture.frames if frame.role is Role.FRAME]
    others = tuple(frame for frame in capture.frames if frame.role is not Role.FRAME)
    step_deg = 360 / max(1, len(frames))
    turned = tuple(replace(frame, angle_deg=step_deg * index) for index, frame in enumerate(frames))
    return replace(capture, frames=turned + others)


def unnamed_pictures(capture: Capture) -> list[str]:
    """Name the pictures of a plain folder that its `.lp` or `angles.csv` does not, and which are therefore left out."""
    if layout.is_capture_folder(capture.folder):
        return []
    named = {frame.path.name for frame in capture.frames}
    there = (path.name for path in capture.folder.iterdir() if path.is_file() and is_picture(path))
    return sorted(name for name in there if name not in named)


def _read_session(folder: Path) -> Capture:
    journal = read_journal(folder / layout.JOURNAL)
    check_frame_lines(journal, folder / layout.JOURNAL)
    entries = good_frames(journal)
    if not entries:
        raise InputError(f"{folder}: the session holds no good frame; capture it again")
    settings = read_session_file(folder, journal)
    return Capture(
        folder=folder,
        object_id=settings.session.object or folder.name,
        frames=tuple(_session_frame(folder, alike) for alike in _by_pose(entries)),
        tangent_zero_deg=settings.session.tangent_zero_deg,
        sphere_distance_radii=settings.rig.sample.sphere_distance_radii,
        digest=_digest((Path(entry["file"]).name, entry["sha256"]) for entry in entries),
    )


def _by_pose(entries: Iterable[Entry]) -> list[list[Entry]]:
    """Put together what was shot at one pose for one purpose: brackets, averages, and turns after the first."""
    poses: dict[str, list[Entry]] = {}
    for entry in entries:
        goal = dict(entry.get("pose_goal") or {"step": entry["step"]})
        if "angle_deg" in goal:
            goal["angle_deg"] = round(goal["angle_deg"] % 360, 6)
        poses.setdefault(json.dumps([entry.get("role"), goal], sort_keys=True), []).append(entry)
    return list(poses.values())


def _session_frame(folder: Path, alike: list[Entry]) -> CapturedFrame:
    exposures = tuple(Exposure(_checked(folder, entry), entry.get("exposure_ev", 0.0)) for entry in alike)
    usual = min(range(len(alike)), key=lambda place: abs(exposures[place].exposure_ev))
    lights = [np.array(entry["light"], np.float64) for entry in alike if entry.get("light") is not None]
    poses = [entry.get("pose_after") or {} for entry in alike]
    angles_deg = [pose["angle_deg"] for pose in poses if pose.get("angle_deg") is not None]
    return CapturedFrame(
        path=exposures[usual].path,
        role=Role(alike[usual].get("role", "frame")),
        angle_deg=_middle_deg(angles_deg) if angles_deg else None,
        light=_middle(lights) if lights else None,
        exposures=exposures if len(exposures) > 1 else (),
    )


def _checked(folder: Path, entry: Entry) -> Path:
    path = resolve_inside(folder, entry["file"])
    if not path.is_file():
        raise InputError(f"{path}: is in the journal and not on the disk; restore it from a copy")
    if sha256_of(path) != entry["sha256"]:
        raise FormatError(f"{path}: changed since it was captured (its sha256 differs); restore it from a copy")
    return path


def _middle_deg(angles_deg: list[float]) -> float:
    """Return the mean of angles that lie close together, perhaps some turns apart; the turn is that of the first."""
    first = angles_deg[0]
    return first + float(np.mean([turn_between_deg(angle, first) for angle in angles_deg]))


def _middle(lights: list[NDArray[np.float64]]) -> NDArray[np.float64]:
    if len(lights) == 1:
        return lights[0]
    total = np.sum(lights, axis=0)
    return np.asarray(total / np.linalg.norm(total), np.float64)


def _read_plain(folder: Path, but_not: Path | None) -> Capture:
    pictures = sorted(path for path in folder.iterdir() if path.is_file() and is_picture(path))
    if not pictures:
        raise InputError(f"{folder}: holds no picture; name a capture folder or a folder of pictures")
    digest = _digest((path.name, sha256_of(path)) for path in pictures)
    capture = Capture(folder, folder.resolve().name, tuple(CapturedFrame(path) for path in pictures), digest=digest)
    unread = None if but_not is None else but_not.absolute()
    lists = _lists(folder, ".lp", unread) or _lists(folder, ".dome", unread)
    if len(lists) > 1:
        raise InputError(f"{folder}: holds {listed([path.name for path in lists])}; keep one .lp, or name it with --lp")
    angles = _read_angles(folder / ANGLES, {path.name for path in pictures}) if (folder / ANGLES).exists() else {}
    if lists:
        # The .lp says which pictures are meant; the angles of any others are left alone like their pictures.
        lit = pair_lights(capture, read_lights(lists[0]), lists[0])
        return replace(lit, frames=tuple(_turned(frame, angles) for frame in lit.frames))
    if angles:
        frames = {frame.path.name: frame for frame in capture.frames}
        return replace(capture, frames=tuple(_turned(frames[name], angles) for name in angles))
    return capture


def _lists(folder: Path, ending: str, unread: Path | None) -> list[Path]:
    return sorted(path for path in folder.iterdir() if path.suffix.lower() == ending and path.absolute() != unread)


def _turned(frame: CapturedFrame, angles_deg: Mapping[str, float]) -> CapturedFrame:
    return replace(frame, angle_deg=angles_deg.get(frame.path.name))


def _read_angles(path: Path, pictures: Collection[str]) -> dict[str, float]:
    """Read turntable angles in degrees by picture name, in the file's order."""
    angles_deg: dict[str, float] = {}
    for place, name, angle_deg in _angle_rows(path):
        if name not in pictures:
            raise InputError(f"{place}: {name} is not in the folder; copy it or mend the name")
        if name in angles_deg:
            raise FormatError(f"{place}: {name} stands twice; keep one line a picture")
        angles_deg[name] = angle_deg
    return angles_deg


def _angle_rows(path: Path) -> Iterator[tuple[str, str, float]]:
    """Yield where a row stands, its picture and its angle."""
    rows = csv.reader(io.StringIO(decode_text(read_limited(path, LARGEST_ANGLES_BYTES)), newline=""))
    try:
        for row in rows:
            if row and row[0].strip() != "name":
                yield f"{path}, line {rows.line_num}", *_parse_row(row)
    except (csv.Error, IndexError, ValueError) as error:
        raise FormatError(f"{path}, line {rows.line_num}: expected `name,deg` ({error}); mend that line") from error


def _parse_row(row: list[str]) -> tuple[str, float]:
    name, angle_deg = row[0].strip(), float(row[1])
    if not abs(angle_deg) <= LARGEST_ANGLE_DEG:
        raise ValueError(f"{angle_deg:g} is outside ±{LARGEST_ANGLE_DEG:g} deg")
    return name, angle_deg


def _digest(items: Iterable[tuple[str, str]]) -> str:
    return hashlib.sha256("".join(f"{digest}  {name}\n" for name, digest in items).encode()).hexdigest()
