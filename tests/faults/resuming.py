"""Sessions that are gone on with: exactly what is missing is shot, by one writer, with the configuration as it was."""

import random
import subprocess
import sys
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from acquisition.plans import Step
from acquisition.segments import check_configuration
from litrig.base.capture_folder import layout
from litrig.base.capture_folder.capture import Role
from litrig.base.capture_folder.journal import Journal, read_journal
from litrig.base.capture_folder.lock import FolderLock
from litrig.base.capture_folder.reader import good_frames
from litrig.base.capture_folder.verify import verify_capture
from litrig.base.errors import InputError
from rig.config import RigConfig
from tests.faults.fake_sessions import FakeRig, quick_folder
from tests.faults.outcome import Outcome, Scale
from tests.faults.power_cut import AIM

STEPS = tuple(
    Step(number, Role.WHITE if number == 5 else Role.FRAME, angle_deg=20.0 * number, aim=AIM) for number in range(6)
)
SESSION = "s"
FATES = ("whole", "damaged", "shortened", "lost", "recalled", "never shot", "orphaned", "recalled and shot again")
_HOLD_THE_LOCK = """
import sys
from pathlib import Path
from litrig.base.capture_folder.lock import FolderLock
lock = FolderLock(Path(sys.argv[1]))
print("held", flush=True)
sys.stdin.read()
"""


def fault_42_exactly_the_missing(campaign: Scale) -> Outcome:
    """Frames are damaged, lost, called back, never shot or never acknowledged: exactly those are shot when resumed."""
    chance = random.Random(42)
    wrong = 0
    for trial in range(campaign.trials):
        # Every fate of every step comes up; then any mixture.
        fates = [FATES[(trial + place) % len(FATES)] for place in range(len(STEPS))]
        if trial >= len(FATES):
            fates = [chance.choice(FATES) for _ in STEPS]
        with quick_folder() as root:
            wrong += not _shoots_the_missing(root / SESSION, dict(enumerate(fates)))
    detail = f"{len(STEPS)} steps, {len(FATES)} fates of each: exactly the missing set, whole by its sha256"
    return Outcome(campaign.trials, wrong, detail, passed=wrong == 0)


