"""Mirror balls in pictures under many lights, found without a click.

A ball stands still, and so does most of what it mirrors: the median of the pictures has its outline, whatever the
lights do. It is taken of logarithms, in which a dark rim before a dark room shows, and a lamp's glare does not rule.
A round thing is a ball if, in most pictures, one small highlight in it outshines everything else there.
"""

from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.progress import Progress, Report
from processing.amc.outline.circle import Circle
from processing.amc.outline.circle_search import find_rings, ring_radii
from processing.amc.outline.limb import weigh_apart
from processing.amc.outline.rim_fit import Limb
from processing.amc.outline.silhouette import Turn, shrunk
from processing.ptm.lights.highlight import moving_light, stands_out
from processing.stack import Stack

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

_MOST_FRAMES = 16
# A ball that fills the frame is searched in a small picture; one beside a large object in a larger one.
_LARGE_SIDE_PX, _LARGE_SHARES, _MOST_LARGE = 160, (0.1, 0.6), 5
_SMALL_SIDE_PX, _SMALL_RADII_PX, _MOST_SMALL = 640, (7.0, 64.0), 8
_MARGIN_SHARE = 0.1
_DARK_SHARE, _USUAL_QUANTILE, _DARKEST = 0.3, 0.9, 1e-9
_LEAST_AGREEMENT, _LEAST_EVIDENCE = 0.55, 0.4
_LEAST_MIRRORED = 0.6
# A ball mirrors the table's edge as a circle of its own, from 0.7 of the radius outwards. The larger circle is the
# ball's, unless hardly anything speaks for it.
_LARGER, _PLAIN_EVIDENCE, _ALIKE = (1.12, 1.25, 1.4), 0.7, 0.05
_NEXT_STEP = "give --ball X Y R"


def find_balls(stack: Stack, report: Report) -> list[Circle]:
    """Find all mirror balls, the most certain first.

    Parameters
    ----------
    stack : pictures under different lights; some, spread over all, are looked at

    Returns
    -------
    circles : in pixels of the pictures, to a hundredth of the radius or so; `rim.sharpen` does the rest

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
    certain = _round_things(still, [*_guesses(still), *_guesses(changing)])
    balls = _apart([limb for limb in certain if _mirrored_share(greys, limb) >= _LEAST_MIRRORED])
    if not balls:
        reason = "a round outline is there, and no small highlight moves in it" if certain else "no round outline"
        raise InputError(f"{stack.paths[0].parent}: no mirror ball found ({reason}); {_NEXT_STEP}, or shoot one")
    return [Circle(ball.x_px * factor, ball.y_px * factor, ball.radius_px * factor) for ball in balls]


def _round_things(still: F32, guesses: list[tuple[float, float, float]]) -> list[Limb]:
    """Refine guesses, look for larger circles around what they lead to, and return all that are certainly round."""
    margin = round(_MARGIN_SHARE * min(still.shape))
    turn = Turn(_with_margin(still, margin)[None, ..., None])
    starts = _unlike([Limb(x + margin, y + margin, radius, evidence=-n) for n, (x, y, radius) in enumerate(guesses)])
    found = [turn.home_in(start, weigh_apart) for start in starts]
    found = _unlike([limb for limb in found if _is_certain(limb)])
    around = [
        turn.home_in(Limb(limb.x_px, limb.y_px, factor * limb.radius_px), weigh_apart)
        for limb in found
        for factor in _LARGER
    ]
    everything = _unlike([*found, *(limb for limb in around if _is_certain(limb))])
    return [replace(limb, x_px=limb.x_px - margin, y_px=limb.y_px - margin) for limb in everything]


def _is_certain(limb: Limb) -> bool:
    return limb.agreement >= _LEAST_AGREEMENT and limb.evidence >= _LEAST_EVIDENCE


def _unlike(limbs: list[Limb]) -> list[Limb]:
    """Keep the surest of circles that are the same to a twentieth of the radius."""
    kept: list[Limb] = []
    for limb in sorted(limbs, key=lambda limb: -limb.evidence):
        shift = [np.abs([limb.x_px - o.x_px, limb.y_px - o.y_px, limb.radius_px - o.radius_px]).max() for o in kept]
        if all(part > _ALIKE * limb.radius_px for part in shift):
            kept.append(limb)
    return kept


def _still_and_changing(greys: F32) -> tuple[F32, F32]:
    """Return the median of the logarithms, and their deviation; (H, W) each, 0..1."""
    # Below a share of the usual brightness noise would be all there is.
    usual = greys[greys <= np.quantile(greys, _USUAL_QUANTILE)].mean()
    logarithms = np.log(greys + max(_DARK_SHARE * float(usual), _DARKEST))
    return _scaled(np.median(logarithms, axis=0)), _scaled(logarithms.std(axis=0))


def _scaled(picture: F32) -> F32:
    darkest, brightest = float(picture.min()), float(np.quantile(picture, 0.999))
    scaled: F32 = np.clip((picture - darkest) / max(brightest - darkest, _DARKEST), 0, 1).astype(np.float32)
    return scaled


def _guesses(picture: F32) -> list[tuple[float, float, float]]:
    longest, shortest = max(picture.shape), min(picture.shape)
    shrink = min(1.0, _LARGE_SIDE_PX / longest)
    large = ring_radii(*(share * shrink * shortest for share in _LARGE_SHARES))
    found = find_rings(picture, shrink, large, _MOST_LARGE)
    shrink = min(1.0, _SMALL_SIDE_PX / longest)
    largest_px = min(_SMALL_RADII_PX[1], shrink * shortest / 2)
    if largest_px > _SMALL_RADII_PX[0]:
        found += find_rings(picture, shrink, ring_radii(_SMALL_RADII_PX[0], largest_px), _MOST_SMALL)
    return found


def _mirrored_share(greys: F32, limb: Limb) -> float:
    """Return the share of the pictures in which one small thing in the disc outshines all else."""
    reach = int(np.ceil(limb.radius_px)) + 1
    left, top = max(int(limb.x_px) - reach, 0), max(int(limb.y_px) - reach, 0)
    crops = greys[:, top : int(limb.y_px) + reach, left : int(limb.x_px) + reach]
    rows, columns = np.indices(crops.shape[1:]) + 0.5
    disc = np.hypot(columns + left - limb.x_px, rows + top - limb.y_px) < 0.95 * limb.radius_px
    if not disc.any():
        return 0.0
    return float(np.mean([stands_out(light[disc]) for light in moving_light(crops)]))


def _apart(limbs: list[Limb]) -> list[Limb]:
    """Keep of circles that overlap the plainest and largest: a ball's own reflections may be round as well."""
    kept: list[Limb] = []
    for limb in sorted(limbs, key=lambda limb: -min(limb.evidence, _PLAIN_EVIDENCE) * limb.radius_px):
        if all(
            np.hypot(limb.x_px - other.x_px, limb.y_px - other.y_px) > 0.9 * (limb.radius_px + other.radius_px)
            for other in kept
        ):
            kept.append(limb)
    return kept


def _with_margin(picture: F32, margin: int) -> F32:
    colour = float(np.median([picture[0, 0], picture[0, -1], picture[-1, 0], picture[-1, -1]]))
    padded = cv2.copyMakeBorder(picture, margin, margin, margin, margin, cv2.BORDER_CONSTANT, value=colour)
    return np.asarray(padded, np.float32)
