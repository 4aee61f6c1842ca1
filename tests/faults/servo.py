"""What befalls the servo, its wire and its supply, and what the driver makes of it.

Most of it runs on the simulated servo byte by byte while a clock is turned by hand; what needs ports has real ones.
"""

import random
import time
from collections.abc import Callable
from contextlib import suppress

from firmware_sim.config import SimConfig
from firmware_sim.dynamixel.config import TurntableFaults
from firmware_sim.dynamixel.control_table import Register as Place
from firmware_sim.dynamixel.faults import Delay, Duplicate, FlipBit, Foreign, Mute
from firmware_sim.launch import simulated_rig
from rig.clock import MonotonicClock
from rig.dynamixel import registers
from rig.dynamixel.bus import TRIES
from rig.errors import DeviceError, GarbledReplyError, LinkError, LinkTimeoutError, OutOfRangeError, PositionLostError
from tests.faults import servo_trials as trials
from tests.faults.outcome import Outcome, Scale
from tests.faults.servo_trials import GOAL, TOLERANCE_DEG, TRUTH
from tests.rig.dynamixel.wires import Bench

STOP_S = 0.5
ENCODER = 3
"""The bit after which an angle read means nothing."""


def fault_01_flipped_bits(campaign: Scale) -> Outcome:
    """Flip one bit of a reply; then let one in a hundred replies be hit while the table goes from slice to slice."""
    bench, chance = Bench(start_deg=90), random.Random(1)
    wrong = failed = 0
    for _ in range(campaign.trials):
        register = chance.choice(list(TRUTH))
        bench.firmware.faults.add(FlipBit(chance.randrange(1000)), 1)
        value = trials.ask(bench, register)
        failed += value is None
        wrong += value not in (None, TRUTH[register])
    arrived = trials.slices(TurntableFaults(flip=0.01), 36)
    return Outcome(
        campaign.trials,
        wrong,
        f"{failed} questions given up; a run at 1 %: {arrived} of 36 slices reached",
        not wrong and not failed and arrived == 36,
    )


def fault_02_dropped_bytes(_: Scale) -> Outcome:
    """Lose each byte of each exchange in turn, on the way to the servo and on the way back."""
    wrong = lost_bytes = most = 0
    for exchange, truth in trials.exchanges().items():
        bench = Bench(start_deg=90)
        exchange(bench)
        sizes = {True: len(bench.stream.sent[-1][1]), False: 100}
        for outward, size in sizes.items():
            for place in range(size):
                bench = Bench(start_deg=90)
                is_lost = trials.lose_once(bench, place, outward=outward)
                found = exchange(bench)
                if not is_lost():
                    break  # the reply is not as long as that
                lost_bytes += 1
                wrong += found != truth
                most = max(most, len(bench.stream.sent))
    return Outcome(lost_bytes, wrong, f"at most {most} tries", not wrong and most <= TRIES)


def fault_03_no_reply(_: Scale) -> Outcome:
    """Lose one reply, two, and all: the first are asked for again, the last makes a moving table stop."""
    wrong = 0
    for lost in (1, 2):
        bench = Bench(start_deg=90)
        bench.firmware.faults.add(Mute(), lost)
        wrong += trials.ask(bench, registers.PRESENT_POSITION) != 1024
    error, stop_s, still_s = trials.mid_move(lambda bench: bench.firmware.faults.add(Mute(), 10_000))
    passed = not wrong and isinstance(error, LinkTimeoutError) and stop_s < STOP_S
    return Outcome(3, wrong, f"stop sent after {stop_s:.2f} s, at rest after {still_s:.2f} s", passed)


def fault_04_duplicates(campaign: Scale) -> Outcome:
    """Send every reply twice, at once and late, while registers are read and the table moves."""
    chance = random.Random(4)
    wrong = trials.wrong_values(campaign.trials, lambda: Duplicate())
    poses = trials.moves(12, lambda: Duplicate(chance.uniform(0, 0.3)))
    off = sum(abs(read - truth) > TOLERANCE_DEG for read, truth in poses)
    detail = f"{off} of {len(poses)} poses off with copies up to 0.3 s late"
    return Outcome(campaign.trials, wrong + off, detail, not wrong and not off and len(poses) == 12)


