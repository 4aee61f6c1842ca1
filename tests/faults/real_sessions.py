"""Sessions of the real command on a simulated rig: started, watched from outside, and judged by what they left."""

import re
import subprocess
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from firmware_sim.config import SimConfig
from firmware_sim.launch import RunningSim, simulated_rig
from litrig.base.capture_folder import layout
from litrig.base.capture_folder.bag import sha256_of
from litrig.base.capture_folder.journal import Entry, decode_entry
from litrig.base.capture_folder.reader import good_frames
from litrig.base.capture_folder.verify import verify_capture
from tests.rig.grbl.bench import QUICK
from tests.system.command import start

CAMERA = {"width": 320, "height": 240}
SCENES: Mapping[str, Mapping[str, Any]] = {
    "amc": {"camera": CAMERA},
    "ptm": {"camera": CAMERA, "scene": {"kind": "relief"}, "arm": {"settings": QUICK}},
    "dome": {"camera": CAMERA, "scene": {"kind": "relief"}, "dome": {"lamps": 8}},
}
COMMANDS: Mapping[str, tuple[str, ...]] = {
    "amc": ("amc", "--slices", "8"),
    "ptm": ("ptm", "--lights", "6"),
    "dome": ("ptm", "--lights", "8"),
}
FRAMES = {"amc": 8, "ptm": 6, "dome": 8}
PATIENCE_S = 120.0


_SHARED: dict[str, RunningSim] = {}


@contextmanager
def sharing_sims() -> Iterator[None]:
    """Let cases within have the same simulated rigs, mended in between, where they want nothing special of them."""
    with ExitStack() as running:
        _SHARED.update({kind: running.enter_context(_started(kind, {})) for kind in ("amc",)})
        try:
            yield
        finally:
            _SHARED.clear()


@contextmanager
def quick_sim(kind: str, **changes: Mapping[str, Any]) -> Iterator[RunningSim]:
    """Run a rig whose pictures are small and whose moves are quick."""
    if changes or kind not in _SHARED:
        with _started(kind, changes) as sim:
            yield sim
        return
    try:
        yield _SHARED[kind]
    finally:
        for what in ("camera.mend", "turntable.mend"):
            _SHARED[kind].side_channel.request(what)


@contextmanager
def _started(kind: str, changes: Mapping[str, Mapping[str, Any]]) -> Iterator[RunningSim]:
    scene = {**SCENES[kind], **{key: {**SCENES[kind].get(key, {}), **value} for key, value in changes.items()}}
    with simulated_rig(SimConfig.model_validate(scene)) as sim:
        text = sim.rig_toml.read_text("utf-8")
        quick = re.sub(
            r'(\[turntable\]\nkind = "dynamixel"\n)', r"\1speed_deg_s = 360.0\nacceleration_deg_s2 = 3000.0\n", text
        )
        sim.rig_toml.write_text(quick, encoding="utf-8")
        yield sim


class Session:
    """A session of the command, from outside."""

    def __init__(self, sim: RunningSim, kind: str, folder: Path) -> None:
        self.sim, self.kind, self.folder = sim, kind, folder
        self.safe: dict[str, Entry] = {}
        self.parts = 0
        self.error = ""

    def begin(self, *options: str, environment: Mapping[str, str] | None = None) -> "subprocess.Popen[str]":
        """Start it, or go on with it where it has begun."""
        self.parts += 1
        env = {**self.sim.environment, **(environment or {})}
        if (self.folder / layout.JOURNAL).is_file() and read_lines(self.folder):
            words: tuple[str | Path, ...] = ("resume", self.folder, "--rig", self.sim.rig_toml, *options)
        else:
            what, *numbers = COMMANDS[self.kind]
            self.folder = self.folder if not self.folder.exists() else self.folder.with_name(f"{self.folder.name}x")
            words = (what, self.sim.rig_toml, "-o", self.folder, *numbers, *options)
        return start("capture", *words, environment=env)

    def end(self, process: "subprocess.Popen[str]") -> int:
        """Wait for it."""
        self.error = process.communicate(timeout=PATIENCE_S)[1]
        return process.returncode

    def finish(self, most: int = 10) -> int:
        """Go on until it is closed; return the last status."""
        status = -1
        for _ in range(most):
            status = self.end(self.begin())
            if status == 0:
                break
        return status

    def note_what_is_safe(self) -> list[Entry]:
        """Remember the frames that the journal acknowledges now."""
        lines = read_lines(self.folder)
        self.safe |= {entry["file"]: entry for entry in lines if entry["ev"] == "frame"}
        return lines

    def lost(self) -> list[str]:
        """Name acknowledged frames that are no longer in the journal, or not as they were."""
        there = {entry["file"]: entry for entry in read_lines(self.folder) if entry["ev"] == "frame"}
        return [
            file
            for file, entry in self.safe.items()
            if there.get(file) != entry or sha256_of(self.folder / file) != entry["sha256"]
        ]

    def flaws(self) -> list[str]:
        """Say what is wrong with the closed session, if anything is."""
        found = verify_capture(self.folder)
        lines = read_lines(self.folder)
        frames = [entry for entry in lines if entry["ev"] == "frame"]
        twice = [step for step, count in Counter(entry["step"] for entry in frames).items() if count > 1]
        flaws = [*self.lost(), *found.findings]
        if twice:
            flaws.append(f"steps {twice} have two good frames")
        if len(good_frames(lines)) != FRAMES[self.kind] or not found.closed:
            flaws.append(f"{len(frames)} of {FRAMES[self.kind]} frames, closed: {found.closed}")
        if [entry["seq"] for entry in lines] != list(range(len(lines))):
            flaws.append("the journal's numbers do not rise one by one")
        return flaws


def read_lines(folder: Path) -> list[Entry]:
    """Read the journal as it grows; none if there is none yet."""
    try:
        lines = (folder / layout.JOURNAL).read_bytes().splitlines(keepends=True)
    except OSError:
        return []
    return [entry for line in lines if (entry := decode_entry(line)) is not None]


def wait_until(true: Callable[[], object], process: "subprocess.Popen[str] | None" = None) -> bool:
    """Wait for something outside; False if the process ends before."""
    deadline_s = time.monotonic() + PATIENCE_S
    while not true():
        if process is not None and process.poll() is not None:
            return bool(true())
        assert time.monotonic() < deadline_s, "waited in vain"
        time.sleep(0.01)  # noqa: TID251  # a process outside is waited for
    return True


def frames_in(folder: Path) -> int:
    return sum(entry["ev"] == "frame" for entry in read_lines(folder))


def steps_of(entries: Sequence[Entry]) -> list[int]:
    return [entry["step"] for entry in entries if entry["ev"] == "frame"]
