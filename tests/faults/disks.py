"""Disks that are full, read-only or gone, journals that end anywhere, files that rot: in sessions on fake devices."""

import errno
import random
import resource
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from acquisition.plans import Step
from litrig.base.capture_folder import layout
from litrig.base.capture_folder.bag import sha256_of
from litrig.base.capture_folder.journal import Entry, read_journal
from litrig.base.capture_folder.reader import good_frames
from litrig.base.capture_folder.verify import verify_capture
from litrig.base.errors import HoldError, LitrigError
from litrig.base.store import DISK
from tests.faults.disk_states import Operation, RecordingStore
from tests.faults.fake_sessions import FakeRig, quick_folder
from tests.faults.host import small_disk
from tests.faults.outcome import Outcome, Scale
from tests.faults.power_cut import AIM
from tests.faults.real_sessions import Session, frames_in, quick_sim, wait_until
from tests.system.command import litrig

STEPS = tuple(Step(number, angle_deg=20.0 * number, aim=AIM) for number in range(4))
SESSION = "s"
HOLD = 3


class FullDisk(RecordingStore):
    """Says that it is full from one operation on, for so many; what it was to write is written by half."""

    def __init__(self, first: int, count: int, code: int = errno.ENOSPC) -> None:
        super().__init__()
        self.first, self.last, self._code = first, first + count, code
        self.asked = 0

    def _do(self, action: Callable[[], None], operation: Operation) -> None:
        self.asked += 1
        if not self.first <= self.asked - 1 < self.last or operation.kind == "remove":
            super()._do(action, operation)
            return
        half = operation.content[: len(operation.content) // 2]
        if self._code == errno.ENOSPC and operation.kind in ("write", "append"):
            (DISK.write if operation.kind == "write" else DISK.append)(operation.path, half)
        raise OSError(self._code, "No space left on device", str(operation.path))


def harm_after(folder: Path, safe: Sequence[Entry], missing: int | None = None) -> str:
    """Say what is lost or cannot be mended of a session that broke off; empty if nothing is.

    Parameters
    ----------
    missing : how many steps are to be shot again, where that is known without the journal
    """
    if not (folder / layout.JOURNAL).exists():
        return "frames lost" if safe else ""
    entries = read_journal(folder / layout.JOURNAL)
    frames = [entry for entry in safe if entry["ev"] == "frame"]
    if any(entry not in entries for entry in safe):
        return "acknowledged and lost"
    if altered := [entry["file"] for entry in frames if sha256_of(folder / entry["file"]) != entry["sha256"]]:
        return f"altered: {altered}"
    if halves := _halves(folder, entries):
        return f"half-written: {halves}"
    rig = FakeRig()
    rig.resume(folder)
    count = len(STEPS) - len(good_frames(entries)) if missing is None else missing
    if rig.exposures != (count + 1 if count else 0):  # the room's own light is looked at first
        return f"shot {rig.exposures} pictures for {count} steps"
    return "; ".join(verify_capture(folder).findings)


def _halves(folder: Path, entries: Sequence[Entry]) -> list[str]:
    """Name what stands under a final name and is not whole: pictures, thumbnails and tables alike."""
    named = {entry["file"] for entry in entries if entry["ev"] == "frame"}
    pictures = {path for path in folder.glob("data/*/*.jpg") if not path.name.startswith(".")}
    broken = [path.name for path in pictures if not path.read_bytes().endswith(b"\xff\xd9")]
    return broken + [name for name in named if not (folder / name).is_file()]


def fault_34_disk_full_at_every_operation(campaign: Scale) -> Outcome:
    """The disk is full at one operation of a session, at each in turn, or from then on; then space is freed."""
    trials = wrong = held = refused = 0
    said = set[str]()
    for first in range(0, 1000, max(1, 20 // campaign.trials)):
        for count in (1, 1000):
            with quick_folder() as root:
                store = FullDisk(first, count)
                rig, safe = FakeRig(store), list[Entry]()
                rig.acknowledged = safe.append
                moved = False
                try:
                    rig.capture(STEPS, root / SESSION)
                except HoldError:
                    held += 1
                    moved = True
                except LitrigError:
                    refused += 1
                    moved = rig.turntable.torque
                wrong += moved and not safe
                if what := harm_after(root / SESSION, safe):
                    said.add(what)
                    wrong += 1
                trials += 1
        if store.asked <= first:
            break
    detail = f"{held} times on hold, {refused} times refused or not closed; nothing lost, resumed after space was freed"
    return Outcome(trials, wrong, "; ".join([detail, *sorted(said)]), passed=wrong == 0)


def fault_38_journal_cut_at_every_byte(campaign: Scale) -> Outcome:
    """The journal of a session ends anywhere: it opens, loses the torn line alone, and can be resumed from there."""
    wrong = resumed = 0
    chance = random.Random(38)
    with quick_folder() as root:
        folder = root / SESSION
        FakeRig().capture(STEPS, folder)
        FakeRig().retake(folder, 2)
        for tag in (layout.TAG_MANIFEST, layout.MANIFEST, layout.BAG_INFO):
            (folder / tag).unlink()  # as before the session was closed
        whole = (folder / layout.JOURNAL).read_bytes()
        lines = whole.splitlines(keepends=True)
        ends = [sum(map(len, lines[: count + 1])) for count in range(len(lines))]
        begun = ends[0]
        entries = read_journal(folder / layout.JOURNAL)
        from_here = set(chance.sample(range(begun, len(whole)), min(campaign.trials, len(whole) - begun)))
        for cut in range(len(whole) + 1):
            (folder / layout.JOURNAL).write_bytes(whole[:cut])
            found = read_journal(folder / layout.JOURNAL)
            wrong += found != entries[: sum(end <= cut for end in ends)]
            if cut in from_here:
                copy = root / "copy"
                shutil.copytree(folder, copy)
                wrong += bool(harm_after(copy, found))
                resumed += 1
                shutil.rmtree(copy)
    detail = f"every cut opens with the lines before it; resumed to a verified bag from {resumed} of them"
    return Outcome(len(whole) + 1, wrong, detail, passed=wrong == 0)


def fault_35_disk_gone_in_a_session(campaign: Scale) -> Outcome:
    """The folder turns read-only, or its share vanishes, at any frame of a session: on hold; back again, it goes on."""
    wrong = trials = 0
    said = set[str]()
    with tempfile.TemporaryDirectory() as name:
        root = Path(name)
        for trial in range(campaign.trials):
            at_frame, lose = 1 + trial // 2 % len(STEPS), (_read_only, _vanished)[trial % 2]
            real, share = root / f"real{trial}", root / f"share{trial}"
            real.mkdir()
            share.mkdir()
            if not _mounted("--bind", str(real), str(share)):
                return Outcome(0, 0, "not tried: needs the right to mount", passed=True)
            rig, safe, bring_back = FakeRig(), list[Entry](), list[Callable[[], None]]()
            rig.acknowledged = safe.append

            def mishap(rig: FakeRig = rig, at: int = at_frame, lose: Mishap = lose, share: Path = share) -> None:
                if rig.exposures == at:
                    bring_back.append(lose(share))  # noqa: B023  # called in this round only

            rig.before = mishap
            try:
                wrong += not _holds(rig, share / SESSION)
            finally:
                for action in bring_back:
                    action()
                subprocess.run(["umount", "-l", share], capture_output=True, check=False)
            if what := harm_after(real / SESSION, safe):
                said.add(what)
                wrong += 1
            trials += 1
    detail = "on hold; nothing lost, resumed when it was back"
    return Outcome(trials, wrong, "; ".join([detail, *sorted(said)]), passed=wrong == 0)


Mishap = Callable[[Path], Callable[[], None]]


def _holds(rig: FakeRig, folder: Path) -> bool:
    try:
        rig.capture(STEPS, folder)
    except HoldError as error:
        return str(folder) in str(error) and rig.turntable.stops > 0
    return False


def _read_only(share: Path) -> Callable[[], None]:
    _run("mount", "--bind", str(share), str(share))
    _run("mount", "-o", "remount,bind,ro", str(share))
    return lambda: _run("umount", str(share))


def _vanished(share: Path) -> Callable[[], None]:
    _run("umount", "-l", str(share))
    return lambda: None


def _mounted(*words: str) -> bool:
    return shutil.which("mount") is not None and not subprocess.run(["mount", *words], capture_output=True).returncode


def _run(*words: str) -> None:
    subprocess.run(words, capture_output=True, check=True)


def fault_44_bit_rot(campaign: Scale) -> Outcome:
    """Flip a bit of a file of a closed bag, lose one or add one, each alone and all at once: every one is named."""
    wrong = trials = 0
    chance = random.Random(44)
    with quick_folder() as root:
        folder = root / SESSION
        FakeRig().capture(STEPS, folder)
        files = sorted(path for path in folder.rglob("*") if path.is_file())
        for _ in range(campaign.trials):
            for path in files:
                name = path.relative_to(folder).as_posix()
                for harm in (_flip, _lose):
                    with _harmed(path, harm, chance):
                        wrong += not _is_named(folder, [name])
                    trials += 1
        for place in (folder, *sorted(path for path in folder.rglob("*") if path.is_dir())):
            stranger = place / "stranger.jpg"
            stranger.write_bytes(b"x")
            wrong += not _is_named(folder, [stranger.relative_to(folder).as_posix()])
            stranger.unlink()
            trials += 1
        payload = [path for path in files if path.is_relative_to(folder / layout.FRAMES)]
        for path in payload:
            _flip(path, chance)
        for command in (("amc", "build"), ("ptm", "fit")):
            result = litrig(*command, folder, "-o", root / "out.amc.ktx2" if command[0] == "amc" else root / "out.ptm")
            wrong += result.returncode != 1 or not any(path.name in result.stderr for path in payload)
            wrong += any(root.glob("out*"))
            trials += 1
        (folder / "data" / "new").mkdir()
        (folder / "data" / "new" / "a.txt").write_text("a")
        (folder / layout.SESSION).unlink()
        names = [path.relative_to(folder).as_posix() for path in payload]
        wrong += not _is_named(folder, [*names, "data/new/a.txt", layout.SESSION])
        trials += 1
    return Outcome(
        trials, wrong, f"{len(files)} files, every harm found by name; no fit takes a rotten frame", passed=wrong == 0
    )


def _is_named(folder: Path, names: Sequence[str]) -> bool:
    """Tell whether exactly these files are found to be wrong; a manifest's harm may show in what it names as well."""
    try:
        findings = verify_capture(folder).findings
    except LitrigError as error:
        findings = (str(error),)
    named = all(any(name in finding for finding in findings) for name in names)
    return named and (len(findings) == len(names) or names[0] in (layout.MANIFEST, layout.TAG_MANIFEST))


def _flip(path: Path, chance: random.Random) -> None:
    content = bytearray(path.read_bytes())
    bit = chance.randrange(8 * len(content))
    content[bit // 8] ^= 1 << bit % 8
    path.write_bytes(content)


def _lose(path: Path, _: random.Random) -> None:
    path.unlink()


@contextmanager
def _harmed(path: Path, harm: Callable[[Path, random.Random], None], chance: random.Random) -> Iterator[None]:
    content = path.read_bytes()
    harm(path, chance)
    try:
        yield
    finally:
        path.write_bytes(content)


def fault_21_two_writers(campaign: Scale) -> Outcome:
    """Several processes make a session in one folder at once: exactly one does, and nothing of it is damaged."""
    wrong = 0
    with quick_folder() as root:
        for trial in range(campaign.trials):
            folder = root / f"s{trial}" if trial % 2 else root / f"a{trial}" / "s"
            if trial % 4 == 3:
                folder.mkdir()
            rivals = [subprocess.Popen(_rival(folder), stdin=-1, stdout=-1, stderr=-1) for _ in range(3)]
            for rival in rivals:
                assert rival.stdout is not None
                assert rival.stdout.readline() == b"ready\n"
            for rival in rivals:
                assert rival.stdin is not None
                rival.stdin.write(b"\n")
                rival.stdin.flush()
            answers = [rival.communicate()[0].decode() for rival in rivals]
            wrong += sorted(answer.split(":")[0] for answer in answers) != ["made\n", "refused", "refused"]
            wrong += not (folder / layout.JOURNAL).exists() or len(read_journal(folder / layout.JOURNAL)) != 1
    return Outcome(campaign.trials, wrong, "one of three made it, the others were refused", passed=wrong == 0)


_RIVAL = """
import sys
from pathlib import Path
from litrig.base.capture_folder.writer import CaptureFolderWriter
from litrig.base.errors import LitrigError
print("ready", flush=True)
sys.stdin.readline()
try:
    with CaptureFolderWriter.create(Path(sys.argv[1]), "coin", {}, [{"step": 0}]):
        print("made", flush=True)
except LitrigError as error:
    print("refused:", error, flush=True)
"""


def _rival(folder: Path) -> list[str]:
    return [sys.executable, "-c", _RIVAL, str(folder)]


def fault_34_command_on_a_full_disk(campaign: Scale) -> Outcome:
    """A disk of 4 MB fills up, or files may not grow, while the command shoots: status 3; with space again, resumed."""
    wrong = list[str]()
    with small_disk("rw") as disk, quick_sim("amc") as sim:
        if disk is None:
            return Outcome(0, 0, "not tried: needs the right to mount", passed=True)
        for trial in range(campaign.trials):
            session, ballast = Session(sim, "amc", disk / f"s{trial}"), disk / "ballast"
            process = session.begin()
            wait_until(lambda s=session, n=1 + trial % 5: frames_in(s.folder) >= n, process)  # type: ignore[misc]
            if trial % 2:
                resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (2000, resource.RLIM_INFINITY))
            else:
                with suppress(OSError):
                    ballast.write_bytes(bytes(5_000_000))
            status = session.end(process)
            session.note_what_is_safe()
            if status != HOLD or "Traceback" in session.error or "on hold" not in session.error:
                wrong.append(f"status {status}: {session.error[-200:]}")
            wrong += session.lost()
            ballast.unlink(missing_ok=True)
            wrong += [] if session.finish() == 0 else [session.error[-200:]]
            wrong += session.flaws()
            shutil.rmtree(session.folder)
    detail = "on hold with status 3, nothing lost, resumed to a verified bag"
    return Outcome(campaign.trials, len(wrong), "; ".join([detail, *wrong[:3]]), passed=not wrong)
