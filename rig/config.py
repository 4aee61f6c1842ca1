"""RIG.toml: what is plugged in where, and how far each part may go. Unknown keys are refused.

What a section may say depends on its `kind`: its driver brings the model (`rig.drivers`).
"""

import math
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, Field, SerializeAsAny, model_validator

from litrig.base.config import StrictModel, read_toml
from rig.drivers import ARMS, CAMERAS, LIGHTS, TURNTABLES
from rig.sections import ArmSection, CameraSection, LightsSection, Port, Positive, TurntableSection

SERVO_TICK_DEG = 360 / 4096
Turns = Annotated[float, Field(ge=-90_000, le=90_000)]
Matrix = tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]


class RigInfo(StrictModel):
    """The rig as a whole."""

    name: str = "rig"
    """How the rig is called in session records."""


class TurntableConfig(TurntableSection):
    """A turntable on a Dynamixel servo of the X series."""

    kind: Literal["dynamixel"] = "dynamixel"
    """The driver."""
    port: Port
    """Device path of the serial adapter; a path below /dev/serial/by-id keeps its name when replugged."""
    baud: int = Field(default=57600, gt=0)
    """Baud rate that the servo is set to (57600 as delivered)."""
    id: int = Field(default=1, ge=0, le=252)
    """The servo's id on the bus (1 as delivered)."""
    model: str = "XL430-W250"
    """Model name as on the label, without -T or -R; the servo's own model number is checked against it."""
    zero_deg: Turns = 0.0
    """Servo angle at which the turntable stands at zero."""
    direction: Literal[1, -1] = 1
    """1 if the servo's positive sense turns the sample counter-clockwise as the camera sees it, else −1."""
    gear_ratio: float = Field(default=1.0, ge=0.01, le=100)
    """Turns of the servo for one turn of the table. Without power a servo forgets whole turns: with a ratio above 1,
    switch it on while the table stands within one turn of the servo above zero."""
    min_deg: Turns = -360.0
    """Lowest angle that the cables allow, with `backlash_deg` to spare below it for the run-up."""
    max_deg: Turns = 720.0
    """Highest angle that the cables allow."""
    speed_deg_s: float = Field(default=90.0, ge=2, le=1000)
    """Speed of the table."""
    acceleration_deg_s2: float = Field(default=600.0, ge=20, le=20_000)
    """Acceleration of the table."""
    tolerance_deg: Positive = 0.3
    """How far the angle read back may be from its goal."""
    backlash_deg: float = Field(default=1.0, ge=0)
    """Play of the gears: a goal is always approached from below by at least this much."""
    park_deg: float = 0.0
    """Where the table rests at the end of a session."""

    @property
    def instrument(self) -> str:
        """Name the servo."""
        return f"turntable {self.model} (id {self.id})"

    @model_validator(mode="after")
    def _tolerance_reaches_a_step(self) -> Self:
        if self.tolerance_deg * self.gear_ratio < SERVO_TICK_DEG / 2:
            raise ValueError(
                f"tolerance_deg ({self.tolerance_deg:g}) must reach half a step of the servo, of 4096 a turn"
            )
        return self


class ZoneConfig(StrictModel):
    """A rectangle of joint angles, edges excluded, where the arm must not be; the azimuth counts modulo a turn."""

    name: str = Field(min_length=1, max_length=40)
    """What is there, for error messages."""
    azimuth_deg: tuple[float, float]
    """From and to, in the arm's own frame."""
    elevation_deg: tuple[float, float]
    """From and to."""
    may_pass: bool = False
    """True if the arm may pass through and only not stop, as where it would stand in the picture."""

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        for name, (low, high) in (("azimuth_deg", self.azimuth_deg), ("elevation_deg", self.elevation_deg)):
            if not low < high:
                raise ValueError(f"{name} must rise, as in [{high:g}, {low:g}]")
        if self.azimuth_deg[1] - self.azimuth_deg[0] > 360:
            raise ValueError("azimuth_deg must span a turn at most")
        return self


