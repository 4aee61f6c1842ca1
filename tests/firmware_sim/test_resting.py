import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_sim.config import SimConfig
from firmware_sim.devices import Devices
from firmware_sim.resting import last_elsewhere_s, resting_pose
from firmware_sim.scene.pose import PlannedPose, Pose
from firmware_sim.scene.relevance import standard
from tests.firmware_sim.timing import HandClock

CONFIG = SimConfig()
NOW = Pose(31.6, 300, 55, 0.25)
TORQUE, GOAL, MODE, EXTENDED = 64, 116, 11, 4


def servo_at(angle_deg: float) -> tuple[Devices, HandClock]:
    """Send the servo to the count nearest to an angle, as a driver does."""
    clock = HandClock()
    devices = Devices(CONFIG, clock)
    devices.servo.write(MODE, bytes([EXTENDED]))
    devices.servo.write(TORQUE, b"\x01")
    devices.servo.write(GOAL, struct.pack("<i", round(angle_deg / 360 * 4096)))
    return devices, clock


def arm_at(azimuth_deg: float, elevation_deg: float) -> tuple[Devices, HandClock]:
    """Home the arm and send it somewhere, as a driver does."""
    clock = HandClock()
    devices = Devices(CONFIG, clock)
    devices.arm.feed(b"$H\n")
    for _ in range(400):
        clock.pass_s(0.1)
        devices.arm.feed(b"")
    devices.arm.feed(b"G21 G90 G94 G53 G1 X%.3f Y%.3f F6600\n" % (azimuth_deg - 360, elevation_deg - 90))
    clock.pass_s(20)
    devices.arm.feed(b"")
    assert devices.arm.state == "Idle"
    return devices, clock


@given(st.floats(-360, 720))
def test_the_servo_rests_where_it_was_expected(angle_deg: float) -> None:
    devices, clock = servo_at(angle_deg)
    clock.pass_s(20)
    expected = resting_pose(PlannedPose(angle_deg), NOW, CONFIG)
    assert standard(Pose(*devices.pose(clock())))[0] == standard(expected)[0]


@pytest.mark.parametrize(
    ("azimuth_deg", "elevation_deg"), [(0, 45), (5.625, 30.3125), (123.456789, 7.7777), (359.999, 88), (180, 5)]
)
def test_the_arm_rests_where_it_was_expected(azimuth_deg: float, elevation_deg: float) -> None:
    devices, clock = arm_at(azimuth_deg, elevation_deg)
    expected = resting_pose(PlannedPose(None, azimuth_deg, elevation_deg), NOW, CONFIG)
    assert standard(Pose(*devices.pose(clock()))._replace(lamp=1))[1:] == standard(expected)[1:]


def test_what_a_plan_leaves_out_stays() -> None:
    assert resting_pose(PlannedPose(), NOW, CONFIG) == NOW._replace(lamp=1)
    assert resting_pose(PlannedPose(lamp=0.5), NOW, CONFIG) == NOW._replace(lamp=0.5)


@given(st.floats(0.001, 9))
def test_the_instant_before_a_rest_is_found(rested_s: float) -> None:
    devices, clock = servo_at(0)
    while devices.servo.is_turning():
        clock.pass_s(0.0001)
    came_to_rest_s = clock()
    clock.pass_s(rested_s)
    found_s = last_elsewhere_s(lambda time_s: Pose(*devices.pose(time_s)), clock())
    assert devices.pose(found_s) != devices.pose(clock())
    assert came_to_rest_s - 0.0005 < found_s < came_to_rest_s


def test_of_a_rest_that_nobody_remembers_the_beginning_is_long_ago() -> None:
    clock = HandClock()
    assert last_elsewhere_s(lambda _: NOW, clock()) <= clock() - 10
