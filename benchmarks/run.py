"""Run every benchmark and write the table. Usage: python -m benchmarks.run docs/benchmarks.md"""

import os
import platform
import sys
import tempfile
from pathlib import Path

from benchmarks import (
    amc,
    amc_memory,
    arm_wires,
    manipulation,
    ptm,
    recomposition,
    relighting,
    separation,
    session_memory,
    sessions,
    shape,
    storage,
    synthesis,
    viewing,
    wires,
)
from benchmarks.measure import table

TEXT = """# Benchmarks

Made by `make bench`. Both sides of a row run in turn within one process, on warm caches; the ratio is what counts, the
seconds only say of what order things are. Fast and wrong does not count: each benchmark checks its result first.

Last run: Python {python}, {cores} cores, {machine}.

{table}

## Memory

Frames are streamed; what is held is the slices, which the table overwrites. Beyond 256 MiB they are held in a temporary
file instead, mapped only as far as they are looked at. Peaks of a process of its own, mapped pages included.

{memory}

Pictures under many lights are needed all at once. Past the budget they lie in a temporary file, and what of it is
mapped counts here too.

{ptm_memory}

A session holds one frame at a time, and the journal only while it is resumed.

{session_memory}

## Rejection by projections

Share of neighbourhoods that is left out of the search for a block, after so many projections, over a synthesis of 102²;
and how many are measured in the end. The paper reports 90 % after the first, and few left after about three.

{rejections}
"""


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        rows = [
            *ptm.comparisons(folder),
            *amc.comparisons(folder),
            *viewing.comparisons(),
            *manipulation.comparisons(),
            *relighting.comparisons(folder),
            *synthesis.comparisons(folder),
            *separation.comparisons(folder),
            *shape.comparisons(),
            *recomposition.comparisons(),
            *storage.comparisons(folder),
            *wires.comparisons(),
            *arm_wires.comparisons(),
            *sessions.comparisons(folder),
        ]
        peaks = amc_memory.report(folder)
        ptm_peaks = ptm.memory(folder)
        session = session_memory.report(folder / "long")
        rejections = synthesis.rejections(folder)
    page = TEXT.format(
        python=platform.python_version(),
        cores=os.cpu_count(),
        machine=platform.machine(),
        table=table(rows),
        memory=peaks,
        ptm_memory=ptm_peaks,
        session_memory=session,
        rejections=rejections,
    )
    Path(sys.argv[1]).write_text(page, encoding="utf-8")
    sys.stdout.write(page)


main()