def fault_05_late_replies(campaign: Scale) -> Outcome:
    """Delay a reply until its host has given up, and ask for another register."""
    chance = random.Random(5)
    wrong = trials.wrong_values(campaign.trials, lambda: Delay(chance.uniform(0.03, 0.3)))
    return Outcome(campaign.trials, wrong, "delays of 30 to 300 ms, another register asked for next", not wrong)


def fault_05_late_replies_on_the_wire(campaign: Scale) -> Outcome:
    """The same over a port that really exists, with delays about the host's patience."""
    chance = random.Random(5)
    wrong = failed = 0
    with simulated_rig(SimConfig()) as sim, trials.link_to(sim) as link:
        truth = {register: link.read(register) for register in TRUTH}
        for _ in range(campaign.trials):
            sim.side_channel.request("turntable.delay", seconds=chance.uniform(0.03, 0.12), replies=1)
            for register in chance.sample(list(TRUTH), 2):
                try:
                    wrong += link.read(register) != truth[register]
                except LinkError:
                    failed += 1
    return Outcome(campaign.trials, wrong, f"{failed} questions given up", not wrong)


def fault_06_echo(campaign: Scale) -> Outcome:
    """Let the host hear itself."""
    bench, wrong = Bench(start_deg=90), 0
    bench.firmware.faults.echo = True
    for _ in range(campaign.trials):
        wrong += any(trials.ask(bench, register) != value for register, value in TRUTH.items())
        bench.bus.write(1, registers.PROFILE_VELOCITY, 66)
    return Outcome(campaign.trials, wrong, "every question heard again", not wrong)


def fault_07_wrong_id(campaign: Scale) -> Outcome:
    """Let another servo speak before the right one, or instead of it."""
    chance = random.Random(7)
    wrong = trials.wrong_values(campaign.trials, lambda: Foreign(alone=chance.random() < 0.5))
    return Outcome(campaign.trials, wrong, "half before the answer, half instead of it", not wrong)


def fault_08_alert(_: Scale) -> Outcome:
    """Set each bit of the hardware error status in the middle of a move, and at rest."""
    words = {0: "input voltage", 2: "overheating", ENCODER: "encoder fault", 4: "electrical shock", 5: "overload"}
    wrong, longest_s = 0, 0.0
    for bit, word in words.items():
        mishap = trials.hardware_error(1 << bit)
        error, stop_s, _still_s = trials.mid_move(mishap)
        told = word in str(error) and f"its position is {'lost' if bit == ENCODER else 'kept'}" in str(error)
        kind = PositionLostError if bit == ENCODER else DeviceError
        wrong += not (told and type(error) is kind)
        wrong += not trials.is_found_at_rest(mishap, kind)
        longest_s = max(longest_s, stop_s)
    passed = not wrong and longest_s < STOP_S
    return Outcome(2 * len(words), wrong, f"stop sent within {longest_s:.2f} s, each bit told in words", passed)


def fault_09_goal_not_reached(_: Scale) -> Outcome:
    """Block the shaft on its way: it is pushed once more, and then the run stops."""
    wrong = moves = 0
    for stall_at_deg in (0.5, 20.0, 45.0, 89.0):
        bench = Bench()
        table = bench.turntable()
        table.home()
        bench.servo.stall_at_deg = stall_at_deg
        moves += 1
        try:
            table.move_to(90.0)
            wrong += 1
        except DeviceError as error:
            wrong += "look what blocks it" not in str(error)
        wrong += sum(GOAL in sent[1] for sent in bench.stream.sent) != 2
    return Outcome(moves, wrong, "one more push, then an error with the angle", not wrong)


def fault_10_still_moving(_: Scale) -> Outcome:
    """Let the shaft swing about its goals: no pose is taken before it rests."""
    wrong = moves = 0
    for overshoot_deg in (0.5, 1.0, 3.0):
        bench = Bench()
        bench.servo.overshoot_deg = overshoot_deg
        table = bench.turntable()
        table.home()
        for goal_deg in (30.0, 77.0, 12.0, -40.0):
            table.move_to(goal_deg)
            moves += 1
            for _instant in range(40):  # as long as an exposure may take
                wrong += abs(bench.servo.angle_deg(bench.now_s()) - goal_deg) > TOLERANCE_DEG
                bench.clock.sleep(0.01)
    return Outcome(moves, wrong, "overshoot of 0.5 to 3°, 0.4 s after each arrival in tolerance", not wrong)


