import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from litrig.base.directions import angle_between_deg, direction_from_angles
from rig.arm.geometry import ArmGeometry, Joints

TILTED = np.array([[0.0, -1.0, 0.0], [0.6, 0.0, -0.8], [0.8, 0.0, 0.6]])
azimuths = st.floats(0, 359.9)
elevations = st.floats(-80, 89)


@given(azimuths, elevations, st.floats(-0.8, 0.8))
def test_joints_and_directions_are_each_others_inverse(azimuth: float, elevation: float, height: float) -> None:
    for view_from_arm in (np.eye(3), TILTED):
        arm = ArmGeometry(view_from_arm, 300.0, 300.0 * height)
        direction = arm.direction(arm.joints(azimuth, elevation))
        assert angle_between_deg(direction, direction_from_angles(azimuth, elevation)) < 1e-6


def test_a_joint_above_the_samples_plane_sees_the_lamp_higher_than_its_angle() -> None:
    arm = ArmGeometry(np.eye(3), 400.0, 100.0)
    direction = arm.direction(Joints(0.0, 0.0))
    assert math.degrees(math.asin(direction[2])) == pytest.approx(math.degrees(math.atan2(100, 400)))
    assert arm.joints(0.0, math.degrees(math.atan2(100, 400))).elevation_deg == pytest.approx(0, abs=1e-9)


def test_a_lamp_far_away_does_not_care_for_the_joints_height() -> None:
    near, far = (ArmGeometry(np.eye(3), radius, 50.0).joints(30.0, 40.0) for radius in (100.0, 1e7))
    assert far.elevation_deg == pytest.approx(40, abs=1e-3)
    assert near.elevation_deg < 25
    assert ArmGeometry(np.eye(3)).joints(30.0, 40.0) == pytest.approx((30, 40))


def test_the_lamps_position_lies_in_its_direction_at_the_arms_radius_from_the_joint() -> None:
    arm = ArmGeometry(TILTED, 400.0, 100.0)
    joints = Joints(70.0, 35.0)
    position = arm.lamp_position_mm(joints)
    assert angle_between_deg(position, arm.direction(joints)) < 1e-6
    assert np.linalg.norm(position - TILTED @ [0, 0, 100.0]) == pytest.approx(400)


def test_a_position_needs_a_radius() -> None:
    with pytest.raises(ValueError, match="radius_mm"):
        ArmGeometry(np.eye(3)).lamp_position_mm(Joints(0, 0))
