"""Taking one angle, or one light, out of a session that has many."""

from itertools import product
from pathlib import Path

import numpy as np
import pytest

from litrig.base.capture_folder.capture import Capture, CapturedFrame, Role
from litrig.base.capture_folder.select import at_one_angle, under_one_light
from litrig.base.directions import direction_from_angles
from litrig.base.errors import InputError

ANGLES_DEG = (0.0, 90.0, 359.8)
LIGHTS = tuple(direction_from_angles(azimuth, 40.0) for azimuth in (10.0, 130.0))


def session() -> Capture:
    frames = [
        CapturedFrame(Path(f"{number}.jpg"), angle_deg=angle, light=light)
        for number, (angle, light) in enumerate(product(ANGLES_DEG, LIGHTS))
    ]
    return Capture(Path("s"), "x", (*frames, CapturedFrame(Path("dark.jpg"), Role.DARK)))


def names(capture: Capture) -> list[str]:
    return [frame.path.stem for frame in capture.frames]


def test_one_angle_is_taken_modulo_a_turn_and_references_stay() -> None:
    assert names(at_one_angle(session(), 90.2)) == ["2", "3", "dark"]
    assert names(at_one_angle(session(), 360.0)) == ["0", "1", "4", "5", "dark"]


def test_one_light_is_taken() -> None:
    assert names(under_one_light(session(), direction_from_angles(130.5, 40.0))) == ["1", "3", "5", "dark"]


def test_where_there_are_several_one_must_be_named() -> None:
    with pytest.raises(InputError, match=r"shot at 2 angles, 0°, 90°; name one with --angle"):
        at_one_angle(session(), None)
    with pytest.raises(InputError, match=r"under 2 lights, 10\.0° 40\.0°, 130\.0° 40\.0°; name one with --under"):
        under_one_light(session(), None)


def test_what_is_not_there_is_named() -> None:
    with pytest.raises(InputError, match=r"nothing was shot at 45°; its angles are 0°, 90°"):
        at_one_angle(session(), 45.0)
    with pytest.raises(InputError, match=r"nothing was shot under a light at 0\.0° 90\.0°"):
        under_one_light(session(), np.array([0.0, 0.0, 1.0]))


def test_a_session_of_one_kind_needs_no_choice() -> None:
    still = Capture(
        Path("s"), "x", tuple(CapturedFrame(Path(f"{n}.jpg"), light=light) for n, light in enumerate(LIGHTS))
    )
    turned = Capture(Path("s"), "x", tuple(CapturedFrame(Path(f"{a}.jpg"), angle_deg=a) for a in ANGLES_DEG))
    assert at_one_angle(still, None) is still
    assert under_one_light(still, None) is still, "many lights on a still object are a PTM's, not one to choose"
    assert under_one_light(turned, None) is turned
