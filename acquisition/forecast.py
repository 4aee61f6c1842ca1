"""What a plan will cost: time and its parts, the ways of arm and table, room on the disk. Nothing moves for it."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

from acquisition.forecast_motion import ArmMotion, TableMotion, length_deg
from acquisition.forecast_picture import Picture
from acquisition.plans import Aim, Plan, Step
from litrig.base.errors import InputError
from rig.config import ArmConfig, CameraConfig, RigConfig, SpindleLampConfig, TurntableConfig
from rig.errors import OutOfRangeError

OPEN_S = 1.6
"""To start, open ports and camera, and close the bag at the end (measured on the simulated rig)."""
ARM_SETTLE_S = 0.35
"""At each pose of the arm: the controller freed of the lamp's guard, its planner emptied, reports, the lamp lit again
(measured likewise)."""
ARM_HOMING_S = 2.5
"""To find the switches: two passes and the way off them (measured likewise; it depends on where the arm stands)."""
UNKNOWN_ARM_MOVE_S = 2.0
"""Of an arm of another package, of which nothing is known."""
STEP_S = 0.03
"""To decode a frame, judge it and bring it to the disk (measured)."""
STEP_S_A_MEGAPIXEL = 0.03
"""The same for what a larger picture takes more."""
UNKNOWN_MEGAPIXELS = 24.0
RECORD_BYTES = 9000
"""Of a frame besides its picture: lines in journal, plan, manifests and crate, a thumbnail, rests of disk blocks."""


@dataclass(frozen=True)
class Forecast:
    """What a plan will cost; times in seconds.

    Attributes
    ----------
    homing_s : opening, homing, and parking at the end
    moves_s : of arm and table, one after the other
    settles_s : until both are known to stand, and lamps are warm
    exposures_s : waiting for frames, and exposing them
    steps_s : judging frames and bringing them to the disk, as far as nothing moves meanwhile
    table_deg, arm_deg : ways of the table and of the arm in joint space, with parking
    disk_bytes : of the capture folder
    asks : how often a person is asked for something; the time for it is not known, and not counted
    assumptions : what the figures rest on besides RIG.toml
    """

    homing_s: float = 0.0
    moves_s: float = 0.0
    settles_s: float = 0.0
    exposures_s: float = 0.0
    steps_s: float = 0.0
    table_deg: float = 0.0
    arm_deg: float = 0.0
    disk_bytes: int = 0
    asks: int = 0
    assumptions: tuple[str, ...] = ()

    @property
    def total_s(self) -> float:
        """All of the time."""
        return self.homing_s + self.moves_s + self.settles_s + self.exposures_s + self.steps_s

    def as_json(self) -> Mapping[str, Any]:
        """Return it for programs."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        rounded = {key: round(value, 3) if isinstance(value, float) else value for key, value in values.items()}
        return {**rounded, "assumptions": list(self.assumptions), "total_s": round(self.total_s, 3)}


def usual_rig() -> RigConfig:
    """Return a rig of RIG.toml's defaults whose arm reaches everywhere, for plans whose rig is not known."""
    return RigConfig(
        turntable=TurntableConfig(port="unknown"),
        arm=ArmConfig(port="unknown", min_elevation_deg=-90.0, max_elevation_deg=90.0),
        camera=CameraConfig(device="unknown", width=1280, height=720),
    )


def forecast(plan: Plan, config: RigConfig) -> Forecast:
    """Follow a plan on a rig.

    Raises
    ------
    InputError
        The arm cannot go from one step to the next; the message has the step.
    """
    follower = _Follower(plan, config)
    for step in plan:
        try:
            follower.follow(step)
        except OutOfRangeError as error:
            raise InputError(f"step {step.step} ({step.stem}): {error}") from error
    try:
        return follower.park()
    except OutOfRangeError as error:
        raise InputError(f"parking: {error}") from error


