"""How much memory a build takes above the interpreter, in a process of its own each.

Usage: python -m benchmarks.amc_memory FOLDER SLICES find|ignore, which prints the peak in bytes before and after; the
last says whether flaws are looked for.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Literal

from benchmarks.amc import turn_of
from benchmarks.measure import peak_bytes
from litrig.base.capture_folder.capture import Capture, CapturedFrame
from processing.amc.build import build
from processing.amc.files.ktx2 import write_amc
from processing.amc.settings import Settings
from processing.outline.circle import Circle

SIZE, SHAPE = 256, (720, 1280)
_TABLE_BYTES = SIZE**3 * 3 * 4
_FILE_BYTES = SIZE**3 * 4


def report(folder: Path) -> str:
    """Build 256³ from 1280 × 720 and write it; say the peak beside the result."""
    lines = [
        "| what | peak above the interpreter, MiB | by the table (192 MiB) | by the file's texels (64 MiB) | goal |",
        "| --- | --- | --- | --- | --- |",
    ]
    for slices, invariance in ((256, 1), (512, 2)):
        turn = folder / f"turn{slices}"
        turn_of(turn, slices, SHAPE)
        what = f"{slices} JPEGs of 1280 × 720 to 256³, R = {invariance}, built and written"
        for named, defects, goal in ((what, "ignore", "≤ 6"), ("the same with flaws looked for", "find", "")):
            before, after = _measured(turn, slices, defects)
            used = after - before
            shares = f"{used / _TABLE_BYTES:.1f} | {used / _FILE_BYTES:.1f}"
            lines.append(f"| {named} | {used / 2**20:.0f} | {shares} | {goal} |")
    return "\n".join(lines)


def _measured(folder: Path, slices: int, defects: str) -> tuple[int, int]:
    command = [sys.executable, "-m", "benchmarks.amc_memory", str(folder), str(slices), defects]
    before, after = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    return before, after


def main() -> None:
    folder, slices, find = Path(sys.argv[1]), int(sys.argv[2]), sys.argv[3] == "find"
    paths = sorted(folder.glob("*.jpg"))
    frames = tuple(CapturedFrame(path, angle_deg=360 * index / slices) for index, path in enumerate(paths))
    radius = 0.375 * SHAPE[0]
    circle = Circle(SHAPE[1] / 2, SHAPE[0] / 2, radius)
    defects: Literal["find", "ignore"] = "find" if find else "ignore"
    settings = Settings(size=16, circle=circle, depth=16, defects=defects)
    build(Capture(folder, "sphere", frames[:: slices // 16]), settings)  # loads what is loaded once
    before = peak_bytes()
    settings = Settings(size=SIZE, circle=circle, depth=SIZE, invariance=slices // SIZE, defects=defects)
    result = build(Capture(folder, "sphere", frames), settings)
    with tempfile.TemporaryDirectory() as out:
        write_amc(Path(out) / "x.amc.ktx2", result.amc)
    sys.stdout.write(json.dumps([before, peak_bytes()]))


if __name__ == "__main__":
    main()