class ArmConfig(ArmSection):
    """A light arm of two axes on a GRBL 1.1 controller: X turns in azimuth, Y in elevation, a degree a millimetre."""

    kind: Literal["grbl"] = "grbl"
    """The driver."""
    port: Port
    """Device path of the controller."""
    baud: int = Field(default=115200, gt=0)
    """GRBL runs at 115200."""
    azimuth_origin_deg: float = -360.0
    """Machine coordinate X at azimuth zero of the arm's own frame."""
    elevation_origin_deg: float = -90.0
    """Machine coordinate Y at elevation zero."""
    azimuth_direction: Literal[1, -1] = 1
    """1 if machine X grows with the azimuth, else −1."""
    view_from_arm: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    """Rotation that takes the arm's axes to the view frame, row by row."""
    min_azimuth_deg: float = 0.0
    """Lowest azimuth that the arm reaches."""
    max_azimuth_deg: float = 360.0
    """Highest azimuth that the arm reaches."""
    min_elevation_deg: float = 5.0
    """Lowest elevation, where the lamp would touch the table."""
    max_elevation_deg: float = 88.0
    """Highest elevation, where the arm would stand before the camera."""
    speed_deg_s: float = Field(default=110.0, ge=0.1, le=1000)
    """Speed along the path in joint space."""
    acceleration_deg_s2: float = Field(default=500.0, ge=1, le=100_000)
    """Acceleration as the controller has it ($120, $121); for predicting times only."""
    radius_mm: float | None = Field(default=None, gt=0)
    """From the elevation joint to the lamp; left out, the lamp counts as far away."""
    pivot_height_mm: float = 0.0
    """Height of the elevation joint above the sample's plane; below it if negative."""
    zones: tuple[ZoneConfig, ...] = ()
    """Where the arm would touch camera or table, or stand in the picture."""
    settings: dict[Annotated[int, Field(ge=0, le=999)], float] = Field(default_factory=dict)
    """GRBL settings ($ numbers) that the controller must have; those that differ are written when it is opened."""
    tolerance_deg: Positive = 0.2
    """How far a joint read back may be from its goal."""
    park_azimuth_deg: float = 0.0
    """Where the arm rests at the end of a session."""
    park_elevation_deg: float = 45.0
    """Where the arm rests at the end of a session."""
    homing_timeout_s: Positive = 60.0
    """How long homing may take."""

    @model_validator(mode="after")
    def _proper_rotation(self) -> Self:
        rows = self.view_from_arm
        for i, row in enumerate(rows):
            for j, other in enumerate(rows):
                if not math.isclose(sum(a * b for a, b in zip(row, other, strict=True)), float(i == j), abs_tol=1e-3):
                    raise ValueError("view_from_arm must be a rotation: unit rows at right angles")
        return self

    @model_validator(mode="after")
    def _limits_in_order(self) -> Self:
        if not (self.min_azimuth_deg <= self.park_azimuth_deg <= self.max_azimuth_deg):
            raise ValueError("park_azimuth_deg must lie between min_azimuth_deg and max_azimuth_deg")
        if not (self.min_elevation_deg <= self.park_elevation_deg <= self.max_elevation_deg):
            raise ValueError("park_elevation_deg must lie between min_elevation_deg and max_elevation_deg")
        return self

    @model_validator(mode="after")
    def _joint_within_radius(self) -> Self:
        if self.pivot_height_mm and (self.radius_mm is None or abs(self.pivot_height_mm) >= self.radius_mm):
            raise ValueError("pivot_height_mm needs a radius_mm that is larger")
        return self


class SpindleLampConfig(LightsSection):
    """The arm's lamp on the spindle output of the same GRBL controller."""

    kind: Literal["grbl-spindle"]
    """The driver."""
    power: float = Field(default=1000.0, gt=0)
    """Spindle speed S that gives the wanted brightness (GRBL's $30 is full power)."""
    warm_up_s: float = Field(default=0.0, ge=0)
    """How long the lamp needs until its light is steady."""
    timeout_s: float = Field(default=60.0, ge=0, le=3000)
    """After so long the controller puts the lamp out by itself, should the host be dead; 0 lets it burn on.

    Unless it is 0, the lamp is dark while the arm moves, and warms up again at each pose.
    """

    @model_validator(mode="after")
    def _burns_long_enough(self) -> Self:
        if self.timeout_s and self.timeout_s <= self.warm_up_s:
            raise ValueError("timeout_s must exceed warm_up_s, or be 0 for no timeout")
        return self


