"""The drivers on simulated devices that misbehave: no wrong value is ever taken, and every error says what to do."""

import os
import re

import pytest
import serial

from firmware_sim.launch import RunningSim
from rig.camera.v4l2 import V4l2Camera
from rig.clock import MonotonicClock
from rig.config import CameraConfig, RigConfig, TurntableConfig, read_rig
from rig.dynamixel import registers
from rig.dynamixel.link import DynamixelLink
from rig.errors import CameraError, DeviceError, GarbledReplyError, LinkTimeoutError, PortError, PositionLostError
from rig.rig import Rig, RigState, open_rig


def opened(sim: RunningSim, *parts: str) -> Rig:
    return open_rig(read_rig(sim.rig_toml), use=frozenset(parts), environment=sim.environment)


def config_of(sim: RunningSim) -> RigConfig:
    return read_rig(sim.rig_toml)


def link_to(sim: RunningSim, **changes: int) -> DynamixelLink:
    table = config_of(sim).turntable
    assert isinstance(table, TurntableConfig)
    return DynamixelLink(table.port, changes.get("baud", table.baud), changes.get("id", table.id), MonotonicClock())


def test_late_replies_never_become_another_registers_value(sphere_sim: RunningSim) -> None:
    link = link_to(sphere_sim)
    for trial in range(12):
        position = link.read(registers.PRESENT_POSITION)
        sphere_sim.side_channel.request("turntable.delay", seconds=0.045 + 0.005 * trial, replies=1)
        link.read(registers.PRESENT_POSITION)
        assert link.read(registers.OPERATING_MODE) in (3, 4)
        assert link.read(registers.PRESENT_POSITION) == position
    link.close()


def test_lost_and_damaged_replies_are_asked_for_again(sphere_sim: RunningSim) -> None:
    link = link_to(sphere_sim)
    position = link.read(registers.PRESENT_POSITION)
    sphere_sim.side_channel.request("turntable.mute", replies=2)
    assert link.read(registers.PRESENT_POSITION) == position
    for bit in range(0, 96, 24):
        sphere_sim.side_channel.request("turntable.flip_bit", bit=bit, replies=1)
        assert link.read(registers.PRESENT_POSITION) == position
    link.close()


def test_silence_is_an_error_that_names_what_to_check(sphere_sim: RunningSim) -> None:
    link = link_to(sphere_sim)
    sphere_sim.side_channel.request("turntable.mute", replies=100)
    with pytest.raises(LinkTimeoutError, match="no answer to ping after 3 tries; check power, cable, id and baud"):
        link.ping()
    link.close()


def test_damage_that_lasts_is_an_error(sphere_sim: RunningSim) -> None:
    link = link_to(sphere_sim)
    sphere_sim.side_channel.request("turntable.flip_bit", bit=70, replies=100)
    with pytest.raises((GarbledReplyError, LinkTimeoutError), match="servo 1"):
        link.read(registers.PRESENT_POSITION)
    link.close()


@pytest.mark.parametrize("change", [{"baud": 1_000_000}, {"id": 7}])
def test_a_wrong_baud_rate_or_id_is_silence(sphere_sim: RunningSim, change: dict[str, int]) -> None:
    link = link_to(sphere_sim, **change)
    with pytest.raises(LinkTimeoutError):
        link.ping()
    link.close()


def test_a_stalled_table_yields_an_error_and_the_angle(sphere_sim: RunningSim) -> None:
    with (
        pytest.raises(DeviceError, match=r"told to go to 90\.00°, stands at .*look what blocks it"),
        opened(sphere_sim, "turntable") as rig,
    ):
        rig.home()
        sphere_sim.side_channel.request("turntable.stall")
        rig.turn_to(90)
    assert rig.state is RigState.HOLD


def test_a_hardware_error_is_told_in_words(sphere_sim: RunningSim) -> None:
    sphere_sim.side_channel.request("turntable.hardware_error", bits=0b100100)
    with opened(sphere_sim, "turntable") as rig, pytest.raises(DeviceError, match="overheating, overload; remove"):
        rig.turntable.home()


def test_another_model_is_refused(sphere_sim: RunningSim) -> None:
    config = config_of(sphere_sim)
    assert config.turntable is not None
    other = config.model_copy(update={"turntable": config.turntable.model_copy(update={"model": "XM430-W350"})})
    with (
        open_rig(other, use=frozenset({"turntable"})) as rig,
        pytest.raises(DeviceError, match=r"is a XL430-W250, RIG\.toml says XM430-W350"),
    ):
        rig.turntable.home()


def test_a_port_that_is_taken_says_by_whom(sphere_sim: RunningSim) -> None:
    config = config_of(sphere_sim)
    assert config.turntable is not None
    assert config.arm is not None
    for port, part in ((config.turntable.port, "turntable"), (config.arm.port, "arm")):
        with (
            serial.Serial(port, exclusive=True),
            pytest.raises(PortError, match=re.escape(port) + ": held by another program"),
        ):
            opened(sphere_sim, part)


