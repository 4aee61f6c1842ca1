"""Mirror balls in pictures under many lights, found without a click.

A ball stands still, and so does most of what it mirrors: the median of the pictures has its outline, whatever the
lights do. It is taken of logarithms, in which a dark rim before a dark room shows, and a lamp's glare does not rule.
A round thing is a ball if, in most pictures, one small highlight in it outshines everything else there.
"""

import numpy as np
from numpy.typing import NDArray

from litrig.base.camera_model import CameraModel
from litrig.base.errors import InputError
from litrig.base.progress import Progress, Report
from processing.outline.circle import Circle
from processing.outline.circle_search import find_rings, ring_radii
from processing.outline.silhouette import shrunk
from processing.ptm.lights.crops import CropFrame
from processing.ptm.lights.highlight import moving_light, stands_out
from processing.ptm.lights.rim import Rim, fit_rim, logarithms, usual_light
from processing.stack import Stack

F32 = NDArray[np.float32]

_MOST_FRAMES = 16
# A ball that fills the frame is searched in a small picture; one beside a large object in a larger one.
_LARGE_SIDE_PX, _LARGE_SHARES, _MOST_LARGE = 160, (0.1, 0.6), 5
_SMALL_SIDE_PX, _SMALL_RADII_PX, _MOST_SMALL = 640, (16.0, 64.0), 12
_WHITE_QUANTILE, _DARKEST = 0.999, 1e-9
_LEAST_AGREEMENT, _LEAST_MIRRORED = 0.6, 0.6
_SMALLEST_PX = 18.0
"""Of a ball's radius: in smaller ones the rim and the table's edge that it mirrors cannot be told apart."""
_BEYOND_SHARE = 0.02
# A ball mirrors the table's edge as a circle of its own, from 0.7 of the radius outwards. The larger circle is the
# ball's, unless hardly anything speaks for it.
_LARGER, _PLAIN_AGREEMENT, _ALIKE, _APART = (1.12, 1.25, 1.4), 0.7, 0.05, 0.9
_NEXT_STEP = "give --ball X Y R"


def find_balls(stack: Stack, camera: CameraModel | None, report: Report) -> list[Circle]:
    """Find all mirror balls, the most certain first.

    Parameters
    ----------
    stack : pictures under different lights; some, spread over all, are looked at
    camera : of perspective pictures, if it is known: the outline of a ball off its axis is an ellipse

    Returns
    -------
    circles : in pixels of the pictures, to a hundredth of the radius or so

    Raises
    ------
    InputError
        There is none.
    """
    picks = np.unique(np.linspace(0, len(stack), _MOST_FRAMES, endpoint=False).astype(np.int64))
    first, factor = shrunk(stack.linear(int(picks[0])))
    greys = np.zeros((len(picks), *first.shape[:2]), np.float32)
    for place, index in enumerate(picks):
        greys[place] = (shrunk(stack.linear(int(index)))[0] if place else first).mean(axis=-1)
        report(Progress("finding the balls", place + 1, len(picks), stack.paths[index].name))
    still, changing = _still_and_changing(greys)
    if camera is not None:
        camera = CropFrame(0, 0, factor * still.shape[1], factor * still.shape[0], factor).inner_camera(camera)
    rims = _round_things(usual_light(greys), [*_guesses(still), *_guesses(changing)], camera)
    balls = _balls(rims, greys)
    if not balls:
        reason = "a round outline is there, and no small highlight moves in it" if rims else "no round outline"
        raise InputError(f"{stack.paths[0].parent}: no mirror ball found ({reason}); {_NEXT_STEP}, or shoot one")
    found = [rim.circle for rim in balls]
    return [Circle(circle.x_px * factor, circle.y_px * factor, circle.radius_px * factor) for circle in found]


def _round_things(light: F32, guesses: list[Circle], camera: CameraModel | None) -> list[Rim]:
    """Refine guesses, look for larger circles around what they lead to, and return all that are certainly round."""
    found = _unlike([rim for guess in guesses if (rim := _certain(light, guess, camera))])
    around = [Circle(circle.x_px, circle.y_px, factor * circle.radius_px) for circle, _ in found for factor in _LARGER]
    return _unlike([*found, *(rim for guess in around if (rim := _certain(light, guess, camera)))])


