"""PLAN.toml: a session as a person writes it down. Unknown keys are refused."""

from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from acquisition.plans.choose_lights import LightWish, choose_lights
from acquisition.plans.light_path import EVERYWHERE, USEFUL, Order, Sector
from acquisition.plans.limits import FARTHEST_DEG, FARTHEST_EV, MOST_ALIKE, MOST_LIGHTS, MOST_STEPS
from acquisition.plans.plan import Plan
from acquisition.plans.poses import AmcPoses, PoseSequence, ProductPoses, PtmPoses
from acquisition.plans.shooting import COVER_LENS, LONGEST_BRACKET, Exposures, Reference, Under, When
from acquisition.plans.turn import TABLE_SIZE, WHOLE_TURN_DEG, Turn
from litrig.base.capture_folder.capture import Role
from litrig.base.config import StrictModel, read_toml
from litrig.base.errors import ConfigError, InputError
from rig.config import RigConfig

Elevation = Annotated[float, Field(ge=-90, le=90)]
Azimuth = Annotated[float, Field(ge=-360, le=720)]
Stops = Annotated[float, Field(ge=-FARTHEST_EV, le=FARTHEST_EV)]
Task = Annotated[str, Field(max_length=200)]


class TurnSection(StrictModel):
    """How the sample is turned."""

    slices: int = Field(ge=1, le=MOST_STEPS)
    """Angles over the range, S_k; 8 at least for an AMC, for which 2 to 4 times the table's size are ideal."""
    start_deg: float = Field(default=0.0, ge=-FARTHEST_DEG, le=FARTHEST_DEG)
    """Turntable angle of the first slice."""
    range_deg: float = Field(default=WHOLE_TURN_DEG, gt=0, le=WHOLE_TURN_DEG)
    """Over which the slices are spread: 360 leaves out its end, which is its start; less is shot from end to end."""
    repeats: int = Field(default=1, ge=1, le=MOST_ALIKE)
    """How often the same angles are gone through."""
    closure: bool | None = None
    """Whether the first slice is shot again at the end, after a whole turn at start + 360°: the difference shows what
    drifted or slipped. Left out, it is shot after a whole turn."""
    table_size: int = Field(default=TABLE_SIZE, ge=2, le=4096)
    """Side of the AMC table that is to be made, S_i; only for advice on the slices."""

    def turn(self) -> Turn:
        """Return it as plans have it."""
        values = self.model_dump()
        whole = self.range_deg == WHOLE_TURN_DEG
        return Turn(**{**values, "closure": whole if self.closure is None else self.closure})


class RingSection(StrictModel):
    """Lights of one elevation."""

    elevation_deg: Elevation
    """Above the picture's plane."""
    count: int = Field(ge=1, le=MOST_LIGHTS)
    """How many, spread evenly."""


class PlanLightsSection(StrictModel):
    """Where the light comes from: a number of directions, rings, or a file; of a rig with a dome, its lamps there."""

    count: int | None = Field(default=None, ge=1, le=MOST_LIGHTS)
    """How many lights, spread evenly; of a dome or a file as many that lie far apart. Left out, all of these. 6 at
    least for a PTM, for which 40 to 80 are usual."""
    rings: Annotated[tuple[RingSection, ...], Field(max_length=100)] = ()
    """Rings of lights instead; every second one is turned by half a step."""
    file: str | None = None
    """An .lp or .dome file with the directions instead; its path counts from the PLAN.toml's folder."""
    min_elevation_deg: Elevation | None = None
    """Lights below are left out; left out itself, it is 15 where lights are spread evenly."""
    max_elevation_deg: Elevation | None = None
    """Lights above are left out; left out itself, it is 80 where lights are spread evenly."""
    azimuth_deg: tuple[Azimuth, Azimuth] = (0.0, 360.0)
    """From and to, counter-clockwise from the picture's right; lights elsewhere are left out."""
    order: Order = "tour"
    """Of shooting: a tour that keeps the arm's travel short, or as given. A dome's lamps are lit by their numbers."""

    def wish(self, folder: Path, *, has_dome: bool) -> LightWish:
        """Return it as it is chosen by."""
        usual = EVERYWHERE if self.file is not None or has_dome else USEFUL
        low, high = self.min_elevation_deg, self.max_elevation_deg
        sector = Sector(
            usual.min_elevation_deg if low is None else low,
            usual.max_elevation_deg if high is None else high,
            self.azimuth_deg,
        )
        rings = tuple((ring.elevation_deg, ring.count) for ring in self.rings)
        return LightWish(self.count, rings, None if self.file is None else folder / self.file, sector, self.order)

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if self.rings and (self.count is not None or self.file is not None):
            raise ValueError("rings say how many lights there are and where; leave out count and file")
        if self.rings and (self.min_elevation_deg is not None or self.max_elevation_deg is not None):
            raise ValueError("rings have their elevations; leave out min_elevation_deg and max_elevation_deg")
        return self


