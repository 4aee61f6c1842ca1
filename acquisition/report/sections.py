"""The parts of a report's page."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acquisition.consistency import Suspect
from acquisition.quality import MOST_CLIPPED
from acquisition.report import plots
from acquisition.report.cells import Cell, Flag, as_grid, in_order_of_pose, pose_words
from acquisition.report.hemisphere import MOST_CELLS, hemisphere
from acquisition.report.record import Frame, SessionRecord, moment
from acquisition.report.sheets import grid_sheets, legend, look_for, sheets
from acquisition.report.story import Happening
from acquisition.report.times import PARTS, StepTimes
from acquisition.report.tones import tones_of
from acquisition.thumbs import read_thumbnail
from litrig.base.capture_folder.capture import Role
from litrig.base.page import Figure, Section, Table
from litrig.base.pictures import write_codes
from litrig.base.radiometry import U8

F64 = NDArray[np.float64]


@dataclass(frozen=True)
class Drawing:
    """Where pictures are drawn, and what they are drawn from.

    Attributes
    ----------
    folder : of the page
    """

    folder: Path
    record: SessionRecord
    cells: Sequence[Cell]
    suspects: Sequence[Suspect]

    def thumb(self, cell: Cell) -> U8 | None:
        """Return the small picture of a step."""
        return None if cell.frame is None else read_thumbnail(self.record.folder, cell.frame.line.file)

    def picture(self, name: str, codes: U8, caption: str) -> Figure:
        """Write a picture that takes the page's width."""
        write_codes(self.folder / name, codes)
        return Figure(name, caption, wide=True, size=(codes.shape[1], codes.shape[0]))

    @property
    def frames(self) -> list[Frame]:
        """The frames that count, in the order of the plan."""
        counting = self.record.counting
        return [counting[step.step] for step in self.record.wanted if step.step in counting]


def contact_sheets(drawing: Drawing) -> Section:
    """Show every wanted step."""
    usual = [cell for cell in drawing.cells if cell.step.role is Role.FRAME]
    others = [cell for cell in drawing.cells if cell.step.role is not Role.FRAME]
    flags = sorted({flag for cell in drawing.cells for flag in cell.flags}, key=list(Flag).index)
    figures = []
    if flags:
        figures.append(drawing.picture("legend.png", legend(flags), "a frame's colour is that of the gravest"))
    grid = as_grid(usual)
    if grid is not None:
        pictures, order = grid_sheets(grid, drawing.thumb), "a row a slice, a column a light"
    else:
        pictures = sheets(in_order_of_pose(usual), drawing.thumb, look_for(len(usual)))
        turned = any(cell.step.angle_deg is not None for cell in usual)
        order = "in the order of the turntable's angle" if turned else "in the order of the plan"
    for index, picture in enumerate(pictures, 1):
        part = f", sheet {index} of {len(pictures)}" if len(pictures) > 1 else ""
        figures.append(drawing.picture(f"frames_{index}.jpg", picture, f"step and pose, {order}{part}"))
    for picture in sheets(others, drawing.thumb, look_for(len(others))):
        figures.append(
            drawing.picture(f"others_{len(figures)}.jpg", picture, "white, dark, ball, chart and closure frames")
        )
    return Section("Contact sheet", "", figures)


def lights(drawing: Drawing) -> Section | None:
    """Show where the light came from."""
    wanted = [step for step in drawing.record.wanted if step.aim is not None and step.role is Role.FRAME]
    if len({step.aim for step in wanted}) < 2:
        return None
    taken = {frame.line.step: np.array(frame.line.light) for frame in drawing.frames if frame.line.light is not None}
    plots.plot_lights(drawing.folder / "lights.png", wanted, taken, drawing.suspects)
    figures = [Figure("lights.png", "light directions as the camera sees them; rings are elevations")]
    one_pose = len({step.angle_deg for step in wanted}) == 1
    cells = [cell for cell in drawing.cells if cell.step.aim is not None and cell.step.role is Role.FRAME]
    cells = [cell for cell in cells if cell.step.exposure_ev == 0 and cell.step.repeat == 0]
    if one_pose and len(cells) <= MOST_CELLS:
        picture = hemisphere(cells, drawing.thumb)
        write_codes(drawing.folder / "hemisphere.jpg", picture)
        size = (picture.shape[1], picture.shape[0])
        caption = "each frame where its light was; the rim is the horizon (areas are kept)"
        figures.append(Figure("hemisphere.jpg", caption, size=size))
    return Section("Light", "", figures, columns=2)


def exposure(drawing: Drawing) -> Section | None:
    """Show how bright the frames are."""
    frames = drawing.frames
    tones = tones_of((frame.line.step, read_thumbnail(drawing.record.folder, frame.line.file)) for frame in frames)
    figures = []
    if tones.steps:
        plots.plot_tones(drawing.folder / "tones.png", tones)
        caption = "display values of each thumbnail (a column, brighter where more of them are), with median and spread"
        figures.append(Figure("tones.png", caption, wide=True))
    steps, means = _checked(frames, "mean")
    if steps:
        plots.plot_exposure(drawing.folder / "means.png", steps, means)
        figures.append(Figure("means.png", f"mean of each frame, median {np.median(means):.3f}"))
    steps, clipped = _checked(frames, "clipped")
    if steps:
        plots.plot_clipped(drawing.folder / "clipped.png", steps, clipped, MOST_CLIPPED)
        figures.append(Figure("clipped.png", f"clipped share of each frame, at most {100 * clipped.max():.2f} %"))
    return Section("Exposure", "", figures, columns=2) if figures else None