def test_a_second_litrig_on_the_same_rig_is_refused_and_the_first_goes_on(sphere_sim: RunningSim) -> None:
    with opened(sphere_sim, "turntable") as first:
        first.turntable.home()
        for part in ("turntable", "arm", "camera"):
            with pytest.raises(PortError, match=rf"in use by litrig, process {os.getpid()}; wait for its end"):
                opened(sphere_sim, part)
        assert first.turn_to(20).angle_deg == pytest.approx(20, abs=0.3)
    opened(sphere_sim, "turntable").__exit__(None, None, None)


def test_a_missing_port_is_named() -> None:
    config = RigConfig.model_validate({"turntable": {"port": "/dev/ttyNOWHERE"}})
    with pytest.raises(PortError, match="/dev/ttyNOWHERE: no such port; check cable"):
        open_rig(config)


def test_a_missing_camera_is_named() -> None:
    config = RigConfig.model_validate({"camera": {"device": "/dev/video97"}})
    with pytest.raises(CameraError, match="/dev/video97: cannot be opened"):
        open_rig(config)


def test_a_camera_that_is_taken_is_an_error(sphere_sim: RunningSim) -> None:
    config = config_of(sphere_sim).camera
    assert isinstance(config, CameraConfig)
    second = V4l2Camera(config, MonotonicClock(), sphere_sim.environment)
    try:
        with opened(sphere_sim, "camera"), pytest.raises(CameraError, match="/dev/video42: cannot be opened"):
            second.configure()
    finally:
        second.close()


def test_an_unplugged_camera_is_an_error(sphere_sim: RunningSim) -> None:
    with opened(sphere_sim, "camera") as rig:
        rig.camera.capture(rig.clock.now_s())
        sphere_sim.side_channel.request("camera.unplug")
        with pytest.raises(CameraError, match="delivers no picture any more"):
            rig.camera.capture(rig.clock.now_s())


def test_a_hanging_camera_times_out_and_the_rig_still_stops(sphere_sim: RunningSim) -> None:
    config = config_of(sphere_sim)
    assert config.camera is not None
    quick = config.model_copy(update={"camera": config.camera.model_copy(update={"timeout_s": 0.5})})
    with (
        pytest.raises(CameraError, match=r"no picture within 0\.5 s; it hangs"),
        open_rig(quick, environment=sphere_sim.environment) as rig,
    ):
        rig.home()
        sphere_sim.side_channel.request("camera.hang")
        rig.expose(rig.clock.now_s())
    assert rig.state is RigState.HOLD
    status = sphere_sim.side_channel.status()
    assert b"!" in b"".join(bytes.fromhex(c) for _, way, c in status["wires"]["arm"]["recent"] if way == "in")


def test_a_dead_limit_switch_is_told_and_the_position_is_lost(relief_sim: RunningSim) -> None:
    relief_sim.side_channel.request("arm.switches", fault="stuck")
    with (
        pytest.raises(DeviceError, match=r"alarm 8 .*its position is lost, home it"),
        opened(relief_sim, "arm", "lights") as rig,
    ):
        rig.home()
    assert not rig.position_known


def test_the_camera_process_ends_with_the_rig(sphere_sim: RunningSim) -> None:
    with opened(sphere_sim, "camera") as rig:
        worker = rig.camera._worker.pid  # type: ignore[attr-defined]  # whose end is what is tested
        os.kill(worker, 0)
    with pytest.raises(ProcessLookupError):
        os.kill(worker, 0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        pytest.param({"gain": 100_000}, "has gain = 100, not 100000", id="gain"),
        pytest.param({"focus": 99_999}, "has focus = 255, not 99999", id="focus"),
        pytest.param({"white_balance_k": 1}, "has white_balance_k = 2800, not 1", id="white balance"),
        pytest.param({"width": 123}, "has width = ", id="width"),
        pytest.param({"exposure_ms": 9000.0}, "has exposure_ms = ", id="exposure"),
    ],
)
def test_a_setting_that_the_camera_does_not_take_is_refused(
    sphere_sim: RunningSim, change: dict[str, float], message: str
) -> None:
    config = config_of(sphere_sim)
    assert config.camera is not None
    other = config.model_copy(update={"camera": config.camera.model_copy(update=change)})
    with pytest.raises(CameraError, match=message):
        open_rig(other, use=frozenset({"camera"}), environment=sphere_sim.environment)


def test_an_alarm_that_comes_unasked_is_not_overheard(relief_sim: RunningSim) -> None:
    with opened(relief_sim, "arm", "lights") as rig:
        rig.home()
        port = config_of(relief_sim).arm
        assert port is not None
        rig.arm._controller._line.write(b"$J=G91 X-200 F6000\n")  # type: ignore[attr-defined]  # motion behind its back
        rig.clock.sleep(0.3)
        rig.arm._controller._line.write(b"\x18")  # type: ignore[attr-defined]  # a reset in motion: alarm 3
        rig.clock.sleep(0.8)
        with pytest.raises(PositionLostError, match="alarm 3"):
            rig.arm.locate()
