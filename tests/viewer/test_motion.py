import pytest

from litrig.base.errors import InputError
from viewer.motion import Course, Motion
from viewer.view import View


def test_a_turntable_goes_round_once_and_joins_where_it_began() -> None:
    moments = list(Motion(Course.TURNTABLE, 8).moments(View(yaw_deg=10, pitch_deg=20)))
    assert [moment.view.yaw_deg for moment in moments] == [10, 55, 100, 145, 190, 235, 280, 325]
    assert {moment.view.pitch_deg for moment in moments} == {20}
    assert {moment.lights_turn_deg for moment in moments} == {0}


def test_on_a_tour_the_lights_go_round_and_the_view_stays() -> None:
    moments = list(Motion(Course.TOUR, 4).moments(View(yaw_deg=10)))
    assert [moment.lights_turn_deg for moment in moments] == [0, 90, 180, 270]
    assert {moment.view for moment in moments} == {View(yaw_deg=10)}


@pytest.mark.parametrize("frames", [-1, 0, 1, 100_001])
def test_a_number_of_frames_that_is_no_video_is_refused(frames: int) -> None:
    with pytest.raises(InputError, match="frames are outside"):
        Motion(Course.TOUR, frames)


@pytest.mark.parametrize("fps", [0.0, float("nan"), 1e9])
def test_so_is_a_speed(fps: float) -> None:
    with pytest.raises(InputError, match="frames a second"):
        Motion(Course.TOUR, 4, fps)