def _shoots_the_missing(folder: Path, fates: Mapping[int, str]) -> bool:
    wanted = [step for step in STEPS if fates[step.step] not in ("never shot", "orphaned")]
    _shoot_part(folder, [step.step for step in wanted], [n for n, fate in fates.items() if fate.startswith("recalled")])
    good = {entry["step"]: entry for entry in good_frames(read_journal(folder / layout.JOURNAL))}
    again = [number for number, fate in fates.items() if fate == "recalled and shot again"]
    if again:
        FakeRig().retake(folder, *again)
        good = {entry["step"]: entry for entry in good_frames(read_journal(folder / layout.JOURNAL))}
    strangers = {}
    for number, fate in fates.items():
        path = folder / good[number]["file"] if number in good else folder / layout.FRAMES / f"{STEPS[number].stem}.jpg"
        if fate == "damaged":
            content = bytearray(path.read_bytes())
            content[len(content) // 2] ^= 1
            path.write_bytes(content)
        elif fate == "shortened":
            path.write_bytes(path.read_bytes()[:-1])
        elif fate == "lost":
            path.unlink()
        elif fate == "orphaned":
            path.write_bytes(b"shot, and never acknowledged")
            strangers[path] = path.read_bytes()
    missing = {number for number, fate in fates.items() if fate not in ("whole", "recalled and shot again")}
    before = len(read_journal(folder / layout.JOURNAL))
    rig = FakeRig()
    rig.resume(folder)
    shot = [entry["step"] for entry in read_journal(folder / layout.JOURNAL)[before:] if entry["ev"] == "frame"]
    kept = all(path.read_bytes() == content for path, content in strangers.items())
    harmed = {number for number, fate in fates.items() if fate in ("damaged", "shortened", "lost")}
    checked = verify_capture(folder)
    told = not checked.findings and set(checked.harmed) == {good[number]["file"] for number in harmed}
    return sorted(shot) == sorted(missing) and kept and told and layout.is_closed(folder)


def _shoot_part(folder: Path, wanted: list[int], recalled: list[int]) -> None:
    """Leave a session in which some steps were shot, and some of these called back."""
    rig = FakeRig()
    rig.capture(STEPS, folder)
    journal = folder / layout.JOURNAL
    entries = read_journal(journal)
    for tag in (layout.TAG_MANIFEST, layout.MANIFEST, layout.BAG_INFO):
        (folder / tag).unlink(missing_ok=True)
    journal.unlink()
    kept = [entry for entry in entries if entry["ev"] == "session" or entry.get("step") in wanted]
    again = Journal(journal)
    for entry in kept:
        again.append(entry["ev"], **{k: v for k, v in entry.items() if k not in ("v", "seq", "t", "mono_ns", "ev")})
    if recalled:
        again.append("recall", steps=recalled, reason="they slipped")
    for entry in entries:
        if entry["ev"] == "frame" and entry["step"] not in wanted:
            (folder / entry["file"]).unlink(missing_ok=True)


RIG: Mapping[str, Any] = {
    "rig": {"name": "bench"},
    "turntable": {"port": "/dev/a"},
    "arm": {
        "port": "/dev/b",
        "radius_mm": 400.0,
        "zones": [{"name": "post", "azimuth_deg": [80, 100], "elevation_deg": [20, 60]}],
        "settings": {110: 7200.0},
    },
    "lights": {"kind": "grbl-spindle"},
    "camera": {"kind": "v4l2", "device": "/dev/video0", "fps": 30.0, "gain": 1, "white_balance_k": 5000, "focus": 30},
    "sample": {"sphere_distance_radii": 8.0},
}
OTHER_VALUES: tuple[Callable[[Any], Any], ...] = (
    lambda value: value + 1,
    lambda value: value * 1.01 + 0.01,
    lambda value: value - 1,
    lambda value: -value,
    lambda value: not value,
    lambda value: f"{value}x",
    lambda value: "XM430-W350",
    lambda value: "YUYV",
    lambda value: {**value, 111: 1.0},
    lambda value: [{**value[0], "name": "tower"}],
    lambda value: [[0, -1, 0], [1, 0, 0], [0, 0, 1]],
)


def fault_43_changed_configuration(campaign: Scale) -> Outcome:
    """Each key of RIG.toml is changed: refused by its name, but for device paths; a new segment writes it down."""
    frozen = RigConfig.model_validate(RIG)
    wrong = trials = 0
    untried = []
    for section, table in frozen.model_dump().items():
        for key, value in table.items():
            if key in ("kind",):
                continue
            changed = _changed(frozen, section, key, value)
            if changed is None:
                untried.append(f"{section}.{key}")
                continue
            trials += 1
            said = _refusal(frozen, changed)
            is_port = key in ("port", "device")
            wrong += (said != "") if is_port else f"{section}.{key}" not in said or "--new-segment" not in said
    wrong += bool(untried)
    wrong += sum(not _begins_a_segment() for _ in range(min(campaign.trials, 3)))
    detail = f"each of {trials} keys is named, but for device paths; a new segment has its configuration in the bag"
    if untried:
        detail += f"; not tried: {', '.join(untried)}"
    return Outcome(trials, wrong, detail, passed=wrong == 0)


def _changed(frozen: RigConfig, section: str, key: str, value: object) -> RigConfig | None:
    """Return the configuration with another value that the model takes; None if none is found."""
    for other in OTHER_VALUES:
        with suppress(ValueError, TypeError, KeyError, IndexError):
            table = {**frozen.model_dump(exclude_none=True)[section], key: other(value)}
            config = RigConfig.model_validate({**frozen.model_dump(exclude_none=True), section: table})
            if config.model_dump()[section][key] != value:
                return config
    return None


def _refusal(frozen: RigConfig, used: RigConfig) -> str:
    try:
        check_configuration(Path("folder"), frozen, used, accept=False)
    except InputError as error:
        return str(error)
    return ""


def _begins_a_segment() -> bool:
    with quick_folder() as root:
        folder = root / SESSION
        rig = FakeRig()
        rig.capture(STEPS, folder)
        (folder / read_journal(folder / layout.JOURNAL)[-2]["file"]).unlink()
        assert rig.config.arm is not None
        other = rig.config.model_copy(update={"arm": rig.config.arm.model_copy(update={"park_azimuth_deg": 10.0})})
        count = len(read_journal(folder / layout.JOURNAL))
        try:
            FakeRig().resume(folder, other)
        except InputError as error:
            refused = "arm.park_azimuth_deg (0.0 → 10.0)" in str(error)
        untouched = len(read_journal(folder / layout.JOURNAL)) == count
        FakeRig().resume(folder, other, new_segment=True)
        segments = [entry for entry in read_journal(folder / layout.JOURNAL) if entry["ev"] == "segment"]
        written = "park_azimuth_deg = 10.0" in (folder / segments[-1]["session"]).read_text("utf-8")
        as_it_is_now = not _raises(lambda: FakeRig().resume(folder, other))
        return refused and untouched and written and as_it_is_now and layout.is_closed(folder)


def _raises(action: Callable[[], object]) -> bool:
    try:
        action()
    except InputError:
        return True
    return False


def fault_21_second_resume(campaign: Scale) -> Outcome:
    """A session that is being written is not resumed or retaken by another process, which is told who writes there."""
    wrong = 0
    with quick_folder() as root:
        folder = root / SESSION
        FakeRig().capture(STEPS, folder)
        with subprocess.Popen([sys.executable, "-c", _HOLD_THE_LOCK, str(folder)], stdin=-1, stdout=-1) as first:
            assert first.stdout is not None
            assert first.stdout.readline() == b"held\n"
            before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
            actions = (
                lambda: FakeRig().resume(folder),
                lambda: FakeRig().retake(folder, 1),
                lambda: FolderLock(folder),
            )
            for trial in range(campaign.trials):
                try:
                    actions[trial % len(actions)]()
                    wrong += 1
                except InputError as error:
                    wrong += f"is being written by process {first.pid}" not in str(error)
            wrong += before != {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
            assert first.stdin is not None
            first.stdin.close()
        FakeRig().retake(folder, 1)
        wrong += bool(verify_capture(folder).findings)
    return Outcome(campaign.trials, wrong, "refused naming the process; not a byte changed", passed=wrong == 0)
