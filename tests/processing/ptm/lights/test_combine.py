import numpy as np
import pytest

from litrig.base.directions import angle_between_deg
from processing.outline.circle import Circle
from processing.ptm.lights.combine import APART, BELOW, DROPPED, SHADOWED, combine
from processing.ptm.lights.highlight import Flag, Highlight
from processing.ptm.lights.mirror import Mirror

LARGE, SMALL = Mirror(Circle(100, 100, 80)), Mirror(Circle(300, 100, 20))


def spot(ball: Mirror, x: float, y: float, *flags: Flag) -> Highlight:
    """A highlight at a place in radii from the middle, y upwards."""
    circle = ball.circle
    return Highlight(circle.x_px + x * circle.radius_px, circle.y_px - y * circle.radius_px, 1.0, flags)


def test_balls_that_agree_leave_no_residual() -> None:
    light = combine("a", [LARGE, SMALL], [spot(LARGE, 0.3, 0.2), spot(SMALL, 0.3, 0.2)], dropped=False)
    assert light.residual_deg == pytest.approx(0, abs=1e-5)
    assert light.direction == pytest.approx(LARGE.directions(np.array([[124, 84]]))[0])
    assert (light.flags, light.left_out) == ((), "")


def test_the_larger_ball_has_more_to_say() -> None:
    light = combine("a", [LARGE, SMALL], [spot(LARGE, 0.3, 0.2), spot(SMALL, 0.32, 0.2)], dropped=False)
    large, small = light.sightings
    apart_deg = angle_between_deg(large.direction, small.direction)
    assert large.residual_deg < 0.1 * small.residual_deg
    assert large.residual_deg + small.residual_deg == pytest.approx(apart_deg, rel=1e-3)
    assert light.residual_deg == small.residual_deg


def test_one_ball_has_no_residual_and_says_how_sure_it_is() -> None:
    alone = combine("a", [LARGE], [spot(LARGE, 0.3, 0.2)], dropped=False)
    tiny = combine("a", [SMALL], [spot(SMALL, 0.3, 0.2)], dropped=False)
    assert alone.residual_deg is None
    assert tiny.deviation_deg == pytest.approx(4 * alone.deviation_deg)
    # A quarter of a pixel and a tenth of the blob; the mirrored ray turns twice as fast as the normal.
    pixel_deg = np.degrees(2 / (80 * np.sqrt(1 - 0.13)))
    assert alone.deviation_deg == pytest.approx(np.hypot(0.25, 0.1) * pixel_deg)


def test_a_doubtful_highlight_has_no_say_beside_a_good_one() -> None:
    seen = [spot(LARGE, 0.5, 0.2, Flag.DOUBLE), spot(SMALL, 0.3, 0.2)]
    light = combine("a", [LARGE, SMALL], seen, dropped=False)
    assert light.direction == pytest.approx(light.sightings[1].direction)
    assert light.flags == ()
    assert combine("a", [LARGE, SMALL], [seen[0], None], dropped=False).flags == ("double",)


def test_balls_that_see_different_lights_are_named() -> None:
    light = combine("a", [LARGE, LARGE], [spot(LARGE, 0.5, 0.2), spot(LARGE, 0.3, 0.2)], dropped=False)
    assert APART in light.flags
    assert light.deviation_deg > 3


def test_lights_that_are_not_listed_say_why() -> None:
    assert combine("a", [LARGE], [None], dropped=False).left_out == SHADOWED
    assert combine("a", [LARGE], [spot(LARGE, 0.3, 0.2)], dropped=True).left_out == DROPPED
    behind = combine("a", [LARGE], [spot(LARGE, 0.9, 0.2)], dropped=False)
    assert behind.left_out == BELOW
    assert behind.direction is not None
    assert behind.direction[2] < 0
