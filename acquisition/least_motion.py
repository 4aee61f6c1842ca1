"""The order in which the missing steps of a session cost the least motion."""

from collections.abc import Sequence
from itertools import groupby

import numpy as np

from acquisition.plans import Aim, Step
from acquisition.tour import shortest_tour
from litrig.base.capture_folder.capture import Role
from litrig.base.directions import angle_between_deg, direction_from_angles
from rig.arm.travel import travel_times_s
from rig.config import ArmConfig, RigConfig

MOST_TOURED = 400
"""Beyond so many the plan's own order is kept, which is that of a tour already: to find another takes too long."""


def in_order_of_least_motion(steps: Sequence[Step], config: RigConfig) -> list[Step]:
    """Order steps anew wherever their order means nothing: the light directions of one angle.

    Angles rise in a plan already, and what a person has to arrange stays in its place.
    """
    ordered: list[Step] = []
    for _, alike in groupby(steps, lambda step: (step.role, step.angle_deg, bool(step.ask))):
        ordered += _toured(list(alike), config)
    return ordered


def _toured(steps: list[Step], config: RigConfig) -> list[Step]:
    by_aim = [list(same) for _, same in groupby(steps, lambda step: step.aim)]
    aims = [same[0].aim for same in by_aim]
    is_arm = isinstance(config.arm, ArmConfig) and not (config.lights and config.lights.directions_deg)
    places = [aim for aim in aims if aim is not None]
    if not is_arm or steps[0].role is not Role.FRAME or len(places) < len(aims) or not 2 < len(aims) <= MOST_TOURED:
        return steps
    order = shortest_tour(_costs(places, config), 0)
    return [step for index in order for step in by_aim[index]]


def _costs(aims: Sequence[Aim], config: RigConfig) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    angles = [(aim.azimuth_deg, aim.elevation_deg) for aim in aims]
    if isinstance(config.arm, ArmConfig):
        return np.asarray(travel_times_s(config.arm, angles), np.float64)
    directions = [direction_from_angles(*each) for each in angles]
    return np.array([[angle_between_deg(a, b) for b in directions] for a in directions])
