"""How much each rendered picture contributes to one in between."""

import math
from bisect import bisect_right
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from firmware_sim.scene.pose import Pose
from firmware_sim.scene.relevance import Relevance

NEAREST = 3
"""A light direction lies within a triangle of its neighbours."""


def weights_between(pose: Pose, known: Sequence[Pose], relevance: Relevance) -> dict[Pose, float]:
    """Weigh the rendered poses nearest to one.

    Parameters
    ----------
    pose : where the devices are
    known : poses that are rendered, different from each other
    relevance : what the picture depends on

    Returns
    -------
    weights : above 0, of sum 1; of a known pose, that one alone; empty if nothing is known
    """
    if not known:
        return {}
    return _between_directions(pose, known) if relevance.arm else _between_angles(pose.turntable_deg, known)


def _between_angles(angle_deg: float, known: Sequence[Pose]) -> dict[Pose, float]:
    """Interpolate between the neighbours on the circle."""
    ring = sorted(known)
    place = bisect_right(ring, angle_deg % 360, key=lambda pose: pose.turntable_deg)
    before, after = ring[place - 1], ring[place % len(ring)]
    gap_deg = (after.turntable_deg - before.turntable_deg) % 360 or 360.0
    part = (angle_deg - before.turntable_deg) % 360 / gap_deg
    if before == after or not part:
        return {before: 1.0}
    return {before: 1 - part, after: part}


def _between_directions(pose: Pose, known: Sequence[Pose]) -> dict[Pose, float]:
    """Weigh the nearest by the inverse of their squared distance (Shepard 1968)."""
    away = ((_places(known) - _places([pose])) ** 2).sum(axis=1)
    nearest = [int(i) for i in np.argsort(away, kind="stable")[:NEAREST]]
    if away[nearest[0]] < 1e-12:
        return {known[nearest[0]]: 1.0}
    shares = 1 / away[nearest]
    return {known[i]: float(share) for i, share in zip(nearest, shares / shares.sum(), strict=True)}


def _places(poses: Sequence[Pose]) -> NDArray[np.float64]:
    """Put poses into a space where near ones look alike: direction of the lamp times its power, and turn, (N, 5)."""
    turn, a, e = (np.array([pose[i] for pose in poses]) * math.pi / 180 for i in range(3))
    lamp = np.array([pose.lamp for pose in poses])
    light = (lamp * np.cos(e) * np.cos(a), lamp * np.cos(e) * np.sin(a), lamp * np.sin(e))
    return np.stack([*light, np.cos(turn), np.sin(turn)], axis=1)
