"""The homing cycle: run to the limit switches, back off, touch them again slowly, back off, count from there."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from firmware_sim.grbl.errors import Alarm
from firmware_sim.grbl.settings import (
    ACCELERATION,
    AXES,
    HOMING_DEBOUNCE_MS,
    HOMING_DIRECTIONS,
    HOMING_FEED,
    HOMING_PULL_OFF,
    HOMING_SEEK,
    TRAVEL,
    Settings,
    axis_count,
    homing_groups,
    of_axes,
)
from firmware_sim.motion import Piece, Profile, Track, Vector, merge, rest, trapezoid

SEARCH_FACTOR, LOCATE_FACTOR = 1.5, 5.0
"""How far to look for a switch: in travels at first, in pull-offs the second time."""
HARD_STOP = 2.0
"""How far behind its switch an axis runs into the frame."""

Groups = Sequence[tuple[int, ...]]

SwitchFault = Literal["none", "stuck", "dead"]
"""A stuck switch reads pressed wherever the arm is; a dead one never does."""


@dataclass(frozen=True)
class Homing:
    """What a homing cycle will do: the motion, and how it ends. `alarm` None means that it finds its place."""

    pieces: list[Piece]
    ends_s: float
    alarm: Alarm | None


def switch_positions(settings: Settings) -> Vector:
    """Return where the switches stand on an arm that is mounted as the settings say."""
    lengths = of_axes(settings, TRAVEL)
    return tuple(-length if _is_reversed(settings, axis) else 0.0 for axis, length in enumerate(lengths))


def homed_position(settings: Settings, before: Vector, groups: Groups) -> Vector:
    """Machine coordinates after homing: a pull-off away from the switches, which stand at the end of the travel.

    Axes that do not home keep theirs.
    """
    pull_off = settings[HOMING_PULL_OFF]
    homed = {axis for group in groups for axis in group}
    lengths = of_axes(settings, TRAVEL)
    ends = (pull_off - length if _is_reversed(settings, axis) else -pull_off for axis, length in enumerate(lengths))
    return tuple(end if axis in homed else place for axis, (end, place) in enumerate(zip(ends, before, strict=True)))


def plan_homing(
    start_s: float,
    position: Vector,
    settings: Settings,
    switches: Vector,
    fault: SwitchFault,
    groups: Groups | None = None,
) -> Homing:
    """Plan the whole cycle: Z first, then X and Y together, unless settings say otherwise.

    Parameters
    ----------
    start_s : when the motion begins
    position : (N,) where the arm truly stands
    switches : (N,) where the switches truly are, in the same coordinates
    fault : what is wrong with the switches
    groups : axes that home together, group after group; by default those of the settings
    """
    track = Track(position, start_s)
    now_s = start_s
    for axes in homing_groups(settings) if groups is None else groups:
        for approach, search in _passes(settings, axes):
            stage = _Stage(settings, switches, fault, axes, approach=approach, search=search)
            pieces, now_s, found = stage.plan(now_s, track.position(now_s))
            track.follow(pieces)
            alarm = None if found else (Alarm.HOMING_APPROACH if approach else Alarm.HOMING_PULL_OFF)
            if alarm is not None:
                return Homing(track.pieces_from(start_s), now_s, alarm)
            now_s += settings[HOMING_DEBOUNCE_MS] / 1000
    return Homing(track.pieces_from(start_s), now_s, None)


def pressed(position: Vector, settings: Settings, switches: Vector, fault: SwitchFault) -> str:
    """Return the letters of the axes whose switches read pressed, as the field Pn shows them.

    An axis without travel, which turns for ever, has no switch.
    """
    axes = AXES[: axis_count(settings)]
    if fault != "none":
        return axes if fault == "stuck" else ""
    return "".join(
        axis
        for place, axis in enumerate(axes)
        if settings[TRAVEL + place] and _sign(settings, place) * (position[place] - switches[place]) >= -1e-9
    )


def _passes(settings: Settings, axes: tuple[int, ...]) -> list[tuple[bool, float]]:
    pull_off = settings[HOMING_PULL_OFF]
    search = SEARCH_FACTOR * max(settings[TRAVEL + axis] for axis in axes)
    return [(True, search), (False, pull_off), (True, LOCATE_FACTOR * pull_off), (False, pull_off)]


def _is_reversed(settings: Settings, axis: int) -> bool:
    return bool(int(settings[HOMING_DIRECTIONS]) >> axis & 1)


def _sign(settings: Settings, axis: int) -> int:
    return -1 if _is_reversed(settings, axis) else 1


@dataclass(frozen=True)
class _Stage:
    """One run to the switches or away from them, of one or two axes at once."""

    settings: Settings
    switches: Vector
    fault: SwitchFault
    axes: tuple[int, ...]
    approach: bool
    search: float

    def plan(self, start_s: float, position: Vector) -> tuple[list[Piece], float, bool]:
        """Return the motion, when it is over, and whether all switches read as they should then."""
        motions = [self._axis(start_s, axis, place) for axis, place in enumerate(position)]
        ends_s = max(motion[-1].start_s for motion, _ in motions)
        return merge([motion for motion, _ in motions]), ends_s, all(found for _, found in motions)

    def _axis(self, start_s: float, axis: int, place: float) -> tuple[list[Piece], bool]:
        if axis not in self.axes:
            return [rest(start_s, (place,))], True
        sign = _sign(self.settings, axis)
        if not self.approach:
            goal = place - sign * self.search
            is_clear = sign * (goal - self.switches[axis]) < 0 or self.fault == "dead"
            return trapezoid(start_s, place, 0.0, goal, self._profile(axis)), is_clear and self.fault != "stuck"
        if self.fault == "stuck":
            return [rest(start_s, (place,))], True
        run = trapezoid(start_s, place, 0.0, place + sign * self.search, self._profile(axis))
        to_switch = sign * (self.switches[axis] - place)
        if self.fault == "dead" or to_switch > self.search:
            stopped = _stopped_at(run, sign, self.switches[axis] + sign * HARD_STOP)
            # The steps go on against the frame until the search is over.
            return [*stopped, rest(run[-1].start_s, stopped[-1].position)], False
        return _stopped_at(run, sign, self.switches[axis]), True

    def _profile(self, axis: int) -> Profile:
        locating = self.approach and self.search == LOCATE_FACTOR * self.settings[HOMING_PULL_OFF]
        rate = self.settings[HOMING_FEED if locating else HOMING_SEEK]
        return Profile(rate / 60, self.settings[ACCELERATION + axis])


def _stopped_at(run: list[Piece], sign: int, place: float) -> list[Piece]:
    """Cut a motion short where it reaches a place, and stand there."""
    if sign * (place - run[0].position[0]) <= 0:
        return [rest(run[0].start_s, run[0].position)]
    for number, piece in enumerate(run[:-1]):
        way = sign * (place - piece.position[0])
        reached_s = piece.start_s + _time_to_cover(way, sign * piece.velocity[0], sign * piece.acceleration[0])
        if reached_s <= run[number + 1].start_s:
            return [*run[: number + 1], rest(reached_s, (place,))]
    return run


def _time_to_cover(way: float, speed: float, rate: float) -> float:
    if abs(rate) < 1e-12:
        return way / speed if speed > 0 else math.inf
    root = speed * speed + 2 * rate * way
    return (math.sqrt(root) - speed) / rate if root >= 0 else math.inf
