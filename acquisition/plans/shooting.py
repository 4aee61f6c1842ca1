"""What is shot at a pose, and around all of them: brackets, averages, references, and what a person does for these."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal

from acquisition.plans.limits import FARTHEST_EV, MOST_ALIKE, check_range
from litrig.base.capture_folder.capture import Role
from litrig.base.errors import InputError

When = Literal["start", "end", "both"]
Under = Literal["every-light", "one-light"]

LONGEST_BRACKET = 15
SAMPLE_BACK = "Put the sample back as it stood"
ASKS = {
    Role.WHITE: ("Put the white card in place of the sample", SAMPLE_BACK),
    Role.BALL: ("Put the mirror ball in place of the sample", SAMPLE_BACK),
    Role.CHART: ("Put the colour chart in place of the sample", SAMPLE_BACK),
    Role.DARK: ("", "Let the light in again"),
}
"""What a person does before the first frame of a reference, and after its last."""
COVER_LENS = ("Cover the lens, or switch all lamps off", "Uncover the lens, or switch the lamps on again")
"""The same for dark frames under lamps that the rig does not switch."""


@dataclass(frozen=True)
class Exposures:
    """The frames that are shot at one pose.

    Attributes
    ----------
    bracket_ev : stops above the rig's own exposure time, one exposure each, in this order
    average : frames of each exposure
    """

    bracket_ev: tuple[float, ...] = (0.0,)
    average: int = 1

    def __post_init__(self) -> None:
        """Refuse none, the same twice, and what no camera can do."""
        check_range("bracket_ev", len(self.bracket_ev), 1, LONGEST_BRACKET, "its number of exposures")
        for exposure_ev in self.bracket_ev:
            check_range("bracket_ev", exposure_ev, -FARTHEST_EV, FARTHEST_EV)
        if len(set(self.bracket_ev)) < len(self.bracket_ev):
            raise InputError("bracket_ev: has an exposure twice; for several frames of one raise average")
        check_range("average", self.average, 1, MOST_ALIKE)

    def __len__(self) -> int:
        """Return the number of frames at one pose."""
        return len(self.bracket_ev) * self.average

    @property
    def middle_ev(self) -> float:
        """The exposure nearest to the rig's own."""
        return min(self.bracket_ev, key=abs)


ONE_FRAME = Exposures()


@dataclass(frozen=True)
class Reference:
    """Frames of something that helps to judge or correct the others.

    Attributes
    ----------
    role : white, dark, ball or chart
    frames : of each light and exposure
    when : before the frames, after them, or both
    under : every light, or the highest one; of no meaning where the lights are left alone, for charts (one light) and
        for dark frames (none)
    bracket : whether it is shot with each exposure of the bracket, or only with that nearest to the rig's own
    ask, ask_after : what a person does before and after; empty for nothing, None for what is usual
    """

    role: Role
    frames: int = 1
    when: When = "start"
    under: Under = "every-light"
    bracket: bool = False
    ask: str | None = None
    ask_after: str | None = None

    def __post_init__(self) -> None:
        """Refuse other roles, and absurd numbers."""
        if self.role not in ASKS:
            raise InputError(f"a reference is white, dark, ball or chart, not {self.role}")
        check_range(f"{self.role}.frames", self.frames, 1, MOST_ALIKE)

    @property
    def asks(self) -> tuple[str, str]:
        """What a person does before, and after."""
        before, after = ASKS[self.role]
        before = before if self.ask is None else self.ask
        usual_after = after if before else ""
        return before, usual_after if self.ask_after is None else self.ask_after

    @property
    def times(self) -> int:
        """Return how often it is shot."""
        return 2 if self.when == "both" else 1

    def parameters(self) -> Mapping[str, Any]:
        """Return it as session.toml has it."""
        return {key: value for key, value in asdict(self).items() if value is not None and key != "role"}


class Attendant:
    """Remembers what the person at the rig has put where, and says what is to be done next."""

    def __init__(self, references: Sequence[Reference]) -> None:
        self._asks = {reference.role: reference.asks for reference in references}
        self._stands: Role | None = None
        self._covered = False

    def before(self, role: Role) -> str:
        """Return what is to be done before a frame of a role; empty for nothing."""
        tasks = []
        ask, _ = self._asks.get(role, ("", ""))
        if role is Role.DARK:  # whatever stands there does not matter
            if ask and not self._covered:
                tasks, self._covered = [ask], True
            return "".join(tasks)
        if self._covered:
            tasks, self._covered = [self._asks[Role.DARK][1]], False
        wanted = role if ask else None
        if wanted is not self._stands:
            tasks.append(ask if self._stands is None or wanted is not None else self._asks[self._stands][1])
            self._stands = wanted
        return ". ".join(task for task in tasks if task)
