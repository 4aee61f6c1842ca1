"""A capture session: begun in an absent folder, resumed from any state, closed as a valid bag."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from acquisition.arrangement import arranged, done_by_now
from acquisition.earlier import so_far
from acquisition.events import Paused, RunEvent
from acquisition.instruments import instruments
from acquisition.least_motion import in_order_of_least_motion
from acquisition.plans import Step
from acquisition.runner import USUAL, Policy, SoFar, check_plan, run
from acquisition.segments import check_configuration, segment_settings
from acquisition.session_info import SessionInfo
from acquisition.wanted import harmed_files, missing_steps, read_steps
from litrig.base.capture_folder import layout
from litrig.base.capture_folder.capture import Role
from litrig.base.capture_folder.crate import Description
from litrig.base.capture_folder.journal import Entry, read_journal
from litrig.base.capture_folder.lock import FolderLock
from litrig.base.capture_folder.reader import good_frames
from litrig.base.capture_folder.verify import orphans_of
from litrig.base.capture_folder.writer import CaptureFolderWriter, check_free, check_object_id
from litrig.base.errors import InputError
from litrig.base.lights import Lights
from litrig.base.version import litrig_version
from rig.config import RigConfig
from rig.interrupts import Interrupts
from rig.rig import Rig, open_rig


class Planned(Protocol):
    """What a session asks of a plan: `acquisition.plans.Plan` fits, and so does anything that knows its steps."""

    def __iter__(self) -> Iterator[Step]:
        """Go through the steps."""

    def parameters(self) -> Mapping[str, Any]:
        """Return what it was made from, as session.toml has it."""


@dataclass(frozen=True)
class Outlook:
    """What a session will shoot now.

    Attributes
    ----------
    steps : in this order
    wanted : how many the plan has
    orphans : files that were shot, but never acknowledged; they stay as they are
    harmed : files of frames that are gone, or not as they were shot
    """

    steps: Sequence[Step]
    wanted: int
    orphans: Sequence[str] = ()
    harmed: Sequence[str] = ()


@dataclass(frozen=True)
class Operator:
    """Who watches a session, and what they can be asked.

    Attributes
    ----------
    expect : told what will be shot, before anything moves
    watch : told of everything that happens, with the number of steps to shoot
    ask : has a person do something, and tells whether it was done; False if nobody is there
    """

    expect: Callable[[Outlook], None] = lambda outlook: None
    watch: Callable[[RunEvent, int], None] = lambda event, total: None
    ask: Callable[[str], bool] = lambda what: False


NOBODY = Operator()


def capture(
    config: RigConfig,
    plan: Planned,
    folder: Path,
    info: SessionInfo,
    *,
    operator: Operator = NOBODY,
    policy: Policy = USUAL,
    environment: Mapping[str, str] | None = None,
) -> bool:
    """Shoot a plan into a new capture folder, and close it as a valid bag.

    Nothing is created before the rig is open and the plan is known to be within its reach.

    Parameters
    ----------
    folder : absent or empty
    environment : added to the environment of the camera's process

    Returns
    -------
    complete : False if the operator paused it; the folder is then an open session with every frame so far

    Raises
    ------
    InputError, RigError
        Before anything moved.
    HoldError
        The rig stopped in the middle and needs a person; the frames so far are safe.
    """
    check_free(folder)
    check_object_id(info.object_id)
    started = _now()
    steps = list(plan)
    operator.expect(Outlook(steps, len(steps)))
    with (
        Interrupts(can_pause=True) as interrupts,
        open_rig(config, use=_needed(steps, config), environment=environment) as rig,
    ):
        check_plan(steps, rig)
        settings = _settings(config, plan, info, started)
        with CaptureFolderWriter.create(folder, info.object_id, settings, (step.as_json() for step in steps)) as writer:
            if info.note:
                writer.add_note(info.note)
            course = _Course(rig, writer, policy, operator, lambda: interrupts.pause_requested)
            return course.shoot(steps, SoFar(), Description(litrig_version(), started, operator=info.operator))


def resume(
    folder: Path,
    config: RigConfig | None = None,
    *,
    new_segment: bool = False,
    operator: Operator = NOBODY,
    policy: Policy = USUAL,
    environment: Mapping[str, str] | None = None,
) -> bool:
    """Shoot the steps of a session that have no good frame, and close it.

    Parameters
    ----------
    config : None takes the one that the session was begun with
    new_segment : accept another configuration, and write it down

    Returns
    -------
    complete : as `capture`

    Raises
    ------
    InputError, FormatError
        It is no session, its files were changed, or the configuration differs; the message names the keys.
    RigError, HoldError
        As `capture`.
    """
    return _go_on(folder, None, config, new_segment, operator, policy, environment)


def retake(
    folder: Path,
    steps: Sequence[int],
    config: RigConfig | None = None,
    *,
    new_segment: bool = False,
    operator: Operator = NOBODY,
    policy: Policy = USUAL,
    environment: Mapping[str, str] | None = None,
) -> bool:
    """Shoot steps again; the new frames count, and the old ones are kept. What is missing stays missing.

    Raises
    ------
    InputError
        The plan has no such step; otherwise as `resume`.
    """
    return _go_on(folder, steps, config, new_segment, operator, policy, environment)


def _go_on(
    folder: Path,
    again: Sequence[int] | None,
    config: RigConfig | None,
    new_segment: bool,
    operator: Operator,
    policy: Policy,
    environment: Mapping[str, str] | None,
) -> bool:
    with ExitStack() as held:
        lock = FolderLock(folder)
        held.callback(lock.release)
        interrupts = held.enter_context(Interrupts(can_pause=True))
        wanted, entries = read_steps(folder), read_journal(folder / layout.JOURNAL)
        frozen = segment_settings(folder, entries)
        used = config or frozen.config
        harmed = harmed_files(folder, entries)
        missing = missing_steps(wanted, entries, harmed)
        todo = in_order_of_least_motion(missing, used) if again is None else _named(folder, wanted, again)
        todo = arranged(wanted, todo, entries)
        changes = check_configuration(folder, frozen.config, used, accept=new_segment or not todo)
        operator.expect(Outlook(todo, len(wanted), orphans_of(folder, entries), harmed))
        if not todo:
            if harmed or not layout.is_closed(folder):
                with CaptureFolderWriter.reopen(folder, lock) as writer:
                    _call_back(writer, entries, harmed)
                    _close(writer, frozen.about)
            return True
        rig = held.enter_context(open_rig(used, use=_needed(todo, used), environment=environment))
        check_plan(todo, rig)
        writer = held.enter_context(CaptureFolderWriter.reopen(folder, lock))
        _begin_segment(writer, entries, used if changes else None, changes)
        _call_back(writer, entries, harmed)
        earlier = so_far(folder, wanted, entries, used, forget_settings=new_segment)
        earlier.confirmed = done_by_now(entries, todo)
        gaps = {step.step for step in missing} - {step.step for step in todo}
        course = _Course(rig, writer, policy, operator, lambda: interrupts.pause_requested)
        return course.shoot(todo, earlier, frozen.about, close=not gaps)


class _Course:
    """One part of a session: shot, and closed if nothing is missing then."""

    def __init__(
        self,
        rig: Rig,
        writer: CaptureFolderWriter,
        policy: Policy,
        operator: Operator,
        pause_requested: Callable[[], bool],
    ) -> None:
        self._rig, self._writer, self._policy = rig, writer, policy
        self._operator, self._pause_requested = operator, pause_requested

    def shoot(self, steps: Sequence[Step], so_far: SoFar, about: Description, *, close: bool = True) -> bool:
        """Return False if it was paused."""
        rig, writer, operator = self._rig, self._writer, self._operator
        about = replace(about, instruments=instruments(rig.config))
        course = run(steps, rig, writer, self._pause_requested, ask=operator.ask, policy=self._policy, so_far=so_far)
        for event in course:
            operator.watch(event, len(steps))
            if isinstance(event, Paused):
                with suppress(InputError):
                    writer.describe(about.ending(_now()))
                return False
        if close:
            _close(writer, about)
        return True


def _close(writer: CaptureFolderWriter, about: Description) -> None:
    try:
        writer.close(exported_lights(writer.folder), about)
    except (InputError, OSError) as error:
        raise InputError(
            f"{error}. Every frame is safe; litrig capture resume {writer.folder} closes the session then"
        ) from error


def exported_lights(folder: Path) -> Lights | None:
    """Return the light directions of a session's good frames; None if there are none."""
    frames = [
        entry
        for entry in good_frames(read_journal(folder / layout.JOURNAL))
        if entry["role"] == Role.FRAME and "light" in entry
    ]
    if not frames:
        return None
    names = tuple(Path(entry["file"]).name for entry in frames)
    return Lights(names, np.array([entry["light"] for entry in frames]))


