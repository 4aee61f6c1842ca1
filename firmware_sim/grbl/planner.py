"""Straight moves in a queue, and where the arm really is.

The true position is that of the arm; the controller only counts steps from an origin that it learned by homing. Every
block starts and ends at rest: a light arm that stops for each exposure never blends two moves.
"""

import math
from collections import deque
from dataclasses import dataclass, replace

from firmware_sim.grbl.gcode import Move
from firmware_sim.grbl.overrides import Overrides
from firmware_sim.grbl.settings import ACCELERATION, RATE, STEPS, Settings, of_axes
from firmware_sim.motion import Piece, Profile, Track, Vector, along, rest, stopping, trapezoid

SLIP_S = 0.02
"""A motor that is stopped at full speed slides on for about this long, and its steps are lost."""


@dataclass(frozen=True)
class Block:
    """A planned move in machine coordinates: from, direction of length 1, length, and the limits along it."""

    origin: Vector
    direction: Vector
    length: float
    profile: Profile
    rate: float
    """The speed that no override exceeds, units a second."""
    rapid: bool


def plan_block(start: Vector, move: Move, settings: Settings) -> Block | None:
    """Limit speed and acceleration so that no axis exceeds its own; None if the move is shorter than a step."""
    target = on_steps(move.target, settings)
    way = tuple(b - a for a, b in zip(start, target, strict=True))
    length = math.hypot(*way)
    if length < 1e-9:
        return None
    direction = tuple(d / length for d in way)
    rate = _along(direction, of_axes(settings, RATE))
    speed = rate if move.feed is None else move.feed
    profile = Profile(speed / 60, _along(direction, of_axes(settings, ACCELERATION)))
    return Block(start, direction, length, profile, rate / 60, move.feed is None)


def on_steps(position: Vector, settings: Settings) -> Vector:
    """Round a position to the nearest motor steps, the only places where the arm can rest."""
    steps = of_axes(settings, STEPS)
    return tuple(round(p * s) / s for p, s in zip(position, steps, strict=True))


def _along(direction: Vector, limits: tuple[float, ...]) -> float:
    return min(limit / abs(d) for d, limit in zip(direction, limits, strict=True) if abs(d) > 1e-12)


class Planner:
    """The queue, the running block, and the track of the arm."""

    def __init__(self, true_position: Vector, now_s: float, overrides: Overrides, blocks: int = 15) -> None:
        self.track = Track(true_position, now_s)
        self.origin = true_position  # the controller counts from wherever it was switched on
        self._queue: deque[Block] = deque()
        self._running: Block | None = None
        self._stopping = False
        self._overrides, self._blocks = overrides, blocks
        self.end = (0.0,) * len(true_position)
        """Machine coordinates where the last planned block ends."""

    @property
    def is_empty(self) -> bool:
        return self._running is None and not self._queue

    @property
    def free_blocks(self) -> int:
        return self._blocks - len(self._queue) - (self._running is not None)

    def position(self, time_s: float) -> Vector:
        """Machine coordinates, as the controller counts them."""
        return tuple(p - o for p, o in zip(self.track.position(time_s), self.origin, strict=True))

    def speed(self, time_s: float) -> float:
        return math.hypot(*self.track.velocity(time_s))

    def is_moving(self, time_s: float) -> bool:
        return not self.track.is_resting(time_s)

    def due_s(self, now_s: float) -> float | None:
        """When the running block ends, or the brake has brought it to rest; None if nothing is to come."""
        return self.track.ends_s if self._running is not None and self.track.ends_s > now_s else None

    def add(self, block: Block, now_s: float) -> None:
        self._queue.append(block)
        self.end = tuple(o + block.length * d for o, d in zip(block.origin, block.direction, strict=True))
        if self._running is None:
            self._start_next(now_s)

    def advance(self, now_s: float) -> None:
        """Finish what has ended by now, and begin what follows at the very time."""
        while self._running is not None and not self._stopping and self.track.ends_s <= now_s:
            ended_s = self.track.ends_s
            self._running = None
            if self._queue:
                self._start_next(ended_s)

    def brake(self, now_s: float) -> None:
        """Come to rest on the path; `resume` goes on from there."""
        if self._running is None or self._stopping:
            return
        self._stopping = True
        block, covered = self._running, self._covered(now_s)
        pieces = stopping(now_s, covered, self.speed(now_s), block.profile.acceleration)
        self._follow(pieces, block)

    def resume(self, now_s: float) -> None:
        self._stopping = False
        if self._running is not None:
            block = self._running
            self._follow(trapezoid(now_s, self._covered(now_s), 0.0, block.length, self._profile(block)), block)

    def replan(self, now_s: float) -> None:
        """Take up new overrides in the middle of a block."""
        block = self._running
        if block is not None and not self._stopping:
            covered, speed = self._covered(now_s), self.speed(now_s)
            self._follow(trapezoid(now_s, covered, speed, block.length, self._profile(block)), block)

    def flush(self, now_s: float) -> None:
        """Forget all that is planned; the arm already rests."""
        self._queue.clear()
        self._running, self._stopping = None, False
        self.end = self.position(now_s)

    def kill(self, now_s: float) -> None:
        """Stop the motors at once. What moved slides on, and the count is wrong from then on."""
        velocity = self.track.velocity(now_s)
        place = self.track.position(now_s)
        slid = tuple(v * SLIP_S for v in velocity)
        self.track.follow([rest(now_s, tuple(p + s for p, s in zip(place, slid, strict=True)))])
        self.origin = tuple(o + s for o, s in zip(self.origin, slid, strict=True))
        self.flush(now_s)

    def lose_steps(self, lost: Vector, now_s: float) -> None:
        """Let the arm be where it did not come to: behind by `lost`, while the controller counts on."""
        pieces = self.track.pieces_from(now_s)
        here = Piece(now_s, self.track.position(now_s), self.track.velocity(now_s), self.track.acceleration(now_s))
        remaining = [here, *(piece for piece in pieces if piece.start_s > now_s)]
        self.track.follow(
            [replace(p, position=tuple(a - b for a, b in zip(p.position, lost, strict=True))) for p in remaining]
        )
        self.origin = tuple(o - b for o, b in zip(self.origin, lost, strict=True))

    def set_position(self, position: Vector, now_s: float) -> None:
        """Count from now on as if the arm stood at `position`."""
        self.origin = tuple(p - m for p, m in zip(self.track.position(now_s), position, strict=True))
        self.end = position

    def _start_next(self, now_s: float) -> None:
        block = self._running = self._queue.popleft()
        self._follow(trapezoid(now_s, 0.0, 0.0, block.length, self._profile(block)), block)

    def _profile(self, block: Block) -> Profile:
        """Scale a block's speed; no override lifts it above what the axes can."""
        percent = self._overrides.rapid if block.rapid else self._overrides.feed
        return Profile(min(block.profile.speed * percent / 100, block.rate), block.profile.acceleration)

    def _covered(self, now_s: float) -> float:
        block = self._running
        if block is None:
            return 0.0
        here = self.position(now_s)
        return sum((h - o) * d for h, o, d in zip(here, block.origin, block.direction, strict=True))

    def _follow(self, pieces: list[Piece], block: Block) -> None:
        true_origin = tuple(b + o for b, o in zip(block.origin, self.origin, strict=True))
        self.track.follow(along(pieces, true_origin, block.direction))
