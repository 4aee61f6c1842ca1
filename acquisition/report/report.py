"""A session looked back at: a page of pictures, plots and words beside its folder."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from acquisition.consistency import Suspect, suspects_among
from acquisition.report import sections
from acquisition.report.cells import Cell, Flag, cells_of, in_order_of_pose
from acquisition.report.record import SessionRecord, read_record, wall_time
from acquisition.report.story import Happening, Standing, segments, standing, story
from acquisition.report.times import StepTimes, step_times
from litrig.base.capture_folder.reader import good_frames
from litrig.base.errors import InputError
from litrig.base.files import making_folder, read_limited, write_atomically
from litrig.base.page import Section, Table, write_page
from litrig.base.version import litrig_version

PAGE, SUMMARY = "index.html", "report.json"
KIND = "capture report"
_LARGEST_SUMMARY_BYTES = 50_000_000
_MOST_LISTED = 12


@dataclass(frozen=True)
class Report:
    """What is said of a session.

    Attributes
    ----------
    page : the page, once it is written
    summary : the same for programs
    """

    page: Path
    summary: Mapping[str, Any]


def write_report(folder: Path, output: Path | None = None) -> Report:
    """Write the report of a session in any state; an earlier report there is replaced.

    Parameters
    ----------
    output : folder of the report; by default FOLDER.report beside the session

    Raises
    ------
    InputError, FormatError
        It is no capture folder, its journal is damaged, or the output is inside it, or holds something else.
    """
    place = folder.resolve().with_name(f"{folder.resolve().name}.report") if output is None else output
    if place.resolve().is_relative_to(folder.resolve()):
        raise InputError(f"{place}: lies in the session's own folder, which holds what was shot and nothing else")
    record = read_record(folder)
    found = suspects_among(folder, good_frames(record.entries))
    told, stands, spent = story(record), standing(record), step_times(record)
    cells = cells_of(record, found)
    summary = _summary(record, cells, found, told, stands, spent)
    with making_folder(place, _is_report) as temporary:
        drawing = sections.Drawing(temporary, record, in_order_of_pose(cells), found)
        parts = [
            _at_a_glance(record, cells, stands, spent),
            _to_look_at(record, cells, found),
            sections.contact_sheets(drawing),
            sections.lights(drawing),
            sections.exposure(drawing),
            sections.focus_and_lamps(drawing),
            sections.poses(drawing),
            sections.times(drawing, spent),
            sections.happened(told),
            sections.notes(record),
            sections.every_frame(drawing),
            *sections.configuration(record),
        ]
        write_page(temporary / PAGE, record.object_id, _lead(record, stands), [part for part in parts if part])
        summary["files"] = sorted(path.name for path in temporary.iterdir())
        write_atomically(temporary / SUMMARY, json.dumps(summary, indent=1, ensure_ascii=False).encode())
    return Report(place / PAGE, summary)


def _is_report(folder: Path) -> bool:
    """Tell whether a folder is an earlier report, and holds nothing that somebody else put there."""
    try:
        summary = json.loads(read_limited(folder / SUMMARY, _LARGEST_SUMMARY_BYTES))
    except (InputError, ValueError, RecursionError):
        return False
    if not isinstance(summary, dict) or summary.get("litrig.kind") != KIND:
        return False
    return {path.name for path in folder.iterdir()} <= {SUMMARY, *map(str, summary.get("files", ()))}


def _lead(record: SessionRecord, stands: Standing) -> str:
    count, wanted = len(record.counting), len(record.wanted)
    frames = f"All {wanted} frames" if count == wanted else f"{count} of {wanted} frames"
    by = f" by {record.operator}" if record.operator else ""
    files = "every file is as it was captured" if not record.findings else "not every file is as it was captured"
    return f"{frames}, shot{by} {_when(record)}. The session is {stands.state.value}; {files}."


def _when(record: SessionRecord) -> str:
    first, last = (wall_time(record.entries[index].get("t")) for index in (0, -1))
    if first is None or last is None:
        return "at a time that its journal does not tell"
    if f"{first:%F %H:%M}" == f"{last:%F %H:%M}":
        return f"on {first:%F} at {first:%H:%M} UTC"
    until = f"{last:%H:%M}" if first.date() == last.date() else f"{last:%F %H:%M}"
    return f"on {first:%F} from {first:%H:%M} to {until} UTC"


def _at_a_glance(record: SessionRecord, cells: Sequence[Cell], stands: Standing, spent: StepTimes) -> Section:
    plan = record.settings.get("plan", {})
    details = ", ".join(
        f"{key} {value}" for key, value in plan.items() if isinstance(value, int | float | str) and key != "kind"
    )
    flagged = sum(bool(cell.flags) and cell.frame is not None for cell in cells)
    rows = [
        ("state", str(stands)),
        ("frames", f"{len(record.counting)} of {len(record.wanted)}, {flagged or 'none'} of them to look at"),
        ("plan", f"{record.kind}{': ' if record.kind and details else ''}{details}"),
        ("files", _files(record)),
        ("time", sections.clock(spent.wall_s)),
        *((f"segment\N{NO-BREAK SPACE}{number}", text) for number, text in segments(record)),
    ]
    return Section("At a glance", table=Table((), [row for row in rows if row[1]]))


def _files(record: SessionRecord) -> str:
    frames, orphans = record.verification.frames, len(record.verification.orphans)
    state = f"{frames} frames, all as they were captured" if not record.findings else f"{len(record.findings)} findings"
    if record.verification.closed and not record.findings:
        state += "; the bag is valid"
    return state + (f"; {orphans} shot but never acknowledged (harmless)" if orphans else "")


def _to_look_at(record: SessionRecord, cells: Sequence[Cell], suspects: Sequence[Suspect]) -> Section | None:
    rows = [("file", finding) for finding in record.findings[:_MOST_LISTED]]
    if (left := len(record.findings) - _MOST_LISTED) > 0:
        rows.append(("file", f"and {left} more; litrig capture verify names them"))
    rows += [("light", str(suspect)) for suspect in suspects[:_MOST_LISTED]]
    flagged = [cell for cell in cells if cell.flags]
    for flag in dict.fromkeys(flag for cell in flagged for flag in cell.flags if flag is not Flag.SUSPECT):
        steps = [str(cell.step.step) for cell in flagged if flag in cell.flags]
        listed = ", ".join(steps[:_MOST_LISTED]) + (f", … ({len(steps)} in all)" if len(steps) > _MOST_LISTED else "")
        rows.append((flag.label, f"step{'s' if len(steps) > 1 else ''} {listed}"))
    return Section("To look at", table=Table((), rows)) if rows else None


def _summary(
    record: SessionRecord,
    cells: Sequence[Cell],
    suspects: Sequence[Suspect],
    told: Sequence[Happening],
    stands: Standing,
    spent: StepTimes,
) -> dict[str, Any]:
    return {
        "litrig.kind": KIND,
        "litrig": litrig_version(),
        "folder": str(record.folder),
        "object": record.object_id,
        "operator": record.operator,
        "state": stands.state.value,
        "reason": stands.reason,
        "frames": len(record.counting),
        "wanted": len(record.wanted),
        "missing": [step.step for step in record.missing],
        "findings": list(record.findings),
        "orphans": list(record.verification.orphans),
        "flags": {cell.step.step: [flag.label for flag in cell.flags] for cell in cells if cell.flags},
        "suspects": [asdict(suspect) for suspect in suspects],
        "segments": [{"number": number, "what": text} for number, text in segments(record)],
        "happened": [asdict(happening) for happening in told],
        "times_s": {
            "medians": spent.medians_s,
            "totals": spent.totals_s,
            "shooting": spent.shooting_s,
            "wall": spent.wall_s,
        },
    }
