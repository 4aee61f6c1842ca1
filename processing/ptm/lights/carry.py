"""A ball photographed once, and then the object: its light directions are the object's, frame by frame.

Which ball frame belongs to which object frame is told by the first of these rules that fits all object frames: the same
file name, but for folder and ending; the same commanded light, in sessions that the rig's lamp lit; the same number of
frames, in the same order.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from litrig.base.capture_folder.capture import CapturedFrame
from litrig.base.errors import InputError
from litrig.base.lights import Lights

_SAME_LIGHT = 1e-6


def match_frames(
    balls: Sequence[CapturedFrame], objects: Sequence[CapturedFrame], folder: Path, ball_folder: Path
) -> tuple[list[int], str]:
    """Find the ball frame of each object frame.

    Returns
    -------
    places : the place in `balls` of each object frame's light
    rule : which rule told so, in a few words

    Raises
    ------
    InputError
        No rule fits.
    """
    by_name = _by_name(balls, objects)
    if by_name is not None:
        return by_name, "by file name"
    by_light = _by_light(balls, objects)
    if by_light is not None:
        return by_light, "by commanded light"
    if len(balls) == len(objects):
        return list(range(len(objects))), "by order"
    raise InputError(
        f"{folder}: its {len(objects)} pictures have neither the names nor the number of the {len(balls)} pictures of "
        f"the ball in {ball_folder}; give each pair one name, or take out what has no partner"
    )


def carry(
    lights: Lights, balls: Sequence[CapturedFrame], objects: Sequence[CapturedFrame], places: Sequence[int]
) -> Lights:
    """Give object frames the directions of their ball frames; those whose ball frame has none are left out.

    Parameters
    ----------
    lights : of the ball frames
    places : as `match_frames` returns them

    Raises
    ------
    InputError
        None is left.
    """
    of_ball = dict(zip(lights.names or (), lights.directions, strict=True))
    pairs = [(frame.path.name, balls[place].path.name) for frame, place in zip(objects, places, strict=True)]
    kept = [(name, of_ball[ball]) for name, ball in pairs if ball in of_ball]
    if not kept:
        raise InputError(f"{objects[0].path.parent}: no ball picture that belongs to its pictures shows a light")
    return Lights(tuple(name for name, _ in kept), np.stack([direction for _, direction in kept]))


def _by_name(balls: Sequence[CapturedFrame], objects: Sequence[CapturedFrame]) -> list[int] | None:
    places = {frame.path.stem: place for place, frame in enumerate(balls)}
    if len(places) < len(balls) or any(frame.path.stem not in places for frame in objects):
        return None
    return [places[frame.path.stem] for frame in objects]


def _by_light(balls: Sequence[CapturedFrame], objects: Sequence[CapturedFrame]) -> list[int] | None:
    places = []
    for frame in objects:
        if frame.light is None:
            return None
        alike = [
            place
            for place, ball in enumerate(balls)
            if ball.light is not None and np.abs(ball.light - frame.light).max() < _SAME_LIGHT
        ]
        if len(alike) != 1:
            return None
        places += alike
    return places
