"""SIM.toml: which devices to play, and what the camera sees."""

import tomllib
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from firmware_sim.errors import SimConfigError
from firmware_sim.grbl.config import GrblFaults, Settings, StepperSim
from firmware_sim.grbl.dialect import DialectName
from firmware_sim.mitsuba.config import MitsubaScene
from firmware_sim.udmx.config import DomeSim

LARGEST_SIM_TOML_BYTES = 1_000_000


class _Strict(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True, allow_inf_nan=False)


class TurntableSim(_Strict):
    """A servo XL430-W250 under the sample."""

    id: int = Field(default=1, ge=0, le=252)
    """Its number on the bus."""
    baud: Literal[9_600, 57_600, 115_200, 1_000_000, 2_000_000, 3_000_000, 4_000_000] = 57_600
    """The speed that it listens at; at any other it stays silent."""
    start_deg: float = Field(default=31.6, ge=-90_000, le=90_000)
    """Where it stands when the power comes on."""


class ArmSim(_Strict):
    """A light arm on a controller with GRBL: X is azimuth, Y is elevation, both in degrees."""

    azimuth_travel_deg: float = Field(default=360, gt=0, le=720)
    """Machine coordinates X go from minus this to 0, where the limit switch is."""
    elevation_travel_deg: float = Field(default=90, gt=0, le=180)
    """Machine coordinates Y go from minus this to 0."""
    start_azimuth_deg: float = Field(default=300, ge=0, le=720)
    """Where the arm truly stands when the power comes on; the controller does not know it before it is homed."""
    start_elevation_deg: float = Field(default=55, ge=0, le=180)
    """The same for the elevation."""
    dialect: DialectName = "grbl"
    """Firmware: GRBL 1.1h, or grblHAL."""
    settings: Settings = Field(default_factory=dict)
    """Further `$` settings, as $21 for hard limits."""
    faults: GrblFaults = GrblFaults()
    """What goes wrong with it."""


class CameraSim(_Strict):
    """A USB camera of the UVC kind."""

    device: str = Field(default="/dev/video42", pattern=r"^/dev/\w+$")
    """The path that it appears under, for programs that run with the preloaded shim."""
    width: Literal[320, 640, 800, 1280] = 640
    """Picture width that RIG.toml asks for, in pixels; the camera offers the others too."""
    height: Literal[240, 480, 600, 720] = 480
    """Picture height that RIG.toml asks for."""
    fps: int = Field(default=30, ge=1, le=30)
    """Frames a second that RIG.toml asks for."""
    pixel_format: Literal["MJPG", "YUYV"] = "MJPG"
    """Format that RIG.toml asks for."""
    exposure_ms: float = Field(default=10.0, ge=0.1, le=500)
    """Exposure time that RIG.toml asks for."""
    gain: int = Field(default=0, ge=0, le=100)
    """Gain that RIG.toml asks for; 25 doubles the signal."""
    jpeg_quality: int = Field(default=95, ge=1, le=100)
    """Quality of the Motion JPEG pictures."""
    jpeg_subsampling: Literal["444", "422"] = "422"
    """Chroma sampling of the Motion JPEG pictures."""
    full_well_electrons: float = Field(default=20_000, gt=0)
    """Electrons that a pixel holds; shot noise is the root of what it has."""
    read_noise_electrons: float = Field(default=6.0, ge=0)
    """Standard deviation of what reading a pixel adds."""
    best_focus: int = Field(default=120, ge=0, le=255)
    """Value of the focus control at which the sample is sharp."""
    seed: int = Field(default=1, ge=0)
    """Seed of the noise."""


class SphereScene(_Strict):
    """A sphere of brushed aluminium on the turntable, under lights that do not move."""

    kind: Literal["brushed-sphere"] = "brushed-sphere"
    projection: Literal["perspective", "orthographic"] = "perspective"
    """How the camera sees."""
    distance_radii: float = Field(default=8.0, gt=1.2)
    """Distance from the camera to the sphere's centre, in radii of the sphere; of no meaning to an orthographic one."""
    centre_x_px: float = 324.3
    """Centre of the sphere's picture from the left edge, in pixels of a picture of 640 × 480."""
    centre_y_px: float = 238.6
    """The same from the upper edge."""
    radius_px: float = Field(default=180.0, gt=4)
    """Radius of the sphere's picture, in pixels of a picture of 640 × 480."""
    tangent_zero_deg: float = 0.0
    """Direction of the brushing at turntable angle 0, counter-clockwise from the picture's right."""
    roughness_along: float = Field(default=0.12, gt=0.01, le=1)
    """GGX roughness along the brushing."""
    roughness_across: float = Field(default=0.4, gt=0.01, le=1)
    """GGX roughness across the brushing."""


class ReliefScene(_Strict):
    """A worn bronze coin, seen from above by an orthographic camera, lit by the lamp on the arm and nothing else."""

    kind: Literal["relief"] = "relief"
    text: str = Field(default="LITRIG", min_length=1, max_length=12, pattern=r"^[ -~]+$")
    """What is struck on it."""
    height: float = Field(default=1.0, gt=0, le=5)
    """Factor on all heights."""
    turns: bool = True
    """Whether it lies on the turntable, or beside it."""


class SimConfig(_Strict):
    """Everything that SIM.toml can say; what it leaves out is the brushed sphere's rig."""

    turntable: TurntableSim = TurntableSim()
    stepper: StepperSim | None = None
    """A turntable on a GRBL axis in place of the servo."""
    arm: ArmSim = ArmSim()
    dome: DomeSim | None = None
    """Lamps on a dome in place of the arm's; only the relief is lit by them."""
    camera: CameraSim = CameraSim()
    scene: Annotated[SphereScene | ReliefScene | MitsubaScene, Field(discriminator="kind")] = SphereScene()

    @model_validator(mode="after")
    def _a_dome_needs_the_relief(self) -> Self:
        if self.dome is not None and self.scene.kind != "relief":
            raise ValueError("a [dome] lights the scene of kind relief only; add it, or leave the dome out")
        return self


def read_sim(path: Path) -> SimConfig:
    """Read SIM.toml.

    Raises
    ------
    SimConfigError
        The file is missing, is not TOML, or has a key or a value that does not fit; every misfit is named.
    """
    try:
        if path.stat().st_size > LARGEST_SIM_TOML_BYTES:
            raise SimConfigError(f"{path}: larger than {LARGEST_SIM_TOML_BYTES:,} bytes; not a simulator's file")
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise SimConfigError(f"{path}: no such file; check the path, or start from one in examples/") from error
    except (OSError, UnicodeDecodeError) as error:
        raise SimConfigError(f"{path}: cannot be read ({error})") from error
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise SimConfigError(f"{path}: not valid TOML ({error}); mend that place") from error
    try:
        return SimConfig.model_validate(table)
    except ValidationError as error:
        misfits = "; ".join(_misfit(item["type"], item["loc"], item["msg"]) for item in error.errors())
        raise SimConfigError(f"{path}: {misfits}") from error


def _misfit(kind: str, place: tuple[int | str, ...], message: str) -> str:
    key = ".".join(str(part) for part in place)
    if kind == "extra_forbidden":
        return f"unknown key {key!r}; remove it or mend its spelling"
    return f"{key}: {message}" if key else message.removeprefix("Value error, ")
