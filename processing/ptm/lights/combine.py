"""From highlights on one or several balls to a direction for each light, and how sure it is."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.directions import angle_between_deg
from processing.ptm.lights.highlight import Highlight
from processing.ptm.lights.mirror import Mirror

F64 = NDArray[np.float64]

DISAGREE_DEG = 3.0
"""Balls that differ by more see different lights, or one of them is no ball."""
_OUTLINE_DEVIATION_PX, _SPREAD_SHARE = 0.25, 0.1
_LEAST_FACING = 0.05

SHADOWED, DROPPED, BELOW, APART = "shadowed", "dropped", "below the horizon", "the balls disagree"


@dataclass(frozen=True)
class Sighting:
    """A light in one ball.

    Attributes
    ----------
    ball : number of the ball, from 0
    highlight : where it is seen
    direction : (3,) float64, unit, view frame, ball to light
    deviation_deg : standard deviation of the direction, as outline and blob let expect it
    residual_deg : angle to the light's direction
    """

    ball: int
    highlight: Highlight
    direction: F64
    deviation_deg: float
    residual_deg: float = 0.0


@dataclass(frozen=True)
class Light:
    """The light of one picture.

    Attributes
    ----------
    name : the picture's file name
    direction : (3,) float64, unit, view frame, sample to light; None where no ball shows it
    sightings : one a ball that shows it
    deviation_deg : standard deviation of the direction: from the balls' disagreement, or as one ball lets expect it
    flags : what is doubtful
    left_out : why the light is not in the list; empty if it is
    """

    name: str
    direction: F64 | None
    sightings: tuple[Sighting, ...]
    deviation_deg: float
    flags: tuple[str, ...]
    left_out: str = ""

    @property
    def residual_deg(self) -> float | None:
        """Largest angle between a ball's direction and the light's; None with fewer than two."""
        if len(self.sightings) < 2:
            return None
        return max(sighting.residual_deg for sighting in self.sightings)


def combine(name: str, balls: Sequence[Mirror], highlights: Sequence[Highlight | None], *, dropped: bool) -> Light:
    """Make one direction of what the balls show: their mean, weighted by how sure each is.

    Balls with a doubtful highlight have no say where others have a good one.

    Parameters
    ----------
    highlights : one a ball, or None where it shows none
    dropped : the user wants no light for this picture
    """
    seen = [
        _sight(number, ball, highlight)
        for number, (ball, highlight) in enumerate(zip(balls, highlights, strict=True))
        if highlight is not None
    ]
    if not seen:
        return Light(name, None, (), np.inf, () if dropped else (SHADOWED,), DROPPED if dropped else SHADOWED)
    trusted = [sighting for sighting in seen if not sighting.highlight.flags] or seen
    weights = np.array([sighting.deviation_deg**-2 for sighting in trusted])
    mean = weights @ np.stack([sighting.direction for sighting in trusted])
    direction = mean / np.linalg.norm(mean)
    sightings = tuple(
        Sighting(s.ball, s.highlight, s.direction, s.deviation_deg, angle_between_deg(s.direction, direction))
        for s in seen
    )
    flags = list(dict.fromkeys(str(flag) for sighting in trusted for flag in sighting.highlight.flags))
    trusted_balls = {sighting.ball for sighting in trusted}
    residuals = np.array([s.residual_deg for s in sightings if s.ball in trusted_balls])
    if residuals.max() > DISAGREE_DEG:
        flags.append(APART)
    expected_deg = float(weights.sum() ** -0.5)
    observed_deg = float(np.sqrt(np.mean(residuals**2)) / max(len(residuals) - 1, 1) ** 0.5)
    left_out = DROPPED if dropped else BELOW if direction[2] <= 0 else ""
    return Light(name, direction, sightings, max(expected_deg, observed_deg), tuple(flags), left_out)


def _sight(number: int, ball: Mirror, highlight: Highlight) -> Sighting:
    place = np.array([[highlight.x_px, highlight.y_px]])
    facing = max(float(ball.facing(place)[0]), _LEAST_FACING)
    # The normal turns by 1/(R cos) a pixel, the mirrored ray by twice that.
    off_px = np.hypot(_OUTLINE_DEVIATION_PX, _SPREAD_SHARE * highlight.spread_px)
    deviation_deg = float(np.degrees(2 * off_px / (ball.circle.radius_px * facing)))
    return Sighting(number, highlight, ball.directions(place)[0], deviation_deg)
