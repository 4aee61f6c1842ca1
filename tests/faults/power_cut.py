"""Power that fails in a session: after every single operation, in every state in which a disk may be then."""

import hashlib
import random
import shutil
import signal
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from acquisition.plans import Aim, Step
from litrig.base.capture_folder import layout
from litrig.base.capture_folder.bag import sha256_of
from litrig.base.capture_folder.capture import Role
from litrig.base.capture_folder.journal import Entry, read_journal
from litrig.base.capture_folder.reader import good_frames
from litrig.base.capture_folder.verify import verify_capture
from litrig.base.errors import HoldError, InputError, LitrigError
from tests.faults.disk_states import (
    EXTREMES,
    Fate,
    ModelDisk,
    Operation,
    RecordingStore,
    Tree,
    lay_out,
    paths,
    random_fate,
)
from tests.faults.fake_sessions import FakeRig, quick_folder
from tests.faults.outcome import Outcome, Scale

SESSION = "s"
AIM = Aim(30.0, 45.0)
STEPS = (
    *(Step(number, angle_deg=20.0 * number, aim=AIM) for number in range(3)),
    Step(3, Role.CLOSURE, angle_deg=0.0, aim=AIM),
    Step(4, angle_deg=60.0, aim=AIM),
    Step(5, Role.CLOSURE, angle_deg=0.0, aim=AIM),
)
SEED = 37
FEW = 40
"""States that are tried on a small scale."""


@dataclass(frozen=True)
class Recorded:
    """What a session asked of its store, and which entries were acknowledged after how many operations."""

    root: Path
    operations: Sequence[Operation]
    acknowledged: Sequence[tuple[int, Entry]]


def recorded_session(root: Path, store: RecordingStore) -> Recorded:
    """Shoot a session that is paused, called back, resumed, closed, opened again and closed again."""
    rig, acknowledged = FakeRig(store), list[tuple[int, Entry]]()
    rig.acknowledged = lambda entry: acknowledged.append((len(store.operations), entry))
    folder = root / SESSION

    def pause() -> None:
        if rig.exposures == 2:
            signal.raise_signal(signal.SIGINT)

    def slip() -> None:
        if rig.turntable.angle_deg == 0:
            rig.slip_deg = 40.0

    rig.before = pause
    assert not rig.capture(STEPS, folder)
    rig.before = slip
    with suppress(HoldError):
        rig.resume(folder)
    assert acknowledged[-1][1]["ev"] == "hold"
    assert acknowledged[-2][1]["ev"] == "recall"
    rig.before, rig.slip_deg = lambda: None, 0.0
    assert rig.resume(folder)
    assert layout.is_closed(folder)
    assert rig.retake(folder, 1)
    return Recorded(root, store.operations, acknowledged)


def states(recorded: Recorded, fates: Sequence[Fate]) -> Iterator[tuple[Tree, list[Entry]]]:
    """Go through the states after every prefix of the operations, each once, with what was acknowledged then."""
    disk, seen = ModelDisk(recorded.root), set[tuple[int, bytes]]()
    for count in range(len(recorded.operations) + 1):
        if count:
            disk.apply(recorded.operations[count - 1])
        safe = [entry for number, entry in recorded.acknowledged if number <= count]
        for fate in fates:
            tree = disk.survivors(fate)
            key = len(safe), hashlib.sha256(repr(list(paths(tree))).encode()).digest()
            if key not in seen:
                seen.add(key)
                yield tree, safe


def harm(tree: Tree, safe: Sequence[Entry], root: Path) -> str:
    """Say what is lost, wrong or cannot be mended in a state; empty if nothing is."""
    folder = root / SESSION
    lay_out(tree, root)
    frames = [entry for entry in safe if entry["ev"] == "frame"]
    try:
        entries = read_journal(folder / layout.JOURNAL)
        wanted = len(STEPS) - len(good_frames(entries))
    except LitrigError as error:
        return f"{len(frames)} frames lost: {error}" if frames else _without_a_session(folder)
    if lost := [entry["ev"] for entry in safe if entry not in entries]:
        return f"acknowledged and lost: {', '.join(lost)}"
    if altered := _altered(folder, frames):
        return f"acknowledged and altered: {', '.join(altered)}"
    rig = FakeRig()
    try:
        rig.resume(folder)
    except LitrigError as error:
        return f"cannot be resumed: {error}" if frames else ""
    if frames and rig.exposures > wanted + 1:
        return f"shot {rig.exposures} pictures for {wanted} steps"
    return _flaws(folder) or ", ".join(_altered(folder, frames))


def _without_a_session(folder: Path) -> str:
    """A kill before the session was there: resuming says that nothing was shot, and leaves what lies there alone."""
    with suppress(InputError):
        FakeRig().resume(folder)
        return "resumed what never was"
    return ""


def _altered(folder: Path, frames: Sequence[Entry]) -> list[str]:
    return [
        entry["file"]
        for entry in frames
        if not (folder / entry["file"]).is_file() or sha256_of(folder / entry["file"]) != entry["sha256"]
    ]


def _flaws(folder: Path) -> str:
    found = verify_capture(folder)
    steps = [entry["step"] for entry in good_frames(read_journal(folder / layout.JOURNAL))]
    complete = found.closed and steps == [step.step for step in STEPS]
    return "; ".join(found.findings) or ("" if complete else f"not complete: steps {steps}, closed: {found.closed}")


def lost_in(tried: Iterable[tuple[Tree, Sequence[Entry]]]) -> tuple[int, list[str]]:
    """Try states, and return how many, and what harm was found."""
    found, count = list[str](), 0
    with quick_folder() as root:
        for tree, safe in tried:
            count += 1
            place = root / str(count)
            place.mkdir()
            if what := harm(tree, safe, place):
                found.append(what)
            shutil.rmtree(place)
    return count, found


def fault_37_power_cut(campaign: Scale) -> Outcome:
    """Cut the power after every operation of a session; what was not synced is lost, torn, zeroed or kept."""
    chance = random.Random(SEED)
    fates = [*EXTREMES, *(random_fate(chance) for _ in range(campaign.trials))]
    with quick_folder() as root:
        recorded = recorded_session(root, RecordingStore())
        tried = list(states(recorded, fates))
        if campaign.trials < 10:
            tried = chance.sample(tried, min(len(tried), FEW))
        count, found = lost_in(tried)
    detail = (
        f"after each of {len(recorded.operations)} operations, {len(fates)} ways to lose, {count} different states: "
        f"nothing acknowledged is lost, each is resumed to a verified bag{''.join(f'; but {it}' for it in found[:3])}"
    )
    return Outcome(count, len(found), detail, passed=not found)
