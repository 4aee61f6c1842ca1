"""How the servo's mishaps are brought about, and what is looked at afterwards."""

import random
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

from firmware_sim.dynamixel.config import TurntableFaults
from firmware_sim.dynamixel.control_table import Register as Place
from firmware_sim.dynamixel.faults import ReplyFault, without
from firmware_sim.launch import RunningSim
from firmware_sim.side_channel import SideChannel
from rig.clock import MonotonicClock
from rig.config import RigConfig, TurntableConfig, read_rig
from rig.dynamixel import registers
from rig.dynamixel.link import DynamixelLink
from rig.dynamixel.registers import Register
from rig.errors import LinkError, RigError
from rig.rig import Rig, open_rig
from tests.rig.dynamixel.wires import Bench

TOLERANCE_DEG = 0.3
TRUTH = {
    registers.PRESENT_POSITION: 1024,
    registers.VELOCITY_LIMIT: 265,
    registers.MODEL_NUMBER: 1060,
    registers.PRESENT_VOLTAGE: 120,
    registers.MIN_VOLTAGE_LIMIT: 60,
    registers.TEMPERATURE_LIMIT: 72,
    registers.PRESENT_TEMPERATURE: 34,
}
"""Registers of a servo at 90° that stand still, some of one size, which only their values tell apart."""
GOAL, WATCHDOG = b"\x03\x74\x00", b"\x03\x62\x00"
"""Writes of goal position and bus watchdog, as they are found in a packet."""


def ask(bench: Bench, register: Register) -> int | None:
    """Read a register; None if the driver gives up, which is honest."""
    try:
        return register.from_bytes(bench.bus.read(1, register).content)
    except LinkError:
        return None


def wrong_values(trials: int, fault: Callable[[], ReplyFault]) -> int:
    """Count wrong values of two registers of one size, read one after the other, the first while the fault strikes."""
    bench, chance = Bench(start_deg=90), random.Random(2)
    wrong = 0
    for _ in range(trials):
        first, second = chance.sample(list(TRUTH), 2)
        bench.firmware.faults.add(fault(), 1)
        for register in (first, second):
            wrong += ask(bench, register) not in (None, TRUTH[register])
    return wrong


def slices(shares: TurntableFaults, slices: int) -> int:
    """Go round once while shares of the replies are hit; returns how many slices were reached."""
    bench = Bench()
    table = bench.turntable()
    table.home()
    bench.firmware.faults.spread(shares)
    reached = 0
    for s in range(slices):
        pose = table.move_to(360 * s / slices)
        reached += abs(bench.servo.angle_deg(bench.now_s()) - 360 * s / slices) <= TOLERANCE_DEG
        reached -= abs(pose.angle_deg - 360 * s / slices) > TOLERANCE_DEG
    return reached


def moves(moves: int, fault: Callable[[], ReplyFault]) -> list[tuple[float, float]]:
    """Move about while every reply is hit; returns the angles read, and where the shaft truly stood."""
    bench, chance = Bench(), random.Random(3)
    table = bench.turntable()
    table.home()
    angles = []
    for _ in range(moves):
        for _reply in range(400):
            bench.firmware.faults.add(fault(), 1)
        pose = table.move_to(chance.uniform(-90, 90))
        angles.append((pose.angle_deg, bench.servo.angle_deg(bench.now_s())))
    return angles


def exchanges() -> dict[Callable[[Bench], object], object]:
    """Return questions and orders of every length, each with what must come of it."""
    return {
        (lambda bench: bench.bus.ping(1)): (1060, 45),
        (lambda bench: ask(bench, registers.PRESENT_POSITION)): 1024,
        (lambda bench: ask(bench, registers.TEMPERATURE_LIMIT)): 72,
        (lambda bench: len(bench.bus.read(1, registers.STATE).content)): registers.STATE.size,
        (lambda bench: written(bench, registers.PROFILE_VELOCITY, 77)): 77,
    }


def written(bench: Bench, register: Register, value: int) -> int:
    bench.bus.write(1, register, value)
    return bench.servo.memory[Place(register.address)]


