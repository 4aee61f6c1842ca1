"""Faults of the light arm, its lamp and a stepper turntable, on simulated controllers.

Most run in one process on a clock that nobody waits for; what depends on processes and signals runs on real ports.
"""

import random
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial

import numpy as np

from firmware_sim.config import SimConfig
from firmware_sim.grbl.config import GrblFaults
from firmware_sim.launch import RunningSim, simulated_rig
from firmware_sim.server import LINKS_NAME
from firmware_sim.side_channel import SideChannel
from rig.clock import MonotonicClock
from rig.config import RigConfig, read_rig
from rig.devices import ArmPose
from rig.errors import DeviceError, LinkError, LinkTimeoutError, OutOfRangeError, PositionLostError, RigError
from rig.grbl.arm import GrblArm
from rig.grbl.controller import GrblController
from rig.rig import Rig, RigState, open_rig
from tests.faults.outcome import Outcome, Scale
from tests.rig.grbl.bench import BAUD, QUICK, Bench, LoopPort
from tests.system.command import start

STOP_S = 0.5
CLOSE_DEG = 0.25
EXCHANGE_BYTES = 41
POST = {"name": "camera post", "azimuth_deg": (80, 100), "elevation_deg": (20, 60)}
TOWER = {"name": "tower", "azimuth_deg": (230, 260), "elevation_deg": (0, 45)}
PATIENCE_S = 60.0
LAMP_S = 1.5
PARTS = frozenset({"arm", "lights"})
_LIGHT_AND_WAIT = """
import sys
from pathlib import Path
from rig.config import read_rig
from rig.rig import open_rig
rig = open_rig(read_rig(Path(sys.argv[1])), use=frozenset({"arm", "lights"}))
rig.home()
rig.lights.switch_on()
print("lit", flush=True)
sys.stdin.read()
"""


def fault_01_arm_flipped_bits(campaign: Scale) -> Outcome:
    """Flip a bit of an answer, another one each time: no position is believed that is not true."""
    bench = Bench()
    controller = bench.controller()
    controller.home(60)
    wrong = errors = 0
    for trial in range(campaign.trials):
        bench.wire.garble, bench.wire.bit = 1, trial
        try:
            wrong += controller.position() != (-1.0, -1.0, -1.0)
        except RigError:
            errors += 1
    passed = wrong == 0 and errors == 0
    return Outcome(campaign.trials, wrong, f"{errors} errors, all others asked again and read right", passed)


