import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_sim.scene.pose import Pose
from firmware_sim.scene.relevance import Relevance, standard

ANGLES = st.floats(-1080, 1080)
POSES = st.builds(Pose, ANGLES, ANGLES, st.floats(-90, 90), st.floats(0, 1))


@given(POSES)
def test_a_standard_pose_stands_for_itself(pose: Pose) -> None:
    assert standard(standard(pose)) == standard(pose)


@given(POSES, st.integers(-2, 2))
def test_a_whole_turn_changes_nothing(pose: Pose, turns: int) -> None:
    turned = standard(pose._replace(turntable_deg=pose.turntable_deg + 360 * turns))
    gap_deg = abs(turned.turntable_deg - standard(pose).turntable_deg)
    assert min(gap_deg, 360 - gap_deg) < 0.0011  # the sum itself is rounded
    assert turned[1:] == standard(pose)[1:]


@pytest.mark.parametrize(
    ("pose", "expected"),
    [
        pytest.param(Pose(359.9999, 0, 0, 1), Pose(0, 0, 0, 1), id="just below a turn is none"),
        pytest.param(Pose(-90, -30, 45, 1), Pose(270, 330, 45, 1), id="negative angles come within a turn"),
        pytest.param(Pose(7.03125, 0, 0, 1), Pose(7.031, 0, 0, 1), id="80 ticks of a servo"),
        pytest.param(Pose(5, 30, 45, 0), Pose(5, 0, 0, 0), id="nobody sees where a dark lamp is"),
        pytest.param(Pose(5, 30, -0.0001, 0.5), Pose(5, 30, 0, 0.5), id="its power counts"),
    ],
)
def test_standard_poses(pose: Pose, expected: Pose) -> None:
    found = standard(pose)
    assert found == expected
    assert math.copysign(1, found.elevation_deg) == 1  # a minus zero would be another file


def test_every_tick_of_a_servo_has_a_picture_of_its_own() -> None:
    assert len({standard(Pose(tick * 360 / 4096, 0, 0, 1)) for tick in range(4096)}) == 4096


def test_what_does_not_matter_is_the_same_for_all() -> None:
    pose = Pose(10, 20, 30, 0.5)
    assert Relevance(turntable=True, arm=True).of(pose) == pose
    assert Relevance(turntable=True, arm=False).of(pose) == Pose(10, 0, 0, 1)
    assert Relevance(turntable=False, arm=True).of(pose) == Pose(0, 20, 30, 0.5)