def _certain(light: F32, guess: Circle, camera: CameraModel | None) -> Rim | None:
    rim = fit_rim(light, guess, camera)
    if rim is None or rim.agreement < _LEAST_AGREEMENT:
        return None
    return rim if rim.circle.radius_px >= _SMALLEST_PX and _is_inside(rim.circle, light.shape) else None


def _is_inside(circle: Circle, shape: tuple[int, ...]) -> bool:
    reach = (1 - _BEYOND_SHARE) * circle.radius_px
    across, down = reach <= circle.x_px <= shape[1] - reach, reach <= circle.y_px <= shape[0] - reach
    return across and down


def _unlike(rims: list[Rim]) -> list[Rim]:
    """Keep the surest of circles that are the same to a twentieth of the radius."""
    kept: list[Rim] = []
    for rim in sorted(rims, key=lambda rim: -rim.agreement):
        here = rim.circle
        shifts = [(here.x_px - c.x_px, here.y_px - c.y_px, here.radius_px - c.radius_px) for c, _ in kept]
        if all(np.abs(shift).max() > _ALIKE * here.radius_px for shift in shifts):
            kept.append(rim)
    return kept


def _still_and_changing(greys: F32) -> tuple[F32, F32]:
    """Return the median of the logarithms, and their deviation; (H, W) each, 0..1."""
    steep = logarithms(greys)
    return _scaled(np.median(steep, axis=0)), _scaled(steep.std(axis=0))


def _scaled(picture: F32) -> F32:
    darkest, brightest = float(picture.min()), float(np.quantile(picture, _WHITE_QUANTILE))
    scaled: F32 = np.clip((picture - darkest) / max(brightest - darkest, _DARKEST), 0, 1).astype(np.float32)
    return scaled


def _guesses(picture: F32) -> list[Circle]:
    longest, shortest = max(picture.shape), min(picture.shape)
    shrink = min(1.0, _LARGE_SIDE_PX / longest)
    large = ring_radii(*(share * shrink * shortest for share in _LARGE_SHARES))
    found = find_rings(picture, shrink, large, _MOST_LARGE)
    shrink = min(1.0, _SMALL_SIDE_PX / longest)
    largest_px = min(_SMALL_RADII_PX[1], shrink * shortest / 2)
    if largest_px > _SMALL_RADII_PX[0]:
        found += find_rings(picture, shrink, ring_radii(_SMALL_RADII_PX[0], largest_px), _MOST_SMALL)
    return [Circle(*ring) for ring in found]


def _mirrored_share(greys: F32, circle: Circle) -> float:
    """Return the share of the pictures in which one small thing in the disc outshines all else."""
    reach = int(np.ceil(circle.radius_px)) + 1
    left, top = max(int(circle.x_px) - reach, 0), max(int(circle.y_px) - reach, 0)
    crops = greys[:, top : int(circle.y_px) + reach, left : int(circle.x_px) + reach]
    rows, columns = np.indices(crops.shape[1:]) + 0.5
    disc = np.hypot(columns + left - circle.x_px, rows + top - circle.y_px) < 0.95 * circle.radius_px
    if not disc.any():
        return 0.0
    return float(np.mean([stands_out(light[disc]) for light in moving_light(crops)]))


def _balls(rims: list[Rim], greys: F32) -> list[Rim]:
    """Keep what mirrors; of circles that overlap the plainest and largest, for reflections may be round as well."""
    kept: list[Rim] = []
    for rim in sorted(rims, key=lambda rim: -min(rim.agreement, _PLAIN_AGREEMENT) * rim.circle.radius_px):
        here = rim.circle
        gaps = [
            np.hypot(here.x_px - other.x_px, here.y_px - other.y_px) / (here.radius_px + other.radius_px)
            for other, _ in kept
        ]
        if all(gap > _APART for gap in gaps) and _mirrored_share(greys, here) >= _LEAST_MIRRORED:
            kept.append(rim)
    return kept
