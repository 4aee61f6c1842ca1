"""A light arm of two joints, azimuth and elevation, on a GRBL controller."""

import math

import numpy as np

from litrig.base.directions import angles_from_direction, direction_from_angles
from rig.clock import Clock
from rig.config import ArmConfig
from rig.devices import ArmPose
from rig.errors import DeviceError, OutOfRangeError
from rig.grbl import codec
from rig.grbl.codec import Axes
from rig.grbl.controller import GrblController

GRACE_S = 5.0
ZENITH_DEG = 89.999


class GrblArm:
    """Fits `rig.devices.LightArm`."""

    def __init__(self, controller: GrblController, config: ArmConfig, clock: Clock) -> None:
        self._controller, self._config, self._clock = controller, config, clock
        self._view_from_arm = np.array(config.view_from_arm)
        self._homed = False

    def home(self) -> None:
        """Clear what is left of an earlier run, then seek the limit switches.

        Raises
        ------
        PositionLostError
            A switch was not found.
        """
        self._homed = False
        if self._controller.status().state not in ("Idle", "Alarm"):
            self._controller.halt()
        self._controller.command(b"$H\n", self._config.homing_timeout_s)
        self._homed = True

    def check(self, azimuth_deg: float, elevation_deg: float) -> None:
        """Refuse a direction that the arm does not reach."""
        self._joints(azimuth_deg, elevation_deg)

    def move_to(self, azimuth_deg: float, elevation_deg: float) -> ArmPose:
        """Bring the lamp to a direction of the view frame.

        Raises
        ------
        OutOfRangeError
            The arm does not reach it; nothing moved.
        DeviceError, LinkError
            The controller refused, raised an alarm, is silent, or the arm did not arrive.
        """
        goal = self._joints(azimuth_deg, elevation_deg)
        if not self._homed:
            raise DeviceError("light arm: not homed yet; home it first")
        here = self._machine()
        way_deg = float(np.hypot(goal.x - here.x, goal.y - here.y))
        self._controller.command(codec.move_line(goal, 60 * self._config.speed_deg_s))
        self._controller.finish_motion(2 * way_deg / self._config.speed_deg_s + GRACE_S)
        self._check_arrival(goal)
        return self.locate()

    def locate(self) -> ArmPose:
        """Ask the controller where the lamp is."""
        machine = self._machine()
        azimuth_deg = (machine.x - self._config.azimuth_origin_deg) * self._config.azimuth_direction
        elevation_deg = machine.y - self._config.elevation_origin_deg
        direction = self._view_from_arm @ direction_from_angles(azimuth_deg, elevation_deg)
        return ArmPose(*angles_from_direction(direction))

    def stop(self) -> None:
        """Brake, keep the position; stopped while homing, it has none."""
        self._controller.halt()
        self._homed = self._homed and self._controller.status().state == "Idle"

    def close(self) -> None:
        """Give the port back."""
        self._controller.close()

    def _joints(self, azimuth_deg: float, elevation_deg: float) -> Axes:
        config = self._config
        if not (math.isfinite(azimuth_deg) and -90 <= elevation_deg <= 90):
            raise OutOfRangeError(
                f"light arm: azimuth {azimuth_deg:g}°, elevation {elevation_deg:g}° is no direction; nothing moved. "
                "Give an elevation between -90° and 90°"
            )
        in_arm = self._view_from_arm.T @ direction_from_angles(azimuth_deg, elevation_deg)
        around_deg, up_deg = angles_from_direction(in_arm)
        if up_deg > ZENITH_DEG:
            around_deg = config.min_azimuth_deg
        turns = (around_deg, around_deg - 360, around_deg + 360)
        reached = [turn for turn in turns if config.min_azimuth_deg <= turn <= config.max_azimuth_deg]
        if not reached or not config.min_elevation_deg <= up_deg <= config.max_elevation_deg:
            raise OutOfRangeError(
                f"light arm: azimuth {azimuth_deg:g}°, elevation {elevation_deg:g}° is outside its reach (azimuth "
                f"{config.min_azimuth_deg:g}..{config.max_azimuth_deg:g}°, elevation {config.min_elevation_deg:g}.."
                f"{config.max_elevation_deg:g}°); nothing moved. Ask for a direction inside, or widen the limits in "
                "RIG.toml"
            )
        return Axes(
            config.azimuth_origin_deg + config.azimuth_direction * reached[0], config.elevation_origin_deg + up_deg
        )

    def _machine(self) -> Axes:
        machine = self._controller.status().machine
        assert machine is not None  # noqa: S101  # the controller fills it in or raises
        return machine

    def _check_arrival(self, goal: Axes) -> None:
        report = self._controller.status()
        machine = report.machine or Axes(np.nan, np.nan)
        off_deg = max(abs(machine.x - goal.x), abs(machine.y - goal.y))
        if report.state != "Idle" or not off_deg <= self._config.tolerance_deg:
            raise DeviceError(
                f"light arm: told to go to X{goal.x:.2f} Y{goal.y:.2f}, stands at X{machine.x:.2f} Y{machine.y:.2f} "
                f"in state {report.state}; look what blocks it, then home it"
            )