def lose_once(bench: Bench, place: int, *, outward: bool) -> Callable[[], bool | None]:
    """Lose one byte of the next bytes in one direction; the answer says whether one was lost yet."""
    lost: list[bool] = []

    def change(content: bytes) -> bytes:
        if lost:
            return content
        lost.append(place < len(content))
        return without(content, place) if lost[0] else content

    if outward:
        bench.stream.on_the_way_out = change
    else:
        bench.stream.on_the_way_in = change
    return lambda: lost[0] if lost else None


def mid_move(mishap: Callable[[Bench], object]) -> tuple[RigError | None, float, float]:
    """Let something happen 1 s into a long move, as a rig would meet it.

    Returns the error, when the stop was sent after the mishap, and when the shaft rested.
    """
    bench = Bench()
    rig = Rig(RigConfig(), clock=bench.clock, turntable=bench.turntable())
    error: RigError | None = None
    with suppress(RigError), rig:
        rig.home()
        struck_s = bench.now_s() + 1.0
        bench.clock.after(1.0, lambda: mishap(bench))
        try:
            rig.turn_to(700)
        except RigError as raised:
            error = raised
            raise
    stops_s = [
        at_s for at_s, content in bench.stream.sent if at_s > struck_s and (GOAL in content or WATCHDOG in content)
    ]
    bench.clock.sleep(3)
    bench.firmware.feed(b"")
    rested_s = float("inf") if bench.servo.is_turning() else bench.servo._shaft.ends_s
    return error, min(stops_s, default=float("inf")) - struck_s, rested_s - struck_s


def is_found_at_rest(mishap: Callable[[Bench], object], kind: type[RigError]) -> bool:
    """Tell whether a mishap after an arrival is told when the pose is asked for before the next frame."""
    bench = Bench()
    table = bench.turntable()
    table.home()
    table.move_to(30.0)
    mishap(bench)
    bench.clock.sleep(0.3)
    try:
        table.locate()
    except RigError as error:
        return isinstance(error, kind)
    return False


def error_of(action: Callable[[], object]) -> RigError | None:
    """Return what goes wrong."""
    try:
        action()
    except RigError as error:
        return error
    return None


def hardware_error(bits: int) -> Callable[[Bench], object]:
    return lambda bench: bench.servo.fail_hardware(bits)


def error_of_homing(sim: RunningSim) -> RigError | None:
    def home() -> None:
        with opened(sim) as rig:
            rig.home()

    return error_of(home)


def opened(sim: RunningSim) -> Rig:
    return open_rig(read_rig(sim.rig_toml), use=frozenset({"turntable"}))


@contextmanager
def link_to(sim: RunningSim) -> Iterator[DynamixelLink]:
    """Talk to the servo of a simulated rig."""
    table = read_rig(sim.rig_toml).turntable
    assert isinstance(table, TurntableConfig)
    link = DynamixelLink(table.port, table.baud, table.id, MonotonicClock())
    try:
        yield link
    finally:
        link.close()


def error_of_a_move(sim: RunningSim, rig: Rig, mishap: str, **parameters: object) -> tuple[RigError | None, float]:
    """Let something happen in the middle of a long move; returns what went wrong, and when the mishap struck."""
    struck_s: list[float] = []

    def strike() -> None:
        with SideChannel(sim.side_channel.path) as channel:
            while not channel.status()["turntable_moving"]:
                MonotonicClock().sleep(0.01)
            MonotonicClock().sleep(0.3)
            struck_s.append(time.monotonic())
            channel.request(mishap, **parameters)

    def move() -> None:
        with rig:
            rig.home()
            rig.turn_to(700)

    striker = threading.Thread(target=strike)
    striker.start()
    error = error_of(move)
    striker.join()
    return error, struck_s[0]


def angle_at(sim: RunningSim, port: str) -> float:
    """Open the turntable on another port than RIG.toml says, and read its angle."""
    config = read_rig(sim.rig_toml)
    assert config.turntable is not None
    moved = config.model_copy(update={"turntable": config.turntable.model_copy(update={"port": port})})
    with open_rig(moved, use=frozenset({"turntable"})) as rig:
        rig.home()
        return rig.turntable.locate().angle_deg
