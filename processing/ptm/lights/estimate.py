"""Light directions of a whole session from its mirror balls."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from litrig.base.camera_model import CameraModel
from litrig.base.directions import angle_between_deg
from litrig.base.errors import InputError
from litrig.base.lights import Lights
from litrig.base.progress import Report, silent
from processing.outline.circle import SMALLEST_RADIUS_PX, Circle
from processing.ptm.lights.combine import DROPPED, Light, combine
from processing.ptm.lights.crops import CropFrame, cut_out
from processing.ptm.lights.edits import Edits
from processing.ptm.lights.highlight import Highlight, find_highlights
from processing.ptm.lights.mirror import Mirror, camera_at
from processing.ptm.lights.rim import fit_rim, usual_light
from processing.ptm.lights.survey import find_balls
from processing.stack import Stack
from processing.undistort import undistortion

F32 = NDArray[np.float32]

# A round thing whose directions have nothing to do with those of the surest ball is none.
_STRANGER_DEG = 20.0


@dataclass(frozen=True)
class Ways:
    """What can be chosen.

    Attributes
    ----------
    circles : outlines of the balls in the pictures (undistorted ones, with `camera`); found when empty
    camera : pinhole model with the lens's distortion, which is taken out
    distance_radii : of the camera from the first ball, in its radii, where there is no camera model
    edits : detections to be replayed
    """

    circles: tuple[Circle, ...] = ()
    camera: CameraModel | None = None
    distance_radii: float | None = None
    edits: Edits | None = None


@dataclass(frozen=True)
class Session:
    """What was found.

    Attributes
    ----------
    balls : the mirrors, in pixels of the pictures
    lights : one a picture, in their order
    highlights : of every picture, one a ball
    crops : of every ball, (N, h, w) linear grey
    crop_frames : where the crops lie
    """

    balls: tuple[Mirror, ...]
    lights: tuple[Light, ...]
    highlights: tuple[tuple[Highlight | None, ...], ...]
    crops: tuple[F32, ...]
    crop_frames: tuple[CropFrame, ...]

    def directions(self) -> Lights:
        """Return the lights that are in the list.

        Raises
        ------
        InputError
            There is none.
        """
        kept = [(light.name, light.direction) for light in self.lights if not light.left_out]
        directions = [direction for _, direction in kept if direction is not None]
        if not directions:
            reasons = ", ".join(sorted({light.left_out for light in self.lights}))
            raise InputError(
                f"{self.lights[0].name} and the {len(self.lights) - 1} other pictures show no light ({reasons}); check "
                "the circle with --report DIR, or give --ball X Y R"
            )
        return Lights(tuple(name for name, _ in kept), np.array(directions))

    def frames(self) -> list[tuple[str, bool, tuple[Highlight | None, ...]]]:
        """Return each picture's name, whether it was dropped by hand, and its highlights."""
        pairs = zip(self.lights, self.highlights, strict=True)
        return [(light.name, light.left_out == DROPPED, seen) for light, seen in pairs]


def estimate_lights(paths: Sequence[Path], ways: Ways | None = None, report: Report = silent) -> Session:
    """Find balls and highlights in pictures of one view, and the direction of the light in each.

    Parameters
    ----------
    paths : pictures of one size; what they show stands still, and one light shines in each

    Raises
    ------
    InputError, FormatError
        No ball is found, or one lies outside the pictures; a picture is missing, damaged or of another size.
    """
    ways = ways or Ways()
    edits = ways.edits or Edits()
    camera = ways.camera or (edits.camera if ways.distance_radii is None else None)
    stack = Stack(paths, undistortion(camera))
    shape = stack.shape
    if camera is not None and (camera.height, camera.width) != shape:
        raise InputError(
            f"{paths[0]}: is {shape[1]} × {shape[0]} pixels, the camera model is for {camera.width} × {camera.height}; "
            "calibrate at the size of the capture"
        )
    given = ways.circles or tuple(Circle(ball.x_px, ball.y_px, ball.radius_px) for ball in edits.ball)
    circles = [_inside(circle, shape, paths[0]) for circle in given] or find_balls(stack, camera, report)
    frames = [CropFrame.around(circle, shape) for circle in circles]
    crops = cut_out(stack, frames, report)
    balls = _seen_by(camera, circles, ways.distance_radii, shape)
    if not given:
        circles = [_sharpened(*parts) for parts in zip(crops, frames, balls, strict=True)]
        balls = _seen_by(camera, circles, ways.distance_radii, shape)
    found = [_look(crop, frame, ball) for crop, frame, ball in zip(crops, frames, balls, strict=True)]
    if not given:
        known = _familiar(balls, found)
        balls, found, crops, frames = ([part[number] for number in known] for part in (balls, found, crops, frames))  # type: ignore[assignment]  # four lists of one length
    return _session([path.name for path in paths], balls, found, edits, crops, frames)