def fault_02_arm_dropped_bytes(campaign: Scale) -> Outcome:
    """Lose a byte to the controller at every place of a move: the arm ends where it was told, after three tries."""
    wrong = most = trials = 0
    for round_ in range(max(1, campaign.trials // EXCHANGE_BYTES)):
        for place in range(EXCHANGE_BYTES):
            bench = Bench()
            arm = bench.arm()
            arm.home()
            bench.wire.drop_heard(place, 1 + round_ % 2)
            arm.move_to(100.0 + round_ % 50, 40.0)
            wrong += not _stands_at(bench, 100.0 + round_ % 50, 40.0)
            most = max(most, bench.port.sent().count(b"G53G1"))
            trials += 1
    passed = wrong == 0 and most <= 3
    return Outcome(trials, wrong, f"at most {most} tries", passed)


def fault_05_arm_late_answers(campaign: Scale) -> Outcome:
    """Let answers come late, get lost or be damaged at random: whatever is not right is an error."""
    faults = GrblFaults(mute=0.02, garble=0.02, delay=0.05, delay_s=1.1, seed=5)
    bench = Bench(faults=faults)
    arm = bench.arm()
    wrong = errors = 0
    pick = random.Random(5)  # goals, not secrets
    homed = False
    for _ in range(campaign.trials):
        azimuth, elevation = pick.uniform(0, 359), pick.uniform(10, 80)
        try:
            if not homed:
                arm.home()
            homed = True
            pose = arm.move_to(azimuth, elevation)
        except (LinkError, DeviceError):
            errors += 1
            homed = False
            continue
        wrong += not (_stands_at(bench, azimuth, elevation) and _is_near(pose, azimuth, elevation))
    return Outcome(campaign.trials, wrong, f"{errors} honest errors in {campaign.trials} moves", passed=wrong == 0)


def fault_12_goals_out_of_range(campaign: Scale) -> Outcome:
    """Ask arm and turntable for what lies beyond their limits: refused, and not a byte is sent."""
    bench, table_bench = Bench(), Bench(settings={20: 0, 22: 0})
    arm = bench.arm(max_azimuth_deg=300)
    table = table_bench.turntable(axis="X", min_deg=-90, max_deg=90)
    arm.home()
    table.home()
    for port in (bench.port, table_bench.port):
        port.written.clear()
    pick = random.Random(12)
    wrong = 0
    for _ in range(campaign.trials):
        direction = pick.choice(((pick.uniform(301, 359), 40.0), (40.0, pick.uniform(88.1, 90)), (40.0, -1e9)))
        wrong += not _refuses(partial(arm.move_to, *direction))
        angle = pick.choice((-1, 1)) * pick.uniform(90.001, 1e6)
        wrong += not _refuses(partial(table.move_to, angle))
    sent = len(bench.port.sent()) + len(table_bench.port.sent())
    return Outcome(2 * campaign.trials, wrong, f"{sent} bytes on the wire", passed=wrong == 0 and sent == 0)


def fault_13_keep_out_zones(campaign: Scale) -> Outcome:
    """Send the arm from anywhere to anywhere between two zones: it enters neither, and refuses goals within."""
    bench = Bench()
    arm = bench.arm(zones=[POST, TOWER])
    arm.home()
    pick = random.Random(13)
    wrong = refused = 0
    for _ in range(campaign.trials):
        azimuth, elevation = pick.uniform(0, 359), pick.uniform(6, 85)
        inside = _in_a_zone(azimuth, elevation)
        bench.port.written.clear()
        began_s = bench.clock.time_s
        try:
            arm.move_to(azimuth, elevation)
        except OutOfRangeError:
            refused += 1
            wrong += not inside or bool(bench.port.sent())
            continue
        times_s = np.arange(max(began_s, bench.clock.time_s - 9), bench.clock.time_s, 0.01)
        wrong += inside or any(_in_a_zone(x + 360, y + 90) for x, y, _ in map(bench.sim.position, times_s))
    return Outcome(campaign.trials, wrong, f"{refused} goals within refused with 0 bytes sent", passed=wrong == 0)


def fault_17_arm_unplugged(campaign: Scale) -> Outcome:
    """Pull the cable in the middle of a move: the rig holds; under another name it is homed and goes on (row 18)."""
    wrong = 0
    for trial in range(campaign.trials):
        bench = Bench()
        rig = _rig_on(bench)
        rig.home()
        error = _unplug_during_a_move(bench, rig, after_s=0.05 * (trial % 20))
        held = rig.hold()
        bench.clock.sleep(5)
        again = LoopPort(bench.wire, bench.clock)
        arm = bench.arm(GrblController("another name", BAUD, bench.clock, again))
        refused = _raises(DeviceError, partial(arm.move_to, 30, 30))
        arm.home()
        arm.move_to(30, 30)
        right = isinstance(error, LinkTimeoutError) and rig.state is RigState.HOLD and bool(held)
        wrong += not (right and refused and _stands_at(bench, 30, 30))
    return Outcome(campaign.trials, wrong, "on hold; moves only after homing on the new port", passed=wrong == 0)


def fault_18_arm_replugged_on_the_wire(campaign: Scale) -> Outcome:
    """Pull the adapter of a real port in a move: told at once; by its link it is found under another name."""
    wrong, slowest_s = 0, 0.0
    with _lit_rig() as sim:
        config = _by_its_link(sim)
        for _ in range(campaign.trials):
            rig = open_rig(config, use=PARTS)
            rig.home()
            before = sim.side_channel.status()["wires"]["arm"]["port"]
            pulled_s: list[float] = []
            timer = threading.Timer(0.4, partial(_pull, sim, pulled_s))
            timer.start()
            told = _raises(LinkError, partial(_light_and_hold, rig))
            timer.join()
            slowest_s = max(slowest_s, time.monotonic() - pulled_s[0])
            after = sim.side_channel.request("arm.replug")["port"]
            with open_rig(config, use=PARTS) as again:
                again.home()
                again.light_from(40, 40)
            status = sim.side_channel.status()
            right = abs(status["azimuth_deg"] - 40) < CLOSE_DEG and abs(status["elevation_deg"] - 40) < CLOSE_DEG
            wrong += not (told and rig.state is RigState.HOLD and right and before != after) or slowest_s > 1.0
    detail = f"told {slowest_s:.3f} s after; homed and right on the new port"
    return Outcome(campaign.trials, wrong, detail, passed=wrong == 0)


def fault_22_arm_power_loss(campaign: Scale) -> Outcome:
    """Cut the supply of the controller in the middle of a move or at rest: told as a lost position before a frame."""
    wrong = 0
    for trial in range(campaign.trials):
        bench = Bench()
        arm = bench.arm()
        arm.home()
        moving = trial % 2
        cut_s = bench.clock.time_s + (0.1 + 0.02 * (trial % 25) if moving else 0.0)
        wrong += not _raises(PositionLostError, partial(_cut_and_look, bench, arm, cut_s))
        wrong += not _raises(DeviceError, partial(arm.move_to, 60, 40))
        arm.stop()
        arm.home()
        arm.move_to(60, 40)
        wrong += not _stands_at(bench, 60, 40)
    return Outcome(campaign.trials, wrong, "position lost, moves refused until homed", passed=wrong == 0)


def fault_40_arm_hard_limit(campaign: Scale) -> Outcome:
    """Hit a limit switch in the middle of a move: the position is lost, and said so; lamps dark."""
    wrong = 0
    for trial in range(campaign.trials):
        bench = Bench(settings={21: 1, 27: 5})
        rig = _rig_on(bench)
        rig.home()
        rig.light_from(200, 40)
        bench.sim.lose_steps("X", -20 - trial % 60)
        wrong += not _raises(PositionLostError, partial(rig.light_from, 355, 40))
        wrong += rig.position_known or rig.state is not RigState.ALARM or bench.sim.lamp.power > 0
    return Outcome(campaign.trials, wrong, "alarm 1, position lost, state alarm", passed=wrong == 0)


def fault_40_arm_stopped_by_signals(campaign: Scale) -> Outcome:
    """Ctrl-C or SIGTERM in the middle of a move: the hold is on the wire within half a second, the position kept."""
    wrong, slowest_s = 0, 0.0
    with _lit_rig() as sim:
        for trial in range(campaign.trials):
            signals = (signal.SIGINT, signal.SIGTERM)
            took_s, known = _stop_a_move(sim, signals[trial % 2])
            slowest_s = max(slowest_s, took_s)
            wrong += took_s > STOP_S or not known
    return Outcome(campaign.trials, wrong, f"slowest {slowest_s:.3f} s, position kept", passed=wrong == 0)


def fault_36_lamp_of_a_killed_host(campaign: Scale) -> Outcome:
    """Kill a host outright while the lamp burns: the firmware puts it out when its time is over."""
    wrong, longest_s = 0, 0.0
    with _lit_rig() as sim:
        text = sim.rig_toml.read_text("utf-8")
        short = sim.rig_toml.with_name("short.toml")
        arm_part = text[text.index("[arm]") : text.index("[camera]")]
        short.write_text(arm_part.replace("power = 1000", f"power = 1000\ntimeout_s = {LAMP_S}"), encoding="utf-8")
        for _ in range(campaign.trials):
            with subprocess.Popen(
                [sys.executable, "-c", _LIGHT_AND_WAIT, str(short)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
            ) as host:
                assert host.stdout is not None
                assert host.stdout.readline() == b"lit\n"
                lit_s = time.monotonic()
                burned = sim.side_channel.status()["lamp"] == 1
                host.kill()
            dark_s = _wait(lambda: sim.side_channel.status()["lamp"] == 0) - lit_s
            longest_s = max(longest_s, dark_s)
            wrong += not burned or dark_s > LAMP_S + 1.0
    detail = f"dark {longest_s:.2f} s after it was lit, of {LAMP_S:g} s allowed"
    return Outcome(campaign.trials, wrong, detail, passed=wrong == 0)


# How the trials are made


@contextmanager
def _lit_rig() -> Iterator[RunningSim]:
    """Run a rig whose arm carries the lamp, and homes in a second."""
    config = SimConfig.model_validate({"scene": {"kind": "relief"}, "arm": {"settings": QUICK}})
    with simulated_rig(config) as sim:
        yield sim


def _rig_on(bench: Bench) -> Rig:
    config = RigConfig.model_validate({"arm": {"port": "a loop"}, "lights": {"kind": "grbl-spindle"}})
    controller = bench.controller()
    return Rig(config, clock=bench.clock, arm=bench.arm(controller), lights=bench.lamp(controller))


def _refuses(action: Callable[[], object]) -> bool:
    return _raises(OutOfRangeError, action)


def _raises(kind: type[Exception], action: Callable[[], object]) -> bool:
    try:
        action()
    except kind:
        return True
    except RigError:
        return False
    return False


def _unplug_during_a_move(bench: Bench, rig: Rig, after_s: float) -> Exception | None:
    bench.port.unplug_at_s = bench.clock.time_s + after_s
    try:
        rig.light_from(200, 40)
    except RigError as error:
        return error
    return None


def _cut_and_look(bench: Bench, arm: GrblArm, cut_s: float) -> None:
    """Move while the supply fails, or look where it is after it failed."""
    if cut_s > bench.clock.time_s:
        bench.port.at(cut_s, lambda: bench.sim.lose_power(0.2))
        arm.move_to(300, 60)
    else:
        bench.sim.lose_power(0.2)
        bench.clock.sleep(0.5)
    arm.locate()


def _by_its_link(sim: RunningSim) -> RigConfig:
    """Name the arm's port as udev does, by what does not change when it is plugged in again."""
    config = read_rig(sim.rig_toml)
    assert config.arm is not None
    link = sim.rig_toml.parent / LINKS_NAME / "arm"
    return config.model_copy(update={"arm": config.arm.model_copy(update={"port": str(link)})})


def _light_and_hold(rig: Rig) -> None:
    with rig:
        rig.light_from(20, 20)


def _pull(sim: RunningSim, pulled_s: list[float]) -> None:
    with SideChannel(sim.side_channel.path) as channel:  # a connection is for one thread
        channel.request("arm.unplug")
    pulled_s.append(time.monotonic())


def _stop_a_move(sim: RunningSim, number: int) -> tuple[float, bool]:
    """Return how long after the signal the hold was on the wire, and whether the controller knows where it is."""
    command = ("rig", "light", sim.rig_toml, "--azimuth", "20", "--elevation", "20")
    process = start(*command, environment=sim.environment)
    _wait(lambda: sim.side_channel.status()["arm_state"] == "Run")
    process.send_signal(number)
    asked_s = time.monotonic()
    process.communicate(timeout=PATIENCE_S)
    recent = sim.side_channel.status()["wires"]["arm"]["recent"]
    heard = [(heard_s, bytes.fromhex(said)) for heard_s, way, said in recent if way == "in"]
    holds = [heard_s for heard_s, said in heard if b"!" in said and heard_s > asked_s - 0.01]
    status = sim.side_channel.status()
    return (holds[0] - asked_s if holds else PATIENCE_S), status["arm_state"] == "Idle" and status["lamp"] == 0


def _wait(true: Callable[[], bool]) -> float:
    deadline_s = time.monotonic() + PATIENCE_S
    while not true():
        assert time.monotonic() < deadline_s, "waited in vain"
        MonotonicClock().sleep(0.01)
    return time.monotonic()


def _stands_at(bench: Bench, azimuth_deg: float, elevation_deg: float) -> bool:
    x, y, *_ = bench.true_place()
    off_deg = (x - azimuth_deg + 180) % 360 - 180
    return abs(off_deg) < CLOSE_DEG and abs(y + 90 - elevation_deg) < CLOSE_DEG


def _is_near(pose: ArmPose, azimuth_deg: float, elevation_deg: float) -> bool:
    off_deg = (pose.azimuth_deg - azimuth_deg + 180) % 360 - 180
    return abs(off_deg) < CLOSE_DEG and abs(pose.elevation_deg - elevation_deg) < CLOSE_DEG


def _in_a_zone(azimuth_deg: float, elevation_deg: float) -> bool:
    return (80 < azimuth_deg < 100 and 20 < elevation_deg < 60) or (230 < azimuth_deg < 260 and elevation_deg < 45)
