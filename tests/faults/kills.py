"""Sessions of the real command that are killed, stopped or left alone by their terminal, and gone on with."""

import os
import random
import signal
import subprocess
import tempfile
import time
from collections.abc import Callable, Mapping
from pathlib import Path

from firmware_sim.launch import RunningSim
from litrig.base.capture_folder import layout
from tests.faults.outcome import Outcome, Scale
from tests.faults.real_sessions import FRAMES, Session, frames_in, quick_sim, read_lines, wait_until
from tests.system.command import LITRIG

KINDS = ("amc", "dome", "ptm")
SHARES = {"amc": 0.55, "dome": 0.4, "ptm": 0.05}
"""A PTM on an arm takes its time."""
STOPPED = 130
UNTIL_CLOSED = 12
NEARLY_S = 0.6


def fault_36_killed_sessions(campaign: Scale) -> Outcome:
    """Kill the command outright at random times of a session, again and again, and resume it until it is closed."""
    chance = random.Random(36)
    kills = again = sessions = most_again = 0
    wrong = list[str]()
    for kind in KINDS:
        if not (planned := round(campaign.trials * SHARES[kind])):
            continue
        with quick_sim(kind) as sim, tempfile.TemporaryDirectory() as name:
            done = 0
            while done < planned:
                session = Session(sim, kind, Path(name) / f"s{sessions}")
                sessions += 1
                few = chance.randint(1, 4)
                for _ in range(min(few, planned - done)):
                    _kill(session, chance)
                    done += 1
                    wrong += session.lost()
                if session.finish() != 0:
                    wrong.append(f"not resumed: {session.error.splitlines()[-1:]}")
                    continue
                wrong += session.flaws()
                orphans = _unacknowledged(session.folder)
                again, most_again = again + orphans, max(most_again, orphans - min(few, planned))
            kills += done
    detail = f"{sessions} sessions, {again} pictures shot again, every session a verified bag"
    passed = not wrong and most_again <= 0
    return Outcome(kills, len(wrong), "; ".join([detail, *wrong[:3]]), passed=passed)


def _kill(session: Session, chance: random.Random) -> None:
    """Kill it at any time, from its first breath to the closing of the bag."""
    process = session.begin()
    if chance.random() < 0.3:
        time.sleep(chance.uniform(0, 2.5))  # noqa: TID251  # a process outside: starting, opening, homing
    else:
        frames = frames_in(session.folder) + chance.randint(0, FRAMES[session.kind])
        frames = min(frames, FRAMES[session.kind])
        wait_until(lambda: read_lines(session.folder) and frames_in(session.folder) >= frames, process)
        time.sleep(chance.uniform(0, NEARLY_S))  # noqa: TID251  # between frames, in a write, in the close
    session.note_what_is_safe()
    process.kill()
    session.end(process)
    session.note_what_is_safe()


def _unacknowledged(folder: Path) -> int:
    named = {entry["file"] for entry in read_lines(folder) if entry["ev"] == "frame"}
    return sum(path.relative_to(folder).as_posix() not in named for path in (folder / layout.FRAMES).iterdir())


SIGNALS: Mapping[str, Callable[["subprocess.Popen[str]"], None]] = {
    "Ctrl-C": lambda process: process.send_signal(signal.SIGINT),
    "Ctrl-C twice": lambda process: _twice(process),
    "SIGTERM": lambda process: process.send_signal(signal.SIGTERM),
    "SIGHUP": lambda process: process.send_signal(signal.SIGHUP),
}


def _twice(process: "subprocess.Popen[str]") -> None:
    for _ in range(2):
        process.send_signal(signal.SIGINT)
        time.sleep(0.05)  # noqa: TID251  # a person's fingers


def fault_40_sessions_stopped_by_signals(campaign: Scale) -> Outcome:
    """Ctrl-C once or twice, SIGTERM or a hang-up at random times of a session: status 130, nothing lost, resumable."""
    chance = random.Random(40)
    wrong = list[str]()
    ended_before = 0
    with quick_sim("amc") as sim, tempfile.TemporaryDirectory() as name:
        for trial in range(campaign.trials):
            session = Session(sim, "amc", Path(name) / f"s{trial}")
            process = session.begin()
            frames = chance.randint(0, FRAMES["amc"])
            wait_until(lambda s=session, n=frames: read_lines(s.folder) and frames_in(s.folder) >= n, process)  # type: ignore[misc]
            time.sleep(chance.uniform(0, NEARLY_S))  # noqa: TID251  # anywhere between frames, parking and closing
            session.note_what_is_safe()
            what = list(SIGNALS)[trial % len(SIGNALS)]
            SIGNALS[what](process)
            status = session.end(process)
            session.note_what_is_safe()
            is_whole = (session.folder / layout.TAG_MANIFEST).exists()
            ended_before += status == 0
            if status != STOPPED and not (status == 0 and is_whole):
                wrong.append(f"{what}: status {status}")
            if "Traceback" in session.error:
                wrong.append(f"{what}: {session.error[-300:]}")
            wrong += session.lost()
            wrong += [] if session.finish() == 0 else [f"{what}: not resumed: {session.error[-200:]}"]
            wrong += session.flaws()
    detail = f"status 130 ({ended_before} times 0: it was done), every session resumed to a verified bag"
    return Outcome(campaign.trials, len(wrong), "; ".join([detail, *wrong[:3]]), passed=not wrong)


def fault_40_terminal_closed(campaign: Scale) -> Outcome:
    """The terminal that a session runs in is closed: it stops on the wire, loses nothing, and can be resumed."""
    wrong = list[str]()
    with quick_sim("amc") as sim, tempfile.TemporaryDirectory() as name:
        for trial in range(campaign.trials):
            session = Session(sim, "amc", Path(name) / f"s{trial}")
            status = _hang_up(sim, session)
            session.note_what_is_safe()
            last = read_lines(session.folder)[-1]["ev"]
            if last != "stop" or status != STOPPED:
                wrong.append(f"ended with {last}, status {status}")
            wrong += [] if session.finish() == 0 else [f"not resumed: {session.error[-200:]}"]
            wrong += session.flaws()
    detail = "stopped, nothing lost, resumed to a verified bag"
    return Outcome(campaign.trials, len(wrong), "; ".join([detail, *wrong[:3]]), passed=not wrong)


def _hang_up(sim: RunningSim, session: Session) -> int:
    """Start a session in a terminal of its own, and close that in the middle."""
    words = ("capture", "amc", str(sim.rig_toml), "-o", str(session.folder), "--slices", "8")
    pid, master = os.forkpty()
    if pid == 0:
        os.execvpe(LITRIG[0], [*LITRIG, *words], {**os.environ, **sim.environment})
    try:
        wait_until(lambda: frames_in(session.folder) >= 2)
    finally:
        os.close(master)
    _, status = os.waitpid(pid, 0)
    return os.waitstatus_to_exitcode(status)
