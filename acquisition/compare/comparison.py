"""What differs between two sessions: settings, plan, exposure, instruments, versions."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from acquisition.compare.matching import Matching, Tolerances, match
from acquisition.report.record import Frame, SessionRecord, read_record
from acquisition.report.story import standing
from rig.rig_lock import PORT_KEYS

_ASIDE = PORT_KEYS | {"usb_address"}
"""Where a device is plugged in: a port may come back under another name."""
_LABELS = frozenset({"session.started", "session.litrig"})
_EMPTY: tuple[Any, ...] = (None, "", [])
"""An earlier version left out what a later one says is not there."""
_TOLERANCES = Tolerances()


@dataclass(frozen=True)
class Setting:
    """A key of session.toml that differs; None where a session does not have it."""

    key: str
    a: Any
    b: Any


@dataclass(frozen=True)
class CameraSetting:
    """What the camera said it was set to, where it differs, and in how many steps of one pose it does so."""

    key: str
    a: Any
    b: Any
    steps: int


@dataclass(frozen=True)
class Measure:
    """How a figure of the frames of one pose differs.

    Attributes
    ----------
    name : mean, clipped, sharpness (of the display values, share of pixels; as the journal has them) or pose (degrees)
    kind : `difference` is B − A, `ratio` is B / A
    median : of all steps
    worst : the one that is farthest from no difference, and its step in A
    """

    name: str
    kind: str
    median: float
    worst: float
    worst_step: int


@dataclass(frozen=True)
class Comparison:
    """Two sessions, A and B.

    Attributes
    ----------
    names : what each is, in a few words
    settings : keys of session.toml that differ, device paths aside
    plan : which step is which
    camera : settings read back that differ, in steps of one pose
    measures : how exposure, focus and poses read back differ, in steps of one pose; empty if there are none
    instruments : in A alone, and in B alone
    versions : of litrig, of all segments of A, and of B
    """

    names: tuple[str, str]
    settings: tuple[Setting, ...]
    plan: Matching
    camera: tuple[CameraSetting, ...]
    measures: tuple[Measure, ...]
    instruments: tuple[tuple[str, ...], tuple[str, ...]]
    versions: tuple[tuple[str, ...], tuple[str, ...]]


def compare(a: Path, b: Path) -> Comparison:
    """Compare two sessions, in whatever state each is.

    Raises
    ------
    InputError, FormatError
        One is no capture folder, or its journal is damaged.
    """
    records = (read_record(a), read_record(b))
    plan = match(records[0].wanted, records[1].wanted, _tolerances(records[0]))
    frames = _frames_of_one_pose(records, plan)
    devices = [tuple(str(device) for device in record.settings.get("instruments", ())) for record in records]
    return Comparison(
        names=(_name(records[0]), _name(records[1])),
        settings=tuple(_differing_settings(records[0], records[1])),
        plan=plan,
        camera=tuple(_differing_camera(frames)),
        measures=tuple(_measures(frames)),
        instruments=(_but_not(devices[0], devices[1]), _but_not(devices[1], devices[0])),
        versions=(_versions(records[0]), _versions(records[1])),
    )


def _name(record: SessionRecord) -> str:
    frames = f"{len(record.counting)} of {len(record.wanted)} frames"
    by = f" by {record.operator}" if record.operator else ""
    return f"{record.folder}: {record.object_id}{by}, {frames}, {standing(record).state.value}"


def _tolerances(record: SessionRecord) -> Tolerances:
    """Return those of A's rig; both joints of an arm may be off at once."""
    rig = record.settings.get("rig", {})

    def of(section: str, usual: float) -> float:
        part = rig.get(section)
        value = part.get("tolerance_deg") if isinstance(part, Mapping) else None
        return float(value) if isinstance(value, int | float) and value > 0 else usual

    return Tolerances(of("turntable", _TOLERANCES.turntable_deg), 2**0.5 * of("arm", _TOLERANCES.light_deg / 2**0.5))


def _differing_settings(a: SessionRecord, b: SessionRecord) -> Iterator[Setting]:
    for part in ("session", "plan", "rig"):
        yield from _differences(a.settings.get(part, {}), b.settings.get(part, {}), part)


def _differences(a: Any, b: Any, key: str) -> Iterator[Setting]:
    """Go down where both have a table, or as many of them; what only one has differs as a whole."""
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        for name in dict.fromkeys([*a, *b]):
            if name not in _ASIDE and f"{key}.{name}" not in _LABELS:
                yield from _differences(a.get(name), b.get(name), f"{key}.{name}")
    elif _are_tables(a) and _are_tables(b) and len(a) == len(b):
        for index, (one, other) in enumerate(zip(a, b, strict=True)):
            yield from _differences(one, other, f"{key}[{index}]")
    elif (None if a in _EMPTY else a) != (None if b in _EMPTY else b):
        yield Setting(key, a, b)


def _are_tables(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(one, Mapping) for one in value)


Pairs = Sequence[tuple[Frame, Frame]]


def _frames_of_one_pose(records: tuple[SessionRecord, SessionRecord], plan: Matching) -> Pairs:
    of_a, of_b = (record.counting for record in records)
    return [(of_a[one.step], of_b[other.step]) for one, other in plan.same if one.step in of_a and other.step in of_b]


def _differing_camera(frames: Pairs) -> Iterator[CameraSetting]:
    counted: dict[tuple[str, str], tuple[Any, Any, int]] = {}
    for one, other in frames:
        a, b = one.line.camera, other.line.camera
        for key in sorted({*a, *b} - _ASIDE):
            if a.get(key) != b.get(key):
                which = (key, f"{a.get(key)!r} {b.get(key)!r}")
                counted[which] = (a.get(key), b.get(key), counted.get(which, (0, 0, 0))[2] + 1)
    for (key, _), (a_value, b_value, steps) in counted.items():
        yield CameraSetting(key, a_value, b_value, steps)


def _measures(frames: Pairs) -> Iterator[Measure]:
    for name, kind in (("mean", "difference"), ("clipped", "difference"), ("sharpness", "ratio")):
        yield from _measure(name, kind, frames, lambda frame, name=name: frame.line.checks.get(name))  # type: ignore[misc]
    yield from _measure("turntable", "difference", frames, lambda frame: (frame.line.pose_after or {}).get("angle_deg"))


def _measure(name: str, kind: str, frames: Pairs, value: Callable[[Frame], float | None]) -> Iterator[Measure]:
    known = [
        (one.line.step, a, b)
        for one, other in frames
        if (a := value(one)) is not None and (b := value(other)) is not None and (kind == "difference" or a > 0)
    ]
    if not known:
        return
    a_values, b_values = (np.array([row[index] for row in known], np.float64) for index in (1, 2))
    differences = b_values - a_values if kind == "difference" else b_values / a_values
    off = np.abs(differences) if kind == "difference" else np.abs(np.log(np.maximum(differences, 1e-12)))
    worst = int(np.argmax(off))
    yield Measure(name, kind, float(np.median(differences)), float(differences[worst]), known[worst][0])


def _versions(record: SessionRecord) -> tuple[str, ...]:
    begun = record.settings.get("session", {}).get("litrig")
    said = [begun, *(entry.get("litrig") for entry in record.of("segment"))]
    return tuple(dict.fromkeys(str(version) for version in said if version))


def _but_not(these: Iterable[str], those: Sequence[str]) -> tuple[str, ...]:
    return tuple(one for one in these if one not in those)
