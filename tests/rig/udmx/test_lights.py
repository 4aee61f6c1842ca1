"""The lamps as the rig sees them: one at a time, warm, and dark when somebody dies."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import pytest

from firmware_sim.config import SimConfig
from firmware_sim.launch import RunningSim, simulated_rig
from firmware_sim.udmx.dimmers import FRAME_S
from rig.config import read_rig
from rig.errors import PortError
from rig.interrupts import StopNow
from rig.rig import Rig, RigState, open_rig
from rig.udmx.config import UdmxConfig, UdmxLamp
from rig.udmx.guard import Guard
from rig.udmx.lights import UdmxLights, levels
from tests.rig.udmx.bench import LampBench

LAMP_2_DARK = "400100000200"
LIGHT_AND_WAIT = """
import sys
from pathlib import Path
from rig.config import read_rig
from rig.interrupts import Interrupts
from rig.rig import open_rig
with Interrupts(can_pause=False), open_rig(read_rig(Path(sys.argv[1])), use=frozenset({"lights"})) as rig:
    rig.lights.switch_on(2)
    print("lit", flush=True)
    sys.stdin.readline()
"""


@pytest.fixture(scope="module")
def dome() -> Iterator[RunningSim]:
    config = {"scene": {"kind": "relief"}, "dome": {"lamps": 8}, "camera": {"width": 320, "height": 240}}
    with simulated_rig(SimConfig.model_validate(config)) as sim:
        yield sim


def opened(sim: RunningSim, *parts: str) -> Rig:
    return open_rig(read_rig(sim.rig_toml), use=frozenset(parts or ("lights",)), environment=sim.environment)


def shining(sim: RunningSim) -> list[Any]:
    lamps: list[Any] = sim.side_channel.status()["dome"]
    return lamps


def await_dark(sim: RunningSim) -> None:
    deadline_s = time.monotonic() + 20
    while shining(sim):
        assert time.monotonic() < deadline_s, "the lamps are still lit"


class Unguarded(Guard):
    def __init__(self) -> None:
        pass

    def release(self) -> None:
        pass


def test_a_lamp_is_waited_for_until_it_is_warm_and_only_when_it_was_dark() -> None:
    bench = LampBench()
    lamps = tuple(UdmxLamp(channels=(channel,)) for channel in (1, 2))
    config = UdmxConfig(kind="udmx", lamp=lamps, warm_up_s=3.0)
    lights = UdmxLights(bench.link(), config, bench.clock, Unguarded())
    times_s = []
    for lamp in (0, 0, 1):
        before_s = bench.clock.now_s()
        lights.switch_on(lamp)
        times_s.append(bench.clock.now_s() - before_s)
    assert times_s == pytest.approx([3.0, 0.0, 3.0], abs=0.01)
    lights.switch_off()
    lights.switch_on(1)
    assert bench.slots()[:2] == b"\0\xff"


def test_the_usual_wait_is_longer_than_two_frames_on_the_dmx_line() -> None:
    assert UdmxConfig(kind="udmx", lamp=(UdmxLamp(channels=(1,)),)).warm_up_s > 2 * FRAME_S


def test_one_lamp_shines_at_a_time_with_its_gain_and_all_are_dark_on_hold(dome: RunningSim) -> None:
    with pytest.raises(ZeroDivisionError), opened(dome) as rig:
        powers = []
        for lamp in (0, 5, 3):
            pose = rig.light_from(*rig.directions_deg[lamp], lamp)
            [(azimuth_deg, elevation_deg, power)] = shining(dome)
            assert (azimuth_deg, elevation_deg) == (pose.azimuth_deg, pose.elevation_deg) == rig.directions_deg[lamp]
            powers.append(power)
        assert powers == pytest.approx([powers[0]] * 3, abs=1 / 255)
        rig.pause()
        await_dark(dome)
        rig.lights.switch_on(1)
        1 / 0  # noqa: B018  # anything that goes wrong
    await_dark(dome)
    assert rig.state is RigState.HOLD


def test_lamps_stay_as_they_are_when_a_program_ends_well(dome: RunningSim) -> None:
    with opened(dome) as rig:
        rig.lights.switch_on(4)
    assert len(shining(dome)) == 1
    with opened(dome) as rig:
        rig.get_ready()
        rig.park()
    await_dark(dome)


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGABRT], ids=["killed", "crashed"])
def test_a_host_that_dies_with_a_lamp_lit_leaves_the_dome_dark(dome: RunningSim, number: int) -> None:
    command = [sys.executable, "-c", LIGHT_AND_WAIT, str(dome.rig_toml)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as host:
        assert host.stdout is not None
        assert host.stdout.readline() == "lit\n"
        assert len(shining(dome)) == 1
        with pytest.raises(PortError, match="held by another program"):
            opened(dome)
        os.kill(host.pid, number)
    await_dark(dome)


def test_a_stop_in_the_middle_of_a_transfer_leaves_all_dark(dome: RunningSim) -> None:
    def stop(*_: object) -> None:
        raise StopNow

    before = signal.signal(signal.SIGALRM, stop)
    stopped = 0
    try:
        with opened(dome) as rig:
            for trial in range(60):
                with suppress(StopNow):
                    signal.setitimer(signal.ITIMER_REAL, 0.0005 + 0.0001 * (trial % 30))
                    try:
                        for lamp in range(8):
                            rig.lights._link.show(levels(rig.config.lights, lamp))  # type: ignore[attr-defined, arg-type]
                    except StopNow:
                        stopped += 1
                    finally:
                        signal.setitimer(signal.ITIMER_REAL, 0)
                assert rig.hold() == []
                assert not any(bytes.fromhex(dome.side_channel.status()["usb"][0]["slots"]))
    finally:
        signal.signal(signal.SIGALRM, before)
    assert stopped > 20


def test_sigterm_darkens_the_dome_before_the_program_ends(dome: RunningSim) -> None:
    command = [sys.executable, "-c", LIGHT_AND_WAIT, str(dome.rig_toml)]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, text=True) as host:
        assert host.stdout is not None
        assert host.stdout.readline() == "lit\n"
        sent_s = time.monotonic()
        host.terminate()
        assert host.wait(20) != 0
    recent = dome.side_channel.status()["usb"][0]["recent"]
    heard_s = [time_s for time_s, _, transfer in recent if transfer.startswith(LAMP_2_DARK)]
    assert sent_s < heard_s[-1]
    await_dark(dome)


def test_the_guard_ends_with_the_rig(dome: RunningSim) -> None:
    with opened(dome) as rig:
        guard = rig.lights._guard._process.pid  # type: ignore[attr-defined]  # whose end is what is tested
        os.kill(guard, 0)
    with pytest.raises(ProcessLookupError):
        os.kill(guard, 0)


def test_the_camera_sees_which_lamp_is_lit(dome: RunningSim) -> None:
    with opened(dome, "lights", "camera") as rig:
        sizes = []
        for lamp in (0, 1):
            rig.light_from(*rig.directions_deg[lamp], lamp)
            sizes.append(len(rig.expose(rig.clock.now_s()).content))
        rig.lights.switch_off()
        rig.clock.sleep(0.05)
        dark = rig.expose(rig.clock.now_s()).content
    assert min(sizes) > 2 * len(dark)
