"""How long turntable and arm take from pose to pose, as their drivers move them."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

from acquisition.plans import Aim
from rig.arm.geometry import ZENITH_DEG, ArmGeometry, Joints
from rig.arm.travel import Travel, way_time_s
from rig.arm.zones import Reach
from rig.config import ArmConfig, TurntableConfig
from rig.dynamixel.registers import profile_time_s
from rig.errors import OutOfRangeError
from rig.grbl.config import StepperTurntableConfig
from rig.sections import TurntableSection

TABLE_ASK_S = 0.017
"""For where it stands, before and after each move (measured on the simulated servo)."""
TABLE_SETTLE_S = 0.021
"""At the end of each approach: three reads that agree, 5 ms apart (measured likewise)."""
STEPPER_SETTLE_S = 0.1
"""The same of a GRBL axis, whose end of motion is a dwell and a report (measured on the simulated arm)."""
STEPPER_ACCELERATION_DEG_S2 = 500.0
"""As RIG.toml has it for the arm; of a table's axis it does not say it, unless among the controller's settings."""
ACCELERATION = 120
"""Number of the first axis' acceleration among these."""
UNKNOWN_SPEED_DEG_S, UNKNOWN_ACCELERATION_DEG_S2 = 30.0, 100.0
"""For turntables of other packages, of whose speed nothing is known: slow ones."""


@dataclass(frozen=True)
class TableMotion:
    """A turntable that approaches every angle from below.

    Attributes
    ----------
    speed_deg_s, acceleration_deg_s2 : of its trapezoid of speed
    backlash_deg : by how much it runs up
    lowest_deg : below which it does not run up
    settle_s : at the end of each approach
    assumptions : what of it RIG.toml does not say
    """

    speed_deg_s: float
    acceleration_deg_s2: float
    backlash_deg: float = 0.0
    lowest_deg: float = -math.inf
    settle_s: float = TABLE_SETTLE_S
    assumptions: tuple[str, ...] = ()

    @classmethod
    def of(cls, config: TurntableSection) -> Self:
        """Take it from RIG.toml."""
        if isinstance(config, TurntableConfig):
            return cls(config.speed_deg_s, config.acceleration_deg_s2, config.backlash_deg)
        if isinstance(config, StepperTurntableConfig):
            setting = ACCELERATION + "XYZABC".index(config.axis)
            acceleration = config.settings.get(setting, STEPPER_ACCELERATION_DEG_S2)
            assumed = () if setting in config.settings else (f"the table's ${setting} is {acceleration:g}",)
            motion = cls(config.speed_deg_s, acceleration, config.backlash_deg, config.min_deg, STEPPER_SETTLE_S)
            return replace(motion, assumptions=assumed)
        assumed = (f"the table turns at {UNKNOWN_SPEED_DEG_S:g}°/s, for its speed is not known",)
        return cls(UNKNOWN_SPEED_DEG_S, UNKNOWN_ACCELERATION_DEG_S2, assumptions=assumed)

    def legs_deg(self, here_deg: float, goal_deg: float) -> tuple[float, ...]:
        """Return the lengths of the straight moves to an angle; a move back costs a run-up."""
        if here_deg == goal_deg:
            return ()
        if here_deg > goal_deg - self.backlash_deg:
            run_up_deg = max(goal_deg - self.backlash_deg, self.lowest_deg)
            return tuple(leg for leg in (here_deg - run_up_deg, goal_deg - run_up_deg) if leg)
        return (goal_deg - here_deg,)

    def time_s(self, legs_deg: Sequence[float]) -> float:
        """Return the time of such moves, without settling."""
        return sum(profile_time_s(leg_deg, self.speed_deg_s, self.acceleration_deg_s2) for leg_deg in legs_deg)

    def settling_s(self, legs_deg: Sequence[float]) -> float:
        """Return the time that passes until it is known to stand."""
        return TABLE_ASK_S + self.settle_s * len(legs_deg)


class ArmMotion:
    """The light arm: straight moves in joint space around its zones, to whichever turn of the azimuth is nearest."""

    def __init__(self, config: ArmConfig) -> None:
        self._config = config
        self._geometry, self._reach, self._travel = ArmGeometry.of(config), Reach(config), Travel.of(config)

    @property
    def park(self) -> Aim:
        """Where it rests."""
        return Aim(self._config.park_azimuth_deg, self._config.park_elevation_deg)

    @property
    def home(self) -> Joints:
        """Where homing leaves it: at the machine's zero, within a degree or two."""
        config = self._config
        return Joints(-config.azimuth_origin_deg * config.azimuth_direction, -config.elevation_origin_deg)

    def places(self, aim: Aim) -> list[Joints]:
        """Return the joints for a light, in every turn of the cables.

        Raises
        ------
        OutOfRangeError
            There are none: it is out of reach, or in a zone.
        """
        config = self._config
        joints = self._geometry.joints(aim.azimuth_deg, aim.elevation_deg)
        if joints.elevation_deg > ZENITH_DEG:
            joints = Joints(config.min_azimuth_deg, joints.elevation_deg)
        places = self._reach.poses(joints)
        if not places:
            zone = self._reach.zone_at(joints)
            where = f"in the zone {zone!r}" if zone else "outside its reach"
            raise OutOfRangeError(
                f"light arm: azimuth {aim.azimuth_deg:g}°, elevation {aim.elevation_deg:g}° is {where} (azimuth "
                f"{config.min_azimuth_deg:g}..{config.max_azimuth_deg:g}°, elevation {config.min_elevation_deg:g}.."
                f"{config.max_elevation_deg:g}°); mend the plan, or widen the limits in RIG.toml"
            )
        return places

    def way(self, here: Joints, aim: Aim) -> list[Joints]:
        """Return the quickest way to a light, without its start.

        Raises
        ------
        OutOfRangeError
            It is out of reach, or no way leads there around the zones.
        """
        ways = [self._reach.route(here, place, self._travel.time_s) for place in self.places(aim)]
        free = [way for way in ways if way is not None]
        if not free:
            raise OutOfRangeError(
                f"light arm: no way leads to azimuth {aim.azimuth_deg:g}°, elevation {aim.elevation_deg:g}° around the "
                "zones of RIG.toml; mend the plan or the zones"
            )
        return min(free, key=lambda way: way_time_s(here, way, self._travel))

    def time_s(self, here: Joints, way: Sequence[Joints]) -> float:
        """Return the time of a way, without settling."""
        return way_time_s(here, way, self._travel)


def length_deg(here: Joints, way: Sequence[Joints]) -> float:
    """Return the length of a way in joint space."""
    return sum(math.dist(a, b) for a, b in itertools.pairwise([here, *way]))