def focus_and_lamps(drawing: Drawing) -> Section | None:
    """Show what drifts: focus, and the light of frames of one pose."""
    frames = [frame for frame in drawing.record.frames if frame.line.role in (Role.FRAME, Role.CLOSURE)]
    if not frames:
        return None
    start_ns, figures = frames[0].line.mono_ns, []
    alike = _of_one_exposure(frames)
    _, sharpness = _checked(alike, "sharpness")
    if len(sharpness) == len(alike):
        usual = _sharpness_of_lights(alike, sharpness)
        name = "sharpness" if usual is None else "sharpness, relative"
        shown = sharpness if usual is None else sharpness / usual
        plots.plot_sharpness(drawing.folder / "sharpness.png", _minutes(alike, start_ns), shown, name)
        by_light = "" if usual is None else ", relative to what its light's direction explains"
        figures.append(
            Figure("sharpness.png", f"sharpness of each frame{by_light}; a steady fall is a focus that drifts")
        )
    if drifts := _drifts(drawing.record, frames, start_ns):
        plots.plot_drift(drawing.folder / "drift.png", drifts)
        figures.append(Figure("drift.png", "light of frames of one pose and one lamp, relative to the first"))
    return Section("Focus and lamps", "", figures, columns=2) if figures else None


def poses(drawing: Drawing) -> Section | None:
    """Show how far the rig was from where it should have been."""
    figures = []
    for part, title in (("turntable", "turntable"), ("light", "light direction")):
        known = [(f.line.step, f.error_deg(part, "before"), f.error_deg(part, "after")) for f in drawing.frames]
        rows = [(step, before, after) for step, before, after in known if before is not None and after is not None]
        if not rows or (part == "light" and "arm" not in drawing.record.settings.get("rig", {})):
            continue  # the lamps of a dome hang where they hang
        before_deg, after_deg = (np.array([row[index] for row in rows], np.float64) for index in (1, 2))
        tolerance_deg = _tolerance_deg(drawing.record.settings, "turntable" if part == "turntable" else "arm")
        steps = [row[0] for row in rows]
        plots.plot_pose(drawing.folder / f"pose_{part}.png", steps, before_deg, after_deg, tolerance_deg)
        largest = max(float(before_deg.max()), float(after_deg.max()))
        figures.append(Figure(f"pose_{part}.png", f"{title}: at most {largest:.3f}° from its pose, as read back"))
    return Section("Poses", "", figures, columns=2) if figures else None


def times(drawing: Drawing, spent: StepTimes) -> Section | None:
    """Show where the time went."""
    medians, totals = spent.medians_s, spent.totals_s
    rows: list[tuple[str | float, ...]] = [
        (part, f"{medians[part]:.3f}", clock(totals[part])) for part in PARTS if part in medians
    ]
    lines: list[tuple[str | float, ...]] = [("the rig at work, from line to line", "", clock(spent.shooting_s))]
    if spent.wall_s is not None and spent.apart_s is not None:
        lines.append(("in pauses, holds and between segments", "", clock(spent.apart_s)))
        lines.append(("from the first line to the last, by the clock on the wall", "", clock(spent.wall_s)))
    figures = []
    text = "This session's journal does not say how long move, settle, expose and save took."
    if medians:
        beyond = plots.plot_times(drawing.folder / "times.png", spent)
        above = f"; {beyond} went beyond the top" if beyond else ""
        figures.append(Figure("times.png", f"seconds a frame{above}", wide=True))
        text = "A frame is saved while the rig moves to the next, so that the parts may add up to more than passed."
    return Section("Time", text, figures, Table(("", "median, s", "in all"), [*rows, *lines]))


def happened(happenings: Sequence[Happening], most: int = 500) -> Section:
    """Tell everything but the frames."""
    rows = [(clock(one.since_start_s), one.what, one.text) for one in happenings[:most]]
    left = f"{len(happenings) - most} more are in the journal." if len(happenings) > most else ""
    return Section("What happened", left, table=Table(("after", "", ""), rows))


def notes(record: SessionRecord) -> Section | None:
    """Show the operator's notes."""
    rows = [(moment(entry.get("t")), str(entry.get("text", ""))) for entry in record.of("note")]
    return Section("Notes", table=Table((), rows)) if rows else None


def every_frame(drawing: Drawing) -> Section:
    """List all wanted steps."""
    return Section(
        "Every step",
        table=Table(
            ("step", "pose", "file", "mean", "clipped, %", "sharpness", "pose error, deg", "remarks"),
            [_row(cell) for cell in drawing.cells],
        ),
        folded=f"{len(drawing.cells)} steps",
    )