class AlwaysOnConfig(LightsSection):
    """Lamps that the rig does not switch."""

    kind: Literal["always-on"]
    """The driver."""

    @property
    def switchable(self) -> bool:
        """A person does that."""
        return False


class CameraConfig(CameraSection):
    """A camera behind V4L2."""

    kind: Literal["v4l2"] = "v4l2"
    """The driver."""
    device: Port
    """Device path; a path below /dev/v4l/by-id keeps its name when replugged."""
    width: int = Field(default=640, gt=0)
    """Picture width in pixels."""
    height: int = Field(default=480, gt=0)
    """Picture height in pixels."""
    fps: float | None = Field(default=None, gt=0)
    """Frames a second; left as the camera has it if left out."""
    pixel_format: Literal["MJPG", "YUYV"] = "MJPG"
    """MJPG keeps the camera's own JPEG, bit for bit; YUYV is kept as PNG."""
    exposure_ms: Positive = 10.0
    """Exposure time; automatic exposure is switched off."""
    gain: int | None = Field(default=None, ge=0)
    """Sensor gain in the camera's own unit; left as the camera has it if left out."""
    white_balance_k: int | None = None
    """Colour temperature; left as it is if left out. Automatic white balance is switched off in any case."""
    focus: int | None = None
    """Focus in the camera's own unit; left as it is if left out. Autofocus is switched off in any case."""
    timeout_s: Positive = 10.0
    """How long a picture may take, beyond its exposure, before the camera counts as hanging."""

    @property
    def instrument(self) -> str:
        """Name the device."""
        return f"camera {self.device}"


class SampleConfig(StrictModel):
    """What was measured on the bench about the sample."""

    sphere_distance_radii: float | None = Field(default=None, gt=1)
    """Camera to the centre of the sample sphere, in its radii; leave out for a telecentric (orthographic) view."""


class RigConfig(StrictModel):
    """A RIG.toml. A part that the rig does not have is left out."""

    rig: RigInfo = RigInfo()
    """The rig as a whole."""
    turntable: Annotated[SerializeAsAny[TurntableSection] | None, BeforeValidator(TURNTABLES.read)] = None
    """The turntable."""
    arm: Annotated[SerializeAsAny[ArmSection] | None, BeforeValidator(ARMS.read)] = None
    """The light arm."""
    lights: Annotated[SerializeAsAny[LightsSection] | None, BeforeValidator(LIGHTS.read)] = None
    """The lamps."""
    camera: Annotated[SerializeAsAny[CameraSection] | None, BeforeValidator(CAMERAS.read)] = None
    """The camera."""
    sample: SampleConfig = SampleConfig()
    """The sample."""

    @model_validator(mode="after")
    def _spindle_needs_arm(self) -> Self:
        has_controller = isinstance(self.arm, ArmConfig)
        if isinstance(self.lights, SpindleLampConfig) and not has_controller:
            raise ValueError("lights of kind grbl-spindle need an [arm] of kind grbl, whose output they are")
        return self

    @model_validator(mode="after")
    def _lamp_outlives_the_exposure(self) -> Self:
        if (
            isinstance(self.lights, SpindleLampConfig)
            and self.lights.timeout_s
            and isinstance(self.camera, CameraConfig)
        ):
            needed_s = self.lights.warm_up_s + self.camera.exposure_ms / 1000 + self.camera.timeout_s
            if self.lights.timeout_s < needed_s:
                raise ValueError(
                    f"lights.timeout_s must be at least {needed_s:g}: warm-up, exposure and the camera's timeout_s"
                )
        return self


def read_rig(path: Path) -> RigConfig:
    """Read a RIG.toml.

    Raises
    ------
    InputError, ConfigError
        The file is missing, or a key is unknown, missing or out of range; the message names it.
    """
    config = read_toml(path, RigConfig)
    if config.lights is None:
        return config
    return config.model_copy(update={"lights": config.lights.resolved(path.parent)})