class _Follower:
    """Goes through the steps, and adds up."""

    def __init__(self, plan: Plan, config: RigConfig) -> None:
        self._config = config
        self._picture = Picture.of(config.camera)
        self._assumptions = [f"disk: {self._picture.meaning}"]
        self._homing_s, self._moves_s, self._settles_s, self._exposures_s = OPEN_S, 0.0, 0.0, 0.0
        self._steps_s = self._table_way_deg = self._arm_way_deg = 0.0
        self._frames = self._asks = 0
        self._exposure_ev, self._lamp = 0.0, -1
        self._table: TableMotion | None = None
        self._arm: ArmMotion | None = None
        has_dome = config.lights is not None and config.lights.directions_deg
        self._moves_arm = bool(plan.poses.aims) and config.arm is not None and not has_dome
        if plan.poses.turn is not None and config.turntable is not None:
            self._table = TableMotion.of(config.turntable)
            self._at_deg = config.turntable.park_deg
            self._assumptions += self._table.assumptions
        if self._moves_arm:
            self._homing_s += ARM_HOMING_S
            if isinstance(config.arm, ArmConfig):
                self._arm = ArmMotion(config.arm)
                self._joints = self._arm.home
            else:
                self._assumptions.append(
                    f"each move of the arm takes {UNKNOWN_ARM_MOVE_S:g} s, for its speed is not known"
                )

    def follow(self, step: Step) -> None:
        """Go to a step, while the frame before it is kept, and shoot it."""
        before_s = self._moves_s + self._settles_s
        if step.angle_deg is not None and self._table is not None:
            self._turn(step.angle_deg)
        if step.aim is not None:
            if self._moves_arm:
                self._swing(step.aim)
            self._light(step.aim.lamp)
        if not step.lit or step.ask:
            self._lamp = -1
        if self._frames:
            self._keep(self._moves_s + self._settles_s - before_s)
        changed = step.exposure_ev != self._exposure_ev
        self._exposures_s += self._picture.time_s(step.exposure_ev, changed=changed)
        self._exposure_ev = step.exposure_ev
        self._frames += 1
        self._asks += bool(step.ask)

    def park(self) -> Forecast:
        """Go to rest, and return the sums."""
        self._keep(0.0)
        moves_s, settles_s = self._moves_s, self._settles_s
        if self._arm is not None:
            self._swing(self._arm.park)
        if self._table is not None and self._config.turntable is not None:
            self._turn(self._config.turntable.park_deg)
        parking_s = self._moves_s - moves_s + self._settles_s - settles_s
        return Forecast(
            self._homing_s + parking_s,
            moves_s,
            settles_s,
            self._exposures_s,
            self._steps_s,
            self._table_way_deg,
            self._arm_way_deg,
            round(self._frames * (self._picture.size_bytes + RECORD_BYTES)),
            self._asks,
            tuple(self._assumptions),
        )

    def _keep(self, meanwhile_s: float) -> None:
        """Judge a frame and bring it to the disk; what does not fit into the way to the next is waited for."""
        self._steps_s += max(0.0, STEP_S + STEP_S_A_MEGAPIXEL * self._megapixels() - meanwhile_s)

    def _turn(self, angle_deg: float) -> None:
        assert self._table is not None  # noqa: S101  # asked before
        legs_deg = self._table.legs_deg(self._at_deg, angle_deg)
        self._moves_s += self._table.time_s(legs_deg)
        self._settles_s += self._table.settling_s(legs_deg)
        self._table_way_deg += sum(legs_deg)
        self._at_deg = angle_deg

    def _swing(self, aim: Aim) -> None:
        self._settles_s += ARM_SETTLE_S
        if self._arm is None:
            self._moves_s += UNKNOWN_ARM_MOVE_S
            return
        way = self._arm.way(self._joints, aim)
        self._moves_s += self._arm.time_s(self._joints, way)
        self._arm_way_deg += length_deg(self._joints, way)
        self._joints = way[-1]

    def _light(self, lamp: int) -> None:
        """Wait until a lamp is warm: the arm's is lit anew at each pose, one of a dome stays lit."""
        lights = self._config.lights
        if isinstance(lights, SpindleLampConfig) or lamp != self._lamp:
            self._settles_s += getattr(lights, "warm_up_s", 0.0)
        self._lamp = lamp

    def _megapixels(self) -> float:
        camera = self._config.camera
        return camera.width * camera.height / 1e6 if isinstance(camera, CameraConfig) else UNKNOWN_MEGAPIXELS
