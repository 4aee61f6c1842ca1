import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_sim.scene.between import weights_between
from firmware_sim.scene.pose import Pose
from firmware_sim.scene.relevance import Relevance, standard

TURNTABLE, ARM = Relevance(turntable=True, arm=False), Relevance(turntable=True, arm=True)
POSES = st.builds(Pose, st.floats(0, 359), st.floats(0, 359), st.floats(5, 85), st.floats(0, 1)).map(standard)


def turned(angle_deg: float) -> Pose:
    return Pose(angle_deg, 0, 0, 1)


@given(POSES, st.lists(POSES, min_size=1, unique=True), st.sampled_from([TURNTABLE, ARM]))
def test_weights_are_shares_of_known_poses(pose: Pose, known: list[Pose], relevance: Relevance) -> None:
    known = sorted({relevance.of(other) for other in known})
    weights = weights_between(relevance.of(pose), known, relevance)
    assert sum(weights.values()) == pytest.approx(1)
    assert all(weight > 0 for weight in weights.values())
    assert set(weights) <= set(known)


@given(st.lists(POSES, min_size=1, unique=True), st.sampled_from([TURNTABLE, ARM]))
def test_a_known_pose_is_itself(known: list[Pose], relevance: Relevance) -> None:
    known = sorted({relevance.of(pose) for pose in known})
    assert weights_between(known[0], known, relevance) == {known[0]: 1.0}


@pytest.mark.parametrize(
    ("angle_deg", "expected"),
    [
        pytest.param(2, {turned(0): 0.8, turned(10): 0.2}, id="between two neighbours"),
        pytest.param(355, {turned(350): 0.75, turned(10): 0.25}, id="across zero, which is missing"),
        pytest.param(-5 - 360, {turned(350): 0.75, turned(10): 0.25}, id="turns are taken off"),
    ],
)
def test_angles_are_interpolated_round_the_circle(angle_deg: float, expected: dict[Pose, float]) -> None:
    known = [turned(350), turned(10), turned(90)] + [turned(0)] * (angle_deg == 2)
    assert weights_between(turned(angle_deg), known, TURNTABLE) == pytest.approx(expected)


def test_nothing_known_gives_nothing() -> None:
    assert weights_between(turned(0), [], TURNTABLE) == {}


def test_the_nearest_light_counts_most_and_far_ones_not_at_all() -> None:
    known = [Pose(0, azimuth, 45, 1) for azimuth in (0, 20, 40, 180, 200)]
    weights = weights_between(Pose(0, 19, 45, 1), known, ARM)
    assert max(weights, key=lambda pose: weights[pose]) == known[1]
    assert set(weights) == set(known[:3])


def test_a_dark_lamp_has_the_dark_picture_wherever_it_is() -> None:
    dark, lit = Pose(0, 0, 0, 0), Pose(0, 90, 45, 1)
    assert weights_between(Pose(0, 90, 45, 0), [lit, dark], ARM) == {dark: 1.0}