class ReferenceSection(StrictModel):
    """Frames of something that helps to judge or correct the others."""

    frames: int = Field(default=1, ge=1, le=MOST_ALIKE)
    """How many of each light and exposure."""
    when: When = "start"
    """Before the frames ("start"), after them ("end"), or "both"."""
    bracket: bool = False
    """Whether they are shot with each exposure of bracket_ev, or only with that nearest to the rig's own."""
    ask: Task | None = None
    """What a person is asked to do before; "" for nothing, left out for what is usual."""
    ask_after: Task | None = None
    """What a person is asked to do after."""

    def reference(self, role: Role, dark_asks: tuple[str, str]) -> Reference:
        """Return it as plans have it; `dark_asks` are usual for dark frames."""
        values = self.model_dump()
        if role is Role.DARK and self.ask is None:
            values["ask"] = dark_asks[0]
            values["ask_after"] = dark_asks[1] if self.ask_after is None else self.ask_after
        return Reference(role, **values)


class LitReferenceSection(ReferenceSection):
    """Such frames that depend on where the light comes from."""

    under: Under = "every-light"
    """Under every light, or under the highest one only ("one-light")."""


class PlanFile(StrictModel):
    """A PLAN.toml."""

    kind: Literal["amc", "ptm", "product"]
    """amc: the sample turns, lights are left alone. ptm: one light after the other, the turntable is left alone.
    product: every slice under every light."""
    bracket_ev: Annotated[tuple[Stops, ...], Field(min_length=1, max_length=LONGEST_BRACKET)] = (0.0,)
    """Exposures at each pose, in stops above the rig's own exposure_ms."""
    average: int = Field(default=1, ge=1, le=MOST_ALIKE)
    """Frames of each exposure."""
    revisit_every: int | None = Field(default=None, ge=1, le=MOST_STEPS)
    """After so many poses the first one is shot again, to show drift; left out for never."""
    turn: TurnSection | None = None
    """How the sample is turned; of amc and product."""
    lights: PlanLightsSection | None = None
    """Where the light comes from; of ptm and product."""
    white: LitReferenceSection | None = None
    """A white card in place of the sample."""
    dark: ReferenceSection | None = None
    """No light at all."""
    ball: LitReferenceSection | None = None
    """A mirror ball in place of the sample."""
    chart: ReferenceSection | None = None
    """A colour chart in place of the sample, under the highest light."""

    def plan(self, folder: Path, config: RigConfig | None) -> Plan:
        """Make the plan.

        Parameters
        ----------
        folder : that paths count from
        config : the rig, if it is known
        """
        sections = {Role.WHITE: self.white, Role.DARK: self.dark, Role.BALL: self.ball, Role.CHART: self.chart}
        dark_asks = ("", "") if self._switches_lamps(config) else COVER_LENS
        references = tuple(
            section.reference(role, dark_asks) for role, section in sections.items() if section is not None
        )
        exposures = Exposures(self.bracket_ev, self.average)
        return Plan(self._poses(folder, config), exposures, references, self.revisit_every)

    def _poses(self, folder: Path, config: RigConfig | None) -> PoseSequence:
        has_dome = config is not None and config.lights is not None and bool(config.lights.directions_deg)
        lights = None if self.lights is None else choose_lights(self.lights.wish(folder, has_dome=has_dome), config)
        turn = None if self.turn is None else self.turn.turn()
        if turn is not None:
            return AmcPoses(turn) if lights is None else ProductPoses(turn, lights)
        if lights is not None:
            return PtmPoses(lights)
        raise ConfigError("neither [turn] nor [lights]")  # pydantic has refused it before

    def _switches_lamps(self, config: RigConfig | None) -> bool:
        """Whether dark frames need nobody: all light comes from lamps that the rig switches, as far as is known."""
        if self.lights is None:
            return False
        return config is None or (config.lights is not None and config.lights.switchable)

    @model_validator(mode="after")
    def _sections_of_its_kind(self) -> Self:
        wanted = {"amc": (True, False), "ptm": (False, True), "product": (True, True)}[self.kind]
        for name, section, want in zip(("turn", "lights"), (self.turn, self.lights), wanted, strict=True):
            if want and section is None:
                raise ValueError(f"a plan of kind {self.kind} needs [{name}]; add it")
            if not want and section is not None:
                raise ValueError(f"a plan of kind {self.kind} leaves [{name}] alone; remove it, or use kind product")
        return self


def read_plan(path: Path, config: RigConfig | None = None) -> Plan:
    """Read a PLAN.toml.

    Parameters
    ----------
    config : the rig that it is for, whose dome's lamps are taken and whose arm's travel counts; None if not known

    Raises
    ------
    InputError, ConfigError
        The file is missing, or a key is unknown, missing or out of range; the message names it. So if it is a file of
        lights that is missing or damaged.
    """
    file = read_toml(path, PlanFile)
    try:
        return file.plan(path.parent, config)
    except InputError as error:
        raise ConfigError(f"{path}: {error}") from error