def _call_back(writer: CaptureFolderWriter, entries: Sequence[Entry], harmed: Sequence[str]) -> None:
    """Take note of files that are not as they were shot, and that their frames count no longer."""
    if harmed:
        steps = [entry["step"] for entry in good_frames(entries) if entry["file"] in harmed]
        writer.recall(steps, "gone from the disk, or not as it was shot", harmed)


def _begin_segment(
    writer: CaptureFolderWriter, entries: Sequence[Entry], changed: RigConfig | None, changes: Sequence[str]
) -> None:
    number = 2 + sum(entry["ev"] == "segment" for entry in entries)
    fields: dict[str, Any] = {"number": number, "litrig": litrig_version(), "torn_bytes": writer.torn_bytes}
    if changed is not None:
        name = f"session-{number}.toml"
        settings = {"rig": changed.model_dump(exclude_none=True)}
        fields |= {"session": f"data/{name}", "session_sha256": writer.add_settings(name, settings)}
        fields["changed"] = list(changes)
    writer.record("segment", **fields)


def _named(folder: Path, wanted: Iterable[Step], numbers: Sequence[int]) -> list[Step]:
    steps = {step.step: step for step in wanted}
    if unknown := sorted(set(numbers) - set(steps)):
        raise InputError(f"{folder}: its plan has no step {unknown[0]}; it has steps {min(steps)} to {max(steps)}")
    return [steps[number] for number in sorted(set(numbers))]


def _needed(steps: Iterable[Step], config: RigConfig) -> frozenset[str]:
    """Name the parts that steps use; the others are not touched, and cannot fail."""
    parts = {"camera"}
    for step in steps:
        if step.angle_deg is not None:
            parts.add("turntable")
        if step.aim is not None:
            has_dome = config.lights is not None and config.lights.directions_deg
            parts |= {"lights"} if has_dome else {"arm", "lights"}
        if not step.lit:
            parts.add("lights")
    return frozenset(parts)


def _settings(config: RigConfig, plan: Planned, info: SessionInfo, started: str) -> Mapping[str, Any]:
    return {
        "session": {
            "object": info.object_id,
            "tangent_zero_deg": info.tangent_zero_deg,
            "operator": info.operator,
            "started": started,
            "litrig": litrig_version(),
        },
        "plan": plan.parameters(),
        "instruments": list(instruments(config)),
        "rig": config.model_dump(exclude_none=True),
    }


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
