"""What changes from one frame of a video to the next."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import StrEnum

from litrig.base.errors import InputError
from processing.ptm.relighting.lights import Lights
from viewer.view import View

_MOST_FRAMES = 100_000


class Course(StrEnum):
    """What goes round once."""

    TURNTABLE = "turntable"
    """The object, about its upright axis, under light that stands still."""
    TOUR = "tour"
    """The lights, about the line of sight, each at its own elevation."""


@dataclass(frozen=True)
class Moment:
    """One frame.

    Attributes
    ----------
    view : how the object is turned and looked at
    lights_turn_deg : lights are turned so far about the line of sight, counter-clockwise as the camera sees it
    matcap_light : where a decomposed MatCap's light from the camera is turned, x and y; None is as it was staged
    """

    view: View
    lights_turn_deg: float = 0.0
    matcap_light: tuple[float, float] | None = None


@dataclass(frozen=True)
class Motion:
    """One time round, in equal steps that join without a jerk when the video is repeated.

    Attributes
    ----------
    frames : how many
    fps : frames a second
    """

    course: Course
    frames: int
    fps: float = 25.0

    def __post_init__(self) -> None:
        if not 2 <= self.frames <= _MOST_FRAMES:
            raise InputError(f"video: {self.frames} frames are outside 2..{_MOST_FRAMES}")
        if not (math.isfinite(self.fps) and 1 <= self.fps <= 240):
            raise InputError(f"video: {self.fps:g} frames a second are outside 1..240")

    def moments(self, view: View) -> Iterator[Moment]:
        """List the frames, the first of which is the still picture."""
        for number in range(self.frames):
            turn_deg = 360 * number / self.frames
            if self.course is Course.TURNTABLE:
                yield Moment(replace(view, yaw_deg=view.yaw_deg + turn_deg))
            else:
                yield Moment(view, turn_deg)


def turned_lights(lights: Lights, turn_deg: float) -> Lights:
    """Turn lights about z, from x towards y."""
    if turn_deg == 0:
        return lights
    cosine, sine = math.cos(math.radians(turn_deg)), math.sin(math.radians(turn_deg))
    directions = lights.directions.copy()
    x, y = lights.directions[:, 0], lights.directions[:, 1]
    directions[:, 0], directions[:, 1] = cosine * x - sine * y, sine * x + cosine * y
    return lights._replace(directions=directions)
