"""Whether a long session takes ever more memory, and how soon one is resumed; in processes of their own.

Usage: python -m benchmarks.session_memory FOLDER shoot|resume
"""

import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import simplejpeg

from acquisition.plans import Step
from litrig.base.capture_folder import layout
from litrig.base.capture_folder.journal import read_journal
from tests.faults.fake_sessions import FakeRig

FRAMES, SETTLED = 2000, 100
"""How many frames, and after how many the session is as large as it will be."""
SHAPE = (480, 640, 3)
STEPS = tuple(Step(number, angle_deg=360 * number / FRAMES) for number in range(FRAMES))


def report(folder: Path) -> str:
    """Shoot a long session, lose its last frame, resume it."""
    start, end, most = _run(folder, "shoot")
    last = [entry for entry in read_journal(folder / layout.JOURNAL) if entry["ev"] == "frame"][-1]
    (folder / last["file"]).unlink()
    (ready_s,) = _run(folder, "resume")
    stored = sum(path.stat().st_size for path in (folder / layout.FRAMES).iterdir())
    memory = ", ".join(f"{size / 2**20:.0f}" for size in (start, end, most))
    return "\n".join(
        [
            "| what | figure | goal |",
            "| --- | --- | --- |",
            f"| {FRAMES} frames of {SHAPE[1]} × {SHAPE[0]}, {stored / 1e6:.0f} MB: memory after {SETTLED} frames, at "
            f"the end, at most | {memory} MiB | within 100 MB |",
            "| Resumed for the last one: until it is exposed, all others held against their sha256 | "
            f"{ready_s:.2f} s | ≤ 2 s |",
        ]
    )


def _run(folder: Path, what: str) -> list[float]:
    command = [sys.executable, "-m", "benchmarks.session_memory", str(folder), what]
    numbers: list[float] = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    return numbers


def _resident_bytes() -> int:
    return int(Path("/proc/self/status").read_text().split("VmRSS:")[1].split()[0]) * 1024


def main() -> None:
    folder, what = Path(sys.argv[1]), sys.argv[2]
    rig = FakeRig(lit=False)
    texture = np.random.default_rng(0).integers(60, 180, SHAPE, np.uint8)

    def paint() -> bytes:
        number = rig.exposures
        texture[:16, :16] = [number * 37 % 256, number * 11 % 256, number // 256 * 20]
        return bytes(simplejpeg.encode_jpeg(texture, 60))

    rig.paint = paint
    seen: list[int] = []
    if what == "shoot":
        rig.before = lambda: seen.append(_resident_bytes())
        rig.capture(STEPS, folder)
        numbers: list[float] = [seen[SETTLED], seen[-1], max(seen[SETTLED:])]
    else:
        instants: list[float] = []
        rig.before = lambda: instants.append(time.monotonic())
        start_s = time.monotonic()
        rig.resume(folder)
        numbers = [instants[0] - start_s]
    sys.stdout.write(json.dumps(numbers))


if __name__ == "__main__":
    main()
