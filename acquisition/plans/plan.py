"""Plans: poses, what is shot at each, and references around them. Frozen data that knows its length."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

from acquisition.plans.limits import MOST_STEPS, check_range
from acquisition.plans.poses import Pose, PoseSequence
from acquisition.plans.shooting import ONE_FRAME, Attendant, Exposures, Reference
from acquisition.plans.step import Aim, Step
from litrig.base.capture_folder.capture import Role
from litrig.base.errors import InputError

START_ORDER = (Role.DARK, Role.WHITE, Role.CHART, Role.BALL)
"""Of references before the frames; behind them the other way round, so that what stands there is changed least."""


class Shot(NamedTuple):
    """What makes frames alike."""

    role: Role
    angle_deg: float | None
    aim: Aim | None
    exposure_ev: float
    lit: bool = True


@dataclass(frozen=True)
class Plan:
    """A finite sequence of steps, numbered from 0; iterating it twice gives the same.

    Attributes
    ----------
    poses : the angles and lights
    exposures : what is shot at each pose; a closure is one frame, alike the very first
    references : white, dark, ball and chart frames around them, each role once at most
    revisit_every : after so many poses the first one is shot again, as a closure that shows drift; None for never
    """

    poses: PoseSequence
    exposures: Exposures = ONE_FRAME
    references: tuple[Reference, ...] = ()
    revisit_every: int | None = None

    def __post_init__(self) -> None:
        """Refuse a role twice, and more steps than anybody shoots."""
        roles = [reference.role for reference in self.references]
        if len(set(roles)) < len(roles):
            raise InputError("references: a role stands there twice; keep one of each")
        if self.revisit_every is not None:
            check_range("revisit_every", self.revisit_every, 1, MOST_STEPS)
        if self._length > MOST_STEPS:
            raise InputError(
                f"the plan has {self._length:,} steps, more than {MOST_STEPS:,}; lower slices, lights, bracket_ev or "
                "average"
            )

    @property
    def kind(self) -> str:
        """Name the kind of session."""
        return self.poses.kind

    def __len__(self) -> int:
        """Return the number of steps."""
        return self._length

    def __iter__(self) -> Iterator[Step]:
        """Go through the steps."""
        attendant = Attendant(self.references)
        alike: Counter[Shot] = Counter()
        for number, shot in enumerate(self._shots()):
            role, angle_deg, aim, exposure_ev, lit = shot
            ask = attendant.before(role)
            yield Step(number, role, angle_deg, aim, exposure_ev, alike[shot], lit, ask)
            alike[shot] += 1

    def parameters(self) -> Mapping[str, Any]:
        """Return what the plan was made from, as session.toml has it."""
        made_from = {"kind": self.kind, **self.poses.parameters()}
        if self.exposures != ONE_FRAME:
            made_from |= {**asdict(self.exposures), "bracket_ev": list(self.exposures.bracket_ev)}
        if self.revisit_every is not None:
            made_from["revisit_every"] = self.revisit_every
        return {**made_from, **{reference.role.value: reference.parameters() for reference in self.references}}

    @property
    def _length(self) -> int:
        closures = self._closures
        poses = len(self.poses) - closures
        revisits = 0 if self.revisit_every is None else poses // self.revisit_every
        around = sum(reference.times * self._reference_length(reference) for reference in self.references)
        return poses * len(self.exposures) + closures + revisits + around

    @property
    def _closures(self) -> int:
        return int(self.poses.turn is not None and self.poses.turn.closure)

    def _shots(self) -> Iterator[Shot]:
        ordered = sorted(self.references, key=lambda reference: START_ORDER.index(reference.role))
        for reference in ordered:
            if reference.when != "end":
                yield from self._reference_shots(reference)
        yield from self._pose_shots()
        for reference in reversed(ordered):
            if reference.when != "start":
                yield from self._reference_shots(reference)

    def _pose_shots(self) -> Iterator[Shot]:
        first: Pose | None = None
        seen = 0
        for pose in self.poses:
            if pose.role is Role.CLOSURE:
                yield Shot(*pose, self.exposures.bracket_ev[0])
                continue
            first, seen = first or pose, seen + 1
            for exposure_ev in self.exposures.bracket_ev:
                yield from [Shot(*pose, exposure_ev)] * self.exposures.average
            if self.revisit_every is not None and seen % self.revisit_every == 0:
                yield Shot(*first._replace(role=Role.CLOSURE), self.exposures.bracket_ev[0])

    def _reference_shots(self, reference: Reference) -> Iterator[Shot]:
        angle_deg = None if self.poses.turn is None else self.poses.turn.start_deg
        for aim in self._reference_aims(reference):
            for exposure_ev in self._reference_ev(reference):
                lit = reference.role is not Role.DARK
                shot = Shot(reference.role, angle_deg if lit else None, aim, exposure_ev, lit)
                yield from [shot] * reference.frames

    def _reference_length(self, reference: Reference) -> int:
        return len(self._reference_aims(reference)) * len(self._reference_ev(reference)) * reference.frames

    def _reference_ev(self, reference: Reference) -> Sequence[float]:
        return self.exposures.bracket_ev if reference.bracket else (self.exposures.middle_ev,)

    def _reference_aims(self, reference: Reference) -> Sequence[Aim | None]:
        """Return the lights of a reference; one light is the highest, which shadows least."""
        aims = self.poses.aims
        if not aims or reference.role is Role.DARK:
            return (None,)
        if reference.role is Role.CHART or reference.under == "one-light":
            return (max(aims, key=lambda aim: aim.elevation_deg),)
        return aims
