"""Where a motor is, at any time of the last few seconds.

A motion is a list of pieces of constant acceleration. The firmware looks at the present; the camera asks for instants
of an exposure that has just ended, so what is over is kept for a while.
"""

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass

Vector = tuple[float, ...]

MEMORY_S = 10.0
"""How long a track remembers; longer than the longest exposure."""


@dataclass(frozen=True)
class Piece:
    """Motion under constant acceleration, from `start_s` until the next piece begins."""

    start_s: float
    position: Vector
    velocity: Vector
    acceleration: Vector

    def position_at(self, time_s: float) -> Vector:
        dt = time_s - self.start_s
        return tuple(
            p + v * dt + a * dt * dt / 2
            for p, v, a in zip(self.position, self.velocity, self.acceleration, strict=True)
        )

    def velocity_at(self, time_s: float) -> Vector:
        dt = time_s - self.start_s
        return tuple(v + a * dt for v, a in zip(self.velocity, self.acceleration, strict=True))


def rest(start_s: float, position: Vector) -> Piece:
    """Make a piece that stays where it is."""
    still = (0.0,) * len(position)
    return Piece(start_s, position, still, still)


class Track:
    """The pieces of a motor, the past ones included. The last one is a rest, and it rested before the first too."""

    def __init__(self, position: Vector, start_s: float) -> None:
        self._pieces = [rest(start_s, position)]

    @property
    def ends_s(self) -> float:
        """When the last piece begins: the motor rests from then on."""
        return self._pieces[-1].start_s

    def follow(self, pieces: Sequence[Piece]) -> None:
        """Drop what was planned for after the first of `pieces`, and go on with these."""
        start_s = pieces[0].start_s
        kept = [piece for piece in self._pieces if piece.start_s < start_s]
        recent = bisect_right([piece.start_s for piece in kept], start_s - MEMORY_S)
        self._pieces = [*kept[max(0, recent - 1) :], *pieces]

    def pieces_from(self, time_s: float) -> list[Piece]:
        """Return the pieces that begin at that time or later."""
        return [piece for piece in self._pieces if piece.start_s >= time_s]

    def halt(self, time_s: float) -> None:
        """Stand still at once, where the motor is."""
        self.follow([rest(time_s, self.position(time_s))])

    def position(self, time_s: float) -> Vector:
        piece = self._piece(time_s)
        return piece.position_at(max(time_s, piece.start_s))

    def velocity(self, time_s: float) -> Vector:
        piece = self._piece(time_s)
        return piece.velocity_at(max(time_s, piece.start_s))

    def acceleration(self, time_s: float) -> Vector:
        return self._piece(time_s).acceleration

    def is_resting(self, time_s: float) -> bool:
        return time_s >= self.ends_s and not any(self.velocity(time_s))

    def _piece(self, time_s: float) -> Piece:
        after = bisect_right(self._pieces, time_s, key=lambda piece: piece.start_s)
        return self._pieces[max(0, after - 1)]


@dataclass(frozen=True)
class Profile:
    """The limits of a trapezoid: top speed and acceleration, both positive, units a second."""

    speed: float
    acceleration: float


def trapezoid(start_s: float, position: float, velocity: float, goal: float, profile: Profile) -> list[Piece]:
    """Plan a move along a line to a goal, from any speed, and rest there.

    Speed rises to the top speed at most, and falls so that the motor stands on the goal. A motor that is too fast to
    stop in time, or runs the other way, brakes first and comes back.
    """
    way = goal - position
    brake = velocity * abs(velocity) / (2 * profile.acceleration)
    if velocity and (velocity * way <= 0 or abs(brake) > abs(way) + 1e-12):
        braking = stopping(start_s, position, velocity, profile.acceleration)
        turned = braking[-1]
        return braking[:-1] + trapezoid(turned.start_s, turned.position[0], 0.0, goal, profile)
    return _forward(start_s, position, velocity, goal, profile)


def _forward(start_s: float, position: float, velocity: float, goal: float, profile: Profile) -> list[Piece]:
    way = abs(goal - position)
    sign = math.copysign(1.0, goal - position)
    v0 = abs(velocity)
    a = profile.acceleration
    # The speed where rising and falling meet, if the top speed did not come first.
    meeting = math.sqrt(max(0.0, a * way + v0 * v0 / 2))
    top = min(profile.speed, meeting) if v0 <= profile.speed else profile.speed
    rise_s, fall_s = abs(top - v0) / a, top / a
    covered = (v0 + top) / 2 * rise_s + top * fall_s / 2
    cruise_s = max(0.0, way - covered) / top if top else 0.0
    pieces: list[Piece] = []
    now_s, at, speed = start_s, position, v0
    for length_s, rate in ((rise_s, math.copysign(a, top - v0)), (cruise_s, 0.0), (fall_s, -a)):
        if length_s > 0:
            pieces.append(Piece(now_s, (at,), (sign * speed,), (sign * rate,)))
            at += sign * (speed * length_s + rate * length_s * length_s / 2)
            speed += rate * length_s
            now_s += length_s
    return [*pieces, rest(now_s, (goal,))]


def stopping(start_s: float, position: float, velocity: float, acceleration: float) -> list[Piece]:
    """Brake along a line, and rest."""
    if not velocity:
        return [rest(start_s, (position,))]
    length_s = abs(velocity) / acceleration
    braking = Piece(start_s, (position,), (velocity,), (-math.copysign(acceleration, velocity),))
    return [braking, rest(start_s + length_s, braking.position_at(start_s + length_s))]


def along(pieces: Sequence[Piece], origin: Vector, direction: Vector) -> list[Piece]:
    """Lift motion along a line, counted in path length from `origin`, into space. `direction` has length 1."""

    def lift(value: float, base: Vector) -> Vector:
        return tuple(b + value * d for b, d in zip(base, direction, strict=True))

    zero = (0.0,) * len(origin)
    return [
        Piece(
            piece.start_s,
            lift(piece.position[0], origin),
            lift(piece.velocity[0], zero),
            lift(piece.acceleration[0], zero),
        )
        for piece in pieces
    ]


def merge(axes: Sequence[Sequence[Piece]]) -> list[Piece]:
    """Join the motions of several axes, each planned for itself, into one in space."""
    tracks = [Track(pieces[0].position, pieces[0].start_s) for pieces in axes]
    for track, pieces in zip(tracks, axes, strict=True):
        track.follow(pieces)
    starts_s = sorted({piece.start_s for pieces in axes for piece in pieces})
    return [
        Piece(
            start_s,
            tuple(track.position(start_s)[0] for track in tracks),
            tuple(track.velocity(start_s)[0] for track in tracks),
            tuple(track.acceleration(start_s)[0] for track in tracks),
        )
        for start_s in starts_s
    ]