def _seen_by(
    camera: CameraModel | None, circles: Sequence[Circle], distance_radii: float | None, shape: tuple[int, int]
) -> list[Mirror]:
    if distance_radii is not None:
        camera = camera_at(distance_radii, circles[0], shape)
    return [Mirror(circle, camera) for circle in circles]


def _sharpened(crop: F32, frame: CropFrame, ball: Mirror) -> Circle:
    inner = frame.inner_mirror(ball)
    rim = fit_rim(usual_light(crop), inner.circle, inner.camera)
    return ball.circle if rim is None else frame.outer(rim.circle)


def _look(crop: F32, frame: CropFrame, ball: Mirror) -> list[Highlight | None]:
    inner = find_highlights(crop, frame.inner_mirror(ball))
    return [None if found is None else frame.outer_highlight(found) for found in inner]


def _session(
    names: Sequence[str],
    balls: Sequence[Mirror],
    found: Sequence[Sequence[Highlight | None]],
    edits: Edits,
    crops: Sequence[F32],
    frames: Sequence[CropFrame],
) -> Session:
    lights, highlights = [], []
    for index, name in enumerate(names):
        seen = [of_ball[index] for of_ball in found]
        edited = edits.of(name)
        # A frame that is only dropped keeps what was seen, for the page to show.
        if edited is not None and (edited.highlight or not edited.drop):
            seen = edits.highlights(edited)
        highlights.append(tuple(seen))
        lights.append(combine(name, balls, seen, dropped=edited is not None and edited.drop))
    return Session(tuple(balls), tuple(lights), tuple(highlights), tuple(crops), tuple(frames))


def _familiar(balls: Sequence[Mirror], found: Sequence[Sequence[Highlight | None]]) -> list[int]:
    """Return the numbers of the balls that see the lights roughly where the surest ball sees them."""
    kept = [0]
    for number in range(1, len(balls)):
        angles = [
            angle_between_deg(*(_direction(balls[n], place) for n, place in ((0, first), (number, other))))
            for first, other in zip(found[0], found[number], strict=True)
            if first is not None and other is not None
        ]
        if angles and float(np.median(angles)) < _STRANGER_DEG:
            kept.append(number)
    return kept


def _direction(ball: Mirror, place: Highlight) -> NDArray[np.float64]:
    directions = ball.directions(np.array([[place.x_px, place.y_px]]))
    return directions.reshape(3)


def _inside(circle: Circle, shape: tuple[int, int], first: Path) -> Circle:
    height, width = shape
    reach = circle.radius_px
    if not (np.isfinite([circle.x_px, circle.y_px, reach]).all() and reach >= SMALLEST_RADIUS_PX):
        raise InputError(f"{first}: a ball with {circle} shows no highlight; give --ball X Y R in pixels")
    if not (reach <= circle.x_px + 1 <= width - reach + 2 and reach <= circle.y_px + 1 <= height - reach + 2):
        raise InputError(
            f"{first}: a ball with {circle} is not inside the {width} × {height} pictures; mend --ball X Y R, or aim "
            "the camera so that all of the ball is seen"
        )
    return circle
