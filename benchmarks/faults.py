"""Try every fault at full scale and write the page. Usage: python -m benchmarks.faults docs/faults.md [NUMBER …]

A case is a function `fault_NN_name` in a module of tests/faults; the first line of its docstring says what goes wrong
and what must come of it. Ends with status 1 if a goal is missed.
"""

import importlib
import inspect
import os
import pkgutil
import platform
import re
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import cast

import tests.faults
from tests.faults.outcome import Outcome, Scale

TRIALS = 10_000
SLOW = {
    "fault_02_arm_dropped_bytes": 500,
    "fault_05_arm_late_answers": 2000,
    "fault_11_no_slip": 120,
    "fault_11_slip_in_a_session": 27,
    "fault_11_slips_seen": 480,
    "fault_12_goals_out_of_range": 2000,
    "fault_13_keep_out_zones": 1000,
    "fault_14_wrong_baud": 6,
    "fault_15_id_clash": 200,
    "fault_16_wrong_model": 6,
    "fault_17_arm_unplugged": 10,
    "fault_17_unplugged_in_a_session": 16,
    "fault_18_arm_replugged_on_the_wire": 3,
    "fault_19_permission_denied": 20,
    "fault_20_port_held": 1000,
    "fault_21_second_litrig": 10,
    "fault_21_second_resume": 30,
    "fault_21_two_writers": 40,
    "fault_22_arm_power_loss": 10,
    "fault_23_black_frames": 16,
    "fault_24_dead_lamps": 100,
    "fault_24_lamps_refused": 300,
    "fault_24_lamps_through_drop_outs": 300,
    "fault_24_lamps_through_stalls": 300,
    "fault_24_dead_lamp_of_the_arm": 6,
    "fault_25_frozen_camera": 16,
    "fault_26_pictures_show_their_poses": 128,
    "fault_27_late_pictures": 22,
    "fault_28_over_exposed": 3,
    "fault_29_drifting_settings": 28,
    "fault_30_camera_lost_for_a_moment": 24,
    "fault_30_camera_lost_for_good": 7,
    "fault_31_hanging_camera": 8,
    "fault_32_cut_pictures": 100,
    "fault_34_command_on_a_full_disk": 10,
    "fault_34_disk_full_at_every_operation": 20,
    "fault_35_disk_gone_in_a_session": 16,
    "fault_35_disk_too_small": 50,
    "fault_35_read_only_folder": 5,
    "fault_36_killed_sessions": 200,
    "fault_36_lamp_of_a_killed_host": 5,
    "fault_37_power_cut": 200,
    "fault_38_journal_cut_at_every_byte": 200,
    "fault_39_clock_jumps": 5,
    "fault_40_arm_hard_limit": 10,
    "fault_40_arm_stopped_by_signals": 20,
    "fault_40_sessions_stopped_by_signals": 60,
    "fault_40_terminal_closed": 5,
    "fault_42_exactly_the_missing": 200,
    "fault_43_changed_configuration": 3,
    "fault_44_bit_rot": 5,
}
"""How often cases are tried of which each trial starts a rig, a command or a process."""
Case = Callable[[Scale], Outcome]

TEXT = """# Faults: what goes wrong, and what comes of it

Made by `make faults`: mishaps on the wires, in the devices, on the host and to whole sessions, tried against the
simulated rig through the very drivers that real hardware uses, and against devices in memory where thousands of
sessions are needed. "Wrong" counts what must never be: a value, pose or picture accepted that was not so, a frame lost.
`make test` runs nearly every case on a small scale.

Last run: Python {python}, {cores} cores, {machine}.

| no. | fault | trials | wrong | what came out | goal |
| --- | --- | --- | --- | --- | --- |
{rows}
"""


def cases() -> Iterator[tuple[int, Case]]:
    """Find the cases of all modules, by their numbers."""
    found: list[tuple[int, str, Case]] = []
    for module in pkgutil.iter_modules(tests.faults.__path__):
        if module.name.startswith("test_"):
            continue
        for name, case in inspect.getmembers(importlib.import_module(f"tests.faults.{module.name}"), callable):
            if number := re.fullmatch(r"fault_(\d+)_\w+", name):
                found.append((int(number[1]), name, cast(Case, case)))
    return ((number, case) for number, _, case in sorted(found, key=lambda each: each[:2]))


def row(number: int, case: Case) -> tuple[str, bool]:
    """Try a case, and describe it; one that breaks off has missed its goal."""
    start_s = time.monotonic()
    try:
        outcome = case(Scale(SLOW.get(case.__name__, TRIALS)))
    except Exception as error:  # the other faults are to be tried all the same
        outcome = Outcome(0, 0, f"broke off: {type(error).__name__}: {error}", passed=False)
    what = (inspect.getdoc(case) or "").splitlines()[0]
    goal = "met" if outcome.passed else "**missed**"
    sys.stderr.write(f"{number}: {goal}, {time.monotonic() - start_s:.0f} s: {outcome.detail}\n")
    return f"| {number} | {what} | {outcome.trials} | {outcome.wrong} | {outcome.detail} | {goal} |", outcome.passed


def main() -> int:
    wanted = {int(word) for word in sys.argv[2:]}
    done = [row(number, case) for number, case in cases() if not wanted or number in wanted]
    page = TEXT.format(
        python=platform.python_version(),
        cores=os.cpu_count(),
        machine=platform.machine(),
        rows="\n".join(line for line, _ in done),
    )
    if wanted:
        sys.stdout.write(page)
    else:
        Path(sys.argv[1]).write_text(page, encoding="utf-8")
    return 0 if all(passed for _, passed in done) else 1


if __name__ == "__main__":
    sys.exit(main())