def configuration(record: SessionRecord) -> list[Section]:
    """List devices and settings."""
    devices = [(str(device),) for device in record.settings.get("instruments", ())]
    settings = [(name, _shown(value)) for name, value in flattened(record.settings) if name != "instruments"]
    sections = [Section("Devices", table=Table((), devices))] if devices else []
    return [*sections, Section("Configuration", table=Table((), settings), folded="session.toml")]


def flattened(table: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Go through nested tables by dotted names."""
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from flattened(value, f"{above}{key}.")
        else:
            yield f"{above}{key}", value


def clock(seconds: float | None) -> str:
    """Write a duration as people do."""
    if seconds is None:
        return ""
    if seconds < 60:
        return f"{seconds:.1f} s"
    hours, rest = divmod(round(seconds), 3600)
    return f"{hours} h {rest // 60:02d} min" if hours else f"{rest // 60} min {rest % 60:02d} s"


def _row(cell: Cell) -> tuple[str | float, ...]:
    frame, pose = cell.frame, pose_words(cell.step)
    if frame is None:
        return (cell.step.step, pose, "missing", "", "", "", "", "")
    checks = frame.line.checks
    errors = [frame.error_deg(part, when) for part in ("turntable", "light") for when in ("before", "after")]
    known = [error for error in errors if error is not None]
    shown = [f"{scale * checks[name]:.{digits}f}" if name in checks else "" for name, scale, digits in _CHECKS]
    remarks = "; ".join(chain((flag.label for flag in cell.flags if flag is not Flag.REMARK), frame.line.remarks))
    return (cell.step.step, pose, Path(frame.line.file).name, *shown, f"{max(known):.3f}" if known else "", remarks)


_CHECKS = (("mean", 1.0, 3), ("clipped", 100.0, 2), ("sharpness", 1.0, 4))


def _checked(frames: Sequence[Frame], name: str) -> tuple[list[int], F64]:
    known = [(frame.line.step, frame.line.checks[name]) for frame in frames if name in frame.line.checks]
    return [step for step, _ in known], np.array([value for _, value in known], np.float64)


def _minutes(frames: Sequence[Frame], start_ns: int) -> F64:
    return np.array([(frame.line.mono_ns - start_ns) / 60e9 for frame in frames], np.float64)


def _of_one_exposure(frames: Sequence[Frame]) -> list[Frame]:
    """Choose the exposure that is nearest to the rig's own: darker frames look sharper by their noise."""
    nearest = min((frame.line.exposure_ev for frame in frames), key=abs)
    return [frame for frame in frames if frame.line.exposure_ev == nearest]


def _sharpness_of_lights(frames: Sequence[Frame], sharpness: F64) -> F64 | None:
    """Predict sharpness from the lights, since relief is sharper in raking light; None where lights do not vary.

    The logarithm is fitted by a polynomial of second degree in l_u and l_v.
    """
    lights = [frame.line.light for frame in frames]
    if any(light is None for light in lights) or not (sharpness > 0).all():
        return None
    u, v, _ = np.array(lights, np.float64).T
    terms = np.stack([u * u, v * v, u * v, u, v, np.ones_like(u)], axis=-1)
    if len(terms) < 2 * terms.shape[1] or np.linalg.matrix_rank(terms, tol=1e-3) < terms.shape[1]:
        return None
    return np.asarray(np.exp(terms @ np.linalg.lstsq(terms, np.log(sharpness))[0]), np.float64)


def _drifts(record: SessionRecord, frames: Sequence[Frame], start_ns: int) -> list[tuple[str, F64, F64]]:
    """Find frames of one pose and one lamp, closure frames and repeats among them.

    Returns
    -------
    drifts : name, minutes, light relative to the first; the longest few
    """
    alike: dict[object, list[Frame]] = {}
    for frame in frames:
        goal = dict(frame.line.pose_goal)
        if "angle_deg" in goal:
            goal["angle_deg"] %= 360
        alike.setdefault((tuple(sorted(goal.items())), frame.line.exposure_ev), []).append(frame)
    steps = {step.step: step for step in record.wanted}
    found = []
    for same in alike.values():
        light = np.array([_light(frame) for frame in same], np.float64)
        if len(same) > 1 and np.isfinite(light).all() and light[0] > 0:
            first = same[0].line.step
            name = pose_words(steps[first]) if first in steps else f"step {first}"
            found.append((name, _minutes(same, start_ns), light / light[0]))
    return sorted(found, key=lambda drift: -float(np.ptp(drift[1])))[:6]


def _light(frame: Frame) -> float:
    return frame.line.checks.get("light", float("nan"))


def _tolerance_deg(settings: Mapping[str, Any], section: str) -> float | None:
    part = settings.get("rig", {}).get(section)
    value = part.get("tolerance_deg") if isinstance(part, Mapping) else None
    return float(value) if isinstance(value, int | float) else None


def _shown(value: object) -> str:
    if isinstance(value, list) and len(value) > 12:
        return f"{', '.join(map(str, value[:12]))}, … ({len(value)} in all)"
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)