def fault_11_backlash(_: Scale) -> Outcome:
    """Let the table have play on its shaft: from whichever side it comes, it stands in one place."""
    moves, widest_deg = 0, 0.0
    for direction in (1, -1):
        bench = Bench()
        bench.table.play_deg = 0.8
        table = bench.turntable(direction=direction, min_deg=-10, max_deg=60)
        table.home()
        for goal_deg in (-10.0, 0.0, 33.3, 60.0):
            found = []
            for before_deg in (goal_deg + 0.5, goal_deg - 0.5, goal_deg + 6, goal_deg - 6):
                with suppress(OutOfRangeError):
                    table.move_to(before_deg)
                table.move_to(goal_deg)
                found.append(bench.table.angle_deg(bench.now_s()))
                moves += 1
            widest_deg = max(widest_deg, max(found) - min(found))
    wrong = int(widest_deg > registers.DEG_PER_TICK)
    return Outcome(moves, wrong, f"0.8° of play, places at most {widest_deg:.3f}° apart, limits included", not wrong)


def fault_14_wrong_baud(_: Scale) -> Outcome:
    """Let the servo listen at another speed than RIG.toml says."""
    config = SimConfig.model_validate({"turntable": {"faults": {"listens_at": 1_000_000}}})
    with simulated_rig(config) as sim:
        error = trials.error_of_homing(sim)
    passed = isinstance(error, LinkTimeoutError) and "baud rate" in str(error)
    return Outcome(1, int(not passed), str(error), passed)


def fault_15_two_servos_with_one_id(_: Scale) -> Outcome:
    """Let a twin talk at the same time."""
    bench = Bench()
    bench.firmware.faults.clash = True
    error = trials.error_of(bench.turntable().home)
    passed = isinstance(error, GarbledReplyError) and "same id" in str(error)
    return Outcome(1, int(not passed), str(error), passed)


def fault_16_wrong_model(_: Scale) -> Outcome:
    """Let it be another model, and one that nobody knows."""
    wrong = 0
    for number, name in ((1020, "XM430-W350"), (1190, "XL330-M077"), (12, "model number 12")):
        bench = Bench()
        bench.servo.memory[Place.MODEL_NUMBER] = number
        try:
            bench.turntable().home()
            wrong += 1
        except DeviceError as error:
            wrong += f"is a {name}, RIG.toml says XL430-W250" not in str(error)
        wrong += any(GOAL in sent[1] for sent in bench.stream.sent)
    return Outcome(3, wrong, "refused before anything moved", not wrong)


def fault_17_unplugged(_: Scale) -> Outcome:
    """Pull the USB adapter out in the middle of a move, and plug it in under another name.

    The servo stops by itself, and is found where it stopped.
    """
    with simulated_rig(SimConfig()) as sim:
        rig = trials.opened(sim)
        error, pulled_s = trials.error_of_a_move(sim, rig, "turntable.unplug")
        while sim.side_channel.status()["turntable_moving"] and time.monotonic() < pulled_s + 5:
            MonotonicClock().sleep(0.005)
        still_s = time.monotonic() - pulled_s
        truth_deg = sim.side_channel.status()["turntable_deg"]
        port = sim.side_channel.request("turntable.replug")["port"]
        off_deg = abs(trials.angle_at(sim, port) - truth_deg)
    told = isinstance(error, LinkError) and "stops by itself and keeps its position" in str(error)
    passed = told and rig.position_known and off_deg <= registers.DEG_PER_TICK
    detail = f"at rest {still_s:.2f} s after; the same angle within {off_deg:.3f}° on another port"
    return Outcome(1, int(not passed), detail, passed)


def fault_22_power_sag(_: Scale) -> Outcome:
    """Let the supply sag in the middle of a move and at rest, where nothing else betrays it."""
    error, stop_s, _still_s = trials.mid_move(lambda bench: bench.servo.brown_out())
    wrong = int(not isinstance(error, PositionLostError))
    sags: tuple[Callable[[Bench], object], ...] = (
        lambda bench: bench.servo.brown_out(),
        lambda bench: bench.servo.brown_out(20.0),
        lambda bench: bench.servo.brown_out(-360.0),
    )
    wrong += sum(not trials.is_found_at_rest(sag, PositionLostError) for sag in sags)
    passed = not wrong and stop_s < STOP_S
    return Outcome(4, wrong, f"told before the next frame; stop sent after {stop_s:.2f} s in a move", passed)
