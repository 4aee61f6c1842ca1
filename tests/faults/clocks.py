"""A wall clock that jumps by years in a session: it is a label, and nothing goes by it."""

import itertools
import random
import subprocess
import tempfile
from datetime import datetime
from pathlib import Path

from litrig.base.capture_folder.journal import Entry
from tests.faults.outcome import Outcome, Scale
from tests.faults.real_sessions import FRAMES, Session, frames_in, quick_sim, read_lines, wait_until

YEAR_S = 31_557_600
# Every program under it sees a real-time clock that is off by what a file says; the monotonic one is left alone.
_SHIM = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/time.h>
#include <time.h>
static long off(void) {
    long seconds = 0;
    FILE *file = fopen(getenv("JUMPED_CLOCK"), "r");
    if (file) { if (fscanf(file, "%ld", &seconds) != 1) seconds = 0; fclose(file); }
    return seconds;
}
int clock_gettime(clockid_t clock, struct timespec *time) {
    static int (*real)(clockid_t, struct timespec *);
    if (!real) real = dlsym(RTLD_NEXT, "clock_gettime");
    int result = real(clock, time);
    if (result == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE)) time->tv_sec += off();
    return result;
}
int gettimeofday(struct timeval *restrict time, void *restrict zone) {
    struct timespec now;
    (void)zone;
    clock_gettime(CLOCK_REALTIME, &now);
    time->tv_sec = now.tv_sec, time->tv_usec = now.tv_nsec / 1000;
    return 0;
}
time_t time(time_t *place) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    if (place) *place = now.tv_sec;
    return now.tv_sec;
}
"""


def fault_39_clock_jumps(campaign: Scale) -> Outcome:
    """The wall clock jumps by years, back and forth, while the command shoots: complete, in order, timed as ever."""
    chance = random.Random(39)
    wrong = jumps = 0
    with quick_sim("amc") as sim, tempfile.TemporaryDirectory() as name:
        shim, offset = Path(name) / "clock.so", Path(name) / "offset"
        subprocess.run(["cc", "-shared", "-fPIC", "-xc", "-", "-o", shim, "-ldl"], input=_SHIM.encode(), check=True)
        offset.write_text("0")
        environment = {"LD_PRELOAD": f"{sim.environment['LD_PRELOAD']}:{shim}", "JUMPED_CLOCK": str(offset)}
        for trial in range(campaign.trials):
            session = Session(sim, "amc", Path(name) / f"s{trial}")
            process = session.begin(environment=environment)
            for count in range(FRAMES["amc"]):
                if not wait_until(lambda s=session, n=count: frames_in(s.folder) >= n, process):  # type: ignore[misc]
                    break
                offset.write_text(str(chance.randint(-30, 30) * YEAR_S))
                jumps += 1
            wrong += session.end(process) != 0 or bool(session.flaws()) or not _is_timed(read_lines(session.folder))
            wrong += not _jumped(read_lines(session.folder))
    return Outcome(campaign.trials, wrong, f"{jumps} jumps; complete, in order, times as ever", passed=wrong == 0)


def _is_timed(entries: list[Entry]) -> bool:
    """Tell whether instants rise and durations are those of a quick session."""
    rising = all(before["mono_ns"] < after["mono_ns"] for before, after in itertools.pairwise(entries))
    frames = [entry for entry in entries if entry["ev"] == "frame"]
    return rising and all(0 <= seconds < 60 for entry in frames for seconds in entry["times_s"].values())


def _jumped(entries: list[Entry]) -> bool:
    """Tell whether the labels did jump, so that something was tried."""
    years = {datetime.fromisoformat(entry["t"]).year for entry in entries}
    return len(years) > 2
