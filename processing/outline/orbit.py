"""The image of the rotation axis: a sample mounted off it makes the circle's centre move round.

The centre is c(θ) = a + ρ·(cos(θ + φ), −sin(θ + φ)) with the turntable angle θ counter-clockwise as the camera sees it;
the picture's y runs down. What the formula leaves over is a tilted mount, or play.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.progress import Report, silent
from processing.outline.circle import Circle, trusted
from processing.outline.limb import weigh_apart
from processing.outline.rim_fit import Limb
from processing.outline.silhouette import load_turn
from processing.stack import Stack

F64 = NDArray[np.float64]

_MOST_FRAMES = 16
_SMALLEST_OFFSET_PX, _SIGNIFICANT = 0.15, 3.0
_ROUNDS, _FINEST_PX = 8, 0.02
# Single pictures are this sure of themselves; what leaves more moves.
_STILL_PX = 0.25
WOBBLE_PX = 0.5
"""A left-over above this is worth a word: it shows in the table beside the rim."""


@dataclass(frozen=True)
class Orbit:
    """How the sample's centre moves round the axis, in pixels of the full pictures.

    Attributes
    ----------
    axis_x_px, axis_y_px : the axis' image, from the picture's upper left corner
    offset_px : ρ, 0 where no motion is significant
    phase_rad : φ, direction of the offset at turntable zero, counter-clockwise from the picture's right
    radius_px : of the circle
    left_over_px : RMS distance of the centres seen from those of the formula
    uncertainty_px : standard deviation of ρ
    """

    axis_x_px: float
    axis_y_px: float
    offset_px: float
    phase_rad: float
    radius_px: float
    left_over_px: float
    uncertainty_px: float

    def circle_at(self, angle_rad: float) -> Circle:
        """Return the circle at a turntable angle."""
        round_rad = angle_rad + self.phase_rad
        x_px = self.axis_x_px + self.offset_px * np.cos(round_rad)
        y_px = self.axis_y_px - self.offset_px * np.sin(round_rad)
        return Circle(float(x_px), float(y_px), self.radius_px)

    def remark(self) -> str | None:
        """Say what the user should know about the mount; None if there is nothing."""
        if self.left_over_px > WOBBLE_PX:
            return (
                f"the sphere wobbles by {self.left_over_px:.2g} px beyond a turn about one axis; "
                "fasten the sample, check the mount for tilt and the table for play"
            )
        if self.offset_px:
            return f"the sample sits {self.offset_px:.2g} px off the table's axis; its circle is followed round"
        return None


@dataclass(frozen=True)
class Outline:
    """The sphere in the pictures of a turn.

    Attributes
    ----------
    circle : the mean silhouette, around the axis where the sphere moves round
    orbit : how it moves
    """

    circle: Circle
    orbit: Orbit

    def circle_at(self, angle_rad: float) -> Circle:
        """Return the silhouette at a turntable angle."""
        return self.orbit.circle_at(angle_rad)


def find_outline(stack: Stack, angles_rad: F64, report: Report = silent) -> Outline:
    """Find the sphere and its motion together.

    Parameters
    ----------
    stack : pictures in the order of their turntable angles
    angles_rad : (N,) turntable angle of each, counter-clockwise as the camera sees it

    Raises
    ------
    InputError
        No circle stands out, or there is not an angle for every picture.
    """
    if len(angles_rad) != len(stack):
        raise InputError(
            f"{stack.paths[0].parent}: {len(stack)} pictures and {len(angles_rad)} angles; name one for each"
        )
    source = str(stack.paths[0].parent)
    turn, picks, factor = load_turn(stack, _MOST_FRAMES, report)
    limb, weigh = turn.find()
    angles = np.asarray(angles_rad, np.float64)[picks]
    centres, _, radius_px = turn.watch(limb)
    orbit = fit_orbit(centres, angles, radius_px)
    start = Limb(orbit.axis_x_px, orbit.axis_y_px, radius_px)
    if orbit.left_over_px > _STILL_PX:
        on_axis = turn.sharpen(start, weigh_apart, centres)
    elif orbit.offset_px:
        on_axis = turn.sharpen(start, weigh_apart, _centres(orbit, angles))
    else:
        on_axis = turn.sharpen(limb, weigh)
    circle = trusted(on_axis, centres, orbit.left_over_px, factor, source)
    return Outline(circle, _enlarged(orbit, circle, factor))


def fit_orbit(centres_px: F64, angles_rad: F64, radius_px: float) -> Orbit:
    """Fit axis, offset and phase to centres by reweighted least squares (Tukey).

    With C = ρ cos φ and S = ρ sin φ it is linear: x = a_x + C cos θ − S sin θ, y = a_y − S cos θ − C sin θ.

    Parameters
    ----------
    centres_px : (N, 2) x, y
    angles_rad : (N,)
    """
    cosine, sine, one, none = (
        np.cos(angles_rad),
        np.sin(angles_rad),
        np.ones(len(angles_rad)),
        np.zeros(len(angles_rad)),
    )
    design = np.stack(
        [np.stack([one, none, cosine, -sine], axis=1), np.stack([none, one, -sine, -cosine], axis=1)], axis=1
    )
    weights = np.ones(len(centres_px))
    for _ in range(_ROUNDS):
        root = np.sqrt(weights)[:, None]
        rows = (design * root[..., None]).reshape(-1, 4)
        solution = np.linalg.lstsq(rows, (centres_px * root).ravel(), rcond=None)[0]
        left = np.linalg.norm(centres_px - design @ solution, axis=1)
        scale = max(float(np.median(left)), _FINEST_PX)
        weights = np.maximum(1 - (left / (5 * scale)) ** 2, 0) ** 2
    freedom = max(2 * float(weights.sum()) - 4, 1.0)
    spread = np.sqrt(float(np.sum(weights * left**2)) / freedom)
    uncertainty = float(spread * np.sqrt(np.linalg.pinv(rows.T @ rows)[2:, 2:].trace() / 2))
    offset = float(np.hypot(*solution[2:]))
    moves = offset > max(_SMALLEST_OFFSET_PX, _SIGNIFICANT * uncertainty)
    left_over = left if moves else np.linalg.norm(centres_px - np.median(centres_px, axis=0), axis=1)
    return Orbit(
        axis_x_px=float(solution[0]),
        axis_y_px=float(solution[1]),
        offset_px=offset if moves else 0.0,
        phase_rad=float(np.arctan2(solution[3], solution[2])) if moves else 0.0,
        radius_px=radius_px,
        left_over_px=float(np.sqrt(np.mean(left_over**2))),
        uncertainty_px=uncertainty,
    )


def _centres(orbit: Orbit, angles_rad: F64) -> F64:
    circles = [orbit.circle_at(float(angle)) for angle in angles_rad]
    return np.array([[circle.x_px, circle.y_px] for circle in circles])


def _enlarged(orbit: Orbit, circle: Circle, factor: int) -> Orbit:
    """Return the orbit about the circle's centre, in pixels of the full pictures."""
    return Orbit(
        axis_x_px=circle.x_px,
        axis_y_px=circle.y_px,
        offset_px=orbit.offset_px * factor,
        phase_rad=orbit.phase_rad,
        radius_px=circle.radius_px,
        left_over_px=orbit.left_over_px * factor,
        uncertainty_px=orbit.uncertainty_px * factor,
    )
