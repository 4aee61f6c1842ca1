"""A light arm of two joints, azimuth and elevation, on the axes X and Y of a GRBL controller."""

import math

from litrig.base.directions import F64, angles_from_direction
from rig.arm.geometry import ZENITH_DEG, ArmGeometry, Joints
from rig.arm.travel import Travel, way_time_s
from rig.arm.zones import Reach
from rig.clock import Clock
from rig.config import ArmConfig
from rig.devices import ArmPose
from rig.errors import DeviceError, OutOfRangeError
from rig.grbl import commands
from rig.grbl.controller import GrblController
from rig.grbl.errors import KeptAlarmError, StillMovingError
from rig.grbl.settings import RATE, SOFT_LIMITS, TRAVEL

GRACE_S = 5.0
TRIES = 3


class GrblArm:
    """Fits `rig.devices.LightArm`."""

    def __init__(self, controller: GrblController, config: ArmConfig, clock: Clock) -> None:
        self._controller, self._config, self._clock = controller, config, clock
        self._geometry, self._reach, self._travel = ArmGeometry.of(config), Reach(config), Travel.of(config)
        self._homed = False

    def home(self) -> None:
        """Clear what is left of an earlier run, look through the settings, then seek the limit switches.

        Raises
        ------
        DeviceError
            The controller's own soft limits are narrower than those of RIG.toml.
        PositionLostError
            A switch was not found.
        """
        self._homed = False
        self._controller.make_ready()
        self._check_soft_limits()
        self._controller.home(self._config.homing_timeout_s)
        self._homed = True

    def check(self, azimuth_deg: float, elevation_deg: float) -> None:
        """Refuse a direction that the arm does not reach, or where it must not stop."""
        self._poses(azimuth_deg, elevation_deg)

    def move_to(self, azimuth_deg: float, elevation_deg: float) -> ArmPose:
        """Bring the lamp to a direction of the view frame, around the zones that it must keep out of.

        Raises
        ------
        OutOfRangeError
            The arm does not reach it, or no way leads there; nothing moved.
        DeviceError, PositionLostError, LinkError
            Not homed, or not any more; the controller refused, is silent, or the arm did not arrive.
        """
        poses = self._poses(azimuth_deg, elevation_deg)
        if not self._is_homed():
            raise DeviceError("light arm: not homed yet; home it first")
        here = self._joints()
        ways = [way for pose in poses if (way := self._reach.route(here, pose, self._travel.time_s)) is not None]
        if not ways:
            raise OutOfRangeError(
                f"light arm: no way leads to azimuth {azimuth_deg:g}°, elevation {elevation_deg:g}° around the zones "
                "of RIG.toml; nothing moved"
            )
        self._follow(min(ways, key=lambda way: way_time_s(here, way, self._travel)), here)
        return self.locate()

    def locate(self) -> ArmPose:
        """Ask the controller where the lamp is."""
        return ArmPose(*angles_from_direction(self._geometry.direction(self._joints())))

    def lamp_position_mm(self) -> F64:
        """Ask where the lamp is (3,), view frame, from the sample's middle; needs the radius in RIG.toml."""
        return self._geometry.lamp_position_mm(self._joints())

    def stop(self) -> None:
        """Brake, keep the position; stopped while homing, it has none."""
        self._controller.halt()
        self._homed = self._is_homed() and self._controller.status().state == "Idle"

    def close(self) -> None:
        """Give the port back."""
        self._controller.close()

    def _is_homed(self) -> bool:
        return self._homed and self._controller.homed

    def _follow(self, way: list[Joints], here: Joints) -> None:
        """Drive along a way, and look whether the arm arrived; a line that was damaged on the wire is said again."""
        needed_s = way_time_s(here, way, self._travel)
        patience_s = 2 * self._slowness() * needed_s + GRACE_S
        for left in reversed(range(TRIES)):
            try:
                for place in way:
                    x, y = self._axes(place)
                    self._controller.command(commands.Move({"X": x, "Y": y}, self._config.speed_deg_s))
                self._controller.finish_motion(patience_s)
            except (KeptAlarmError, StillMovingError):  # the goal lies inside and is near: the line was damaged
                self._controller.halt()
                if not left or self._config.zones:
                    raise
                continue
            found = self._joints()
            off_deg = max(abs(a - b) for a, b in zip(found, way[-1], strict=True))
            if off_deg <= self._config.tolerance_deg:
                return
            if not left or self._config.zones:  # from a wrong place the way is another one
                goal, stands = self._axes(way[-1]), self._axes(found)
                raise DeviceError(
                    f"light arm: told to go to X{goal[0]:.2f} Y{goal[1]:.2f}, stands at X{stands[0]:.2f} "
                    f"Y{stands[1]:.2f}; look what blocks it, then home it"
                )

    def _slowness(self) -> float:
        """How much slower than RIG.toml says the controller lets the axes turn."""
        rates = [self._controller.settings().get(RATE + axis, math.inf) for axis in range(2)]
        return max(1.0, 60 * self._config.speed_deg_s / max(min(rates), 1e-3))

    def _check_soft_limits(self) -> None:
        """Compare the range of RIG.toml with the travel that the controller allows, which an alarm would end."""
        settings, config = self._controller.settings(), self._config
        if not settings.get(SOFT_LIMITS):
            return
        corners = (
            Joints(config.min_azimuth_deg, config.min_elevation_deg),
            Joints(config.max_azimuth_deg, config.max_elevation_deg),
        )
        for axis, places in enumerate(zip(*(self._axes(corner) for corner in corners), strict=True)):
            travel = settings.get(TRAVEL + axis, math.inf)
            if not (-travel - 1e-3 <= min(places) and max(places) <= 1e-3):
                raise DeviceError(
                    f"{self._controller.name}: RIG.toml lets axis {'XY'[axis]} go {min(places):g}..{max(places):g}, "
                    f"the controller's soft limits only {-travel:g}..0 (${TRAVEL + axis}); mend one of them"
                )

    def _poses(self, azimuth_deg: float, elevation_deg: float) -> list[Joints]:
        """Return the joints for a direction, in every turn of the cables that the arm may take."""
        config = self._config
        if not (math.isfinite(azimuth_deg) and -90 <= elevation_deg <= 90):
            raise OutOfRangeError(
                f"light arm: azimuth {azimuth_deg:g}°, elevation {elevation_deg:g}° is no direction; nothing moved. "
                "Give an elevation between -90° and 90°"
            )
        joints = self._geometry.joints(azimuth_deg, elevation_deg)
        if joints.elevation_deg > ZENITH_DEG:
            joints = Joints(config.min_azimuth_deg, joints.elevation_deg)
        poses = self._reach.poses(joints)
        if not poses:
            zone = self._reach.zone_at(joints)
            where = f"in the zone {zone!r}" if zone else "outside its reach"
            raise OutOfRangeError(
                f"light arm: azimuth {azimuth_deg:g}°, elevation {elevation_deg:g}° is {where} (azimuth "
                f"{config.min_azimuth_deg:g}..{config.max_azimuth_deg:g}°, elevation {config.min_elevation_deg:g}.."
                f"{config.max_elevation_deg:g}°); nothing moved. Ask for a direction inside, or widen the limits in "
                "RIG.toml"
            )
        return poses

    def _joints(self) -> Joints:
        x, y, *_ = self._controller.position()
        config = self._config
        return Joints((x - config.azimuth_origin_deg) * config.azimuth_direction, y - config.elevation_origin_deg)

    def _axes(self, joints: Joints) -> tuple[float, float]:
        config = self._config
        x = config.azimuth_origin_deg + config.azimuth_direction * joints.azimuth_deg
        return x, config.elevation_origin_deg + joints.elevation_deg
