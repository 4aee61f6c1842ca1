"""Which step of one session is which of another: by number where the poses agree, else by pose."""

from collections import deque
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from acquisition.plans import Step
from litrig.base.directions import angle_between_deg, direction_from_angles

F64 = NDArray[np.float64]


@dataclass(frozen=True)
class Tolerances:
    """How far poses may be apart that count as the same, in degrees."""

    turntable_deg: float = 0.3
    light_deg: float = 0.3


@dataclass(frozen=True)
class Matching:
    """The steps of two plans.

    Attributes
    ----------
    same : pairs of steps of one pose
    moved : pairs of one number whose poses differ, and by how much: of the turntable and of the light, in degrees
    only_a, only_b : the others
    """

    same: tuple[tuple[Step, Step], ...]
    moved: tuple[tuple[Step, Step, float, float], ...]
    only_a: tuple[Step, ...]
    only_b: tuple[Step, ...]


def match(a: Sequence[Step], b: Sequence[Step], tolerances: Tolerances) -> Matching:
    """Pair the steps of two plans; each is in one pair at most."""
    of_b = {step.step: step for step in b}
    same = [
        (step, other) for step in a if (other := of_b.get(step.step)) is not None and _is_same(step, other, tolerances)
    ]
    left_a, left_b = _without(a, (pair[0] for pair in same)), _without(b, (pair[1] for pair in same))
    same += _by_pose(left_a, left_b, tolerances)
    left_a, left_b = _without(left_a, (pair[0] for pair in same)), _without(left_b, (pair[1] for pair in same))
    left = {step.step: step for step in left_b}
    moved = [
        (step, other, *_apart_deg(step, other))
        for step in left_a
        if (other := left.get(step.step)) is not None and _kind(step) == _kind(other)
    ]
    return Matching(
        same=tuple(sorted(same, key=lambda pair: pair[0].step)),
        moved=tuple(moved),
        only_a=tuple(_without(left_a, (pair[0] for pair in moved))),
        only_b=tuple(_without(left_b, (pair[1] for pair in moved))),
    )


def _kind(step: Step) -> tuple[object, ...]:
    """Return what must be equal for two steps to be of one pose."""
    return (step.role, step.exposure_ev, step.repeat, step.lit, step.angle_deg is None, step.aim is None)


def _is_same(step: Step, other: Step, tolerances: Tolerances) -> bool:
    turned_deg, lit_deg = _apart_deg(step, other)
    is_near = turned_deg <= tolerances.turntable_deg and lit_deg <= tolerances.light_deg
    return _kind(step) == _kind(other) and is_near


def _apart_deg(step: Step, other: Step) -> tuple[float, float]:
    turned_deg = abs((step.angle_deg or 0.0) - (other.angle_deg or 0.0))
    if step.aim is None or other.aim is None:
        return turned_deg, 0.0
    return turned_deg, angle_between_deg(_direction(step), _direction(other))


def _by_pose(a: Sequence[Step], b: Sequence[Step], tolerances: Tolerances) -> list[tuple[Step, Step]]:
    """Pair steps of one kind: those of the very same pose in their order, then the nearest first."""
    pairs = _one_by_one(a, b, lambda step: (_kind(step), step.angle_deg, step.aim))
    kinds: dict[object, tuple[list[Step], list[Step]]] = {}
    for side, steps in enumerate((_without(a, (one for one, _ in pairs)), _without(b, (other for _, other in pairs)))):
        for step in steps:
            kinds.setdefault(_kind(step), ([], []))[side].append(step)
    for of_a, of_b in kinds.values():
        while of_a and of_b and (found := _nearest(of_a, of_b, tolerances)):
            pairs += found
            of_a, of_b = _without(of_a, (one for one, _ in found)), _without(of_b, (other for _, other in found))
    return pairs


def _one_by_one(a: Iterable[Step], b: Iterable[Step], pose: Callable[[Step], object]) -> list[tuple[Step, Step]]:
    waiting: dict[object, deque[Step]] = {}
    for step in b:
        waiting.setdefault(pose(step), deque()).append(step)
    return [(step, others.popleft()) for step in a if (others := waiting.get(pose(step)))]


def _nearest(a: Sequence[Step], b: Sequence[Step], tolerances: Tolerances) -> list[tuple[Step, Step]]:
    """Pair steps within the tolerances; in the tree's space a tolerance has length 1."""
    distances, indices = cKDTree(_places(b, tolerances)).query(_places(a, tolerances), distance_upper_bound=1.5)
    pairs, taken = [], set()
    for row in np.argsort(distances, kind="stable"):
        column = int(indices[row])
        if column < len(b) and column not in taken and _is_same(a[row], b[column], tolerances):
            taken.add(column)
            pairs.append((a[row], b[column]))
    return pairs


def _places(steps: Sequence[Step], tolerances: Tolerances) -> F64:
    turned = np.array([step.angle_deg or 0.0 for step in steps], np.float64) / max(tolerances.turntable_deg, 1e-9)
    lit = np.array([np.zeros(3) if step.aim is None else _direction(step) for step in steps], np.float64)
    return np.column_stack([turned, np.degrees(lit) / max(tolerances.light_deg, 1e-9)])


def _direction(step: Step) -> F64:
    assert step.aim is not None  # noqa: S101  # asked before
    return direction_from_angles(step.aim.azimuth_deg, step.aim.elevation_deg)


def _without(steps: Iterable[Step], gone: Iterable[Step]) -> list[Step]:
    numbers = {step.step for step in gone}
    return [step for step in steps if step.step not in numbers]
