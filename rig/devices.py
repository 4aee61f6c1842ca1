"""What a device is: small synchronous Protocols. Drivers and fakes fit them and inherit nothing.

Every `stop` is safe at any time, and twice. A goal outside the limits raises `OutOfRangeError` before a byte is sent;
nothing is ever clamped.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol


@dataclass(frozen=True)
class TurntablePose:
    """Where the turntable was told to be (None: nowhere yet), and where it reads that it is.

    Attributes
    ----------
    settle_s : after a move, how long it took from the end of the motion until it was seen to stand still
    """

    commanded_deg: float | None
    angle_deg: float
    settle_s: float = 0.0


@dataclass(frozen=True)
class ArmPose:
    """Where the light arm reads that it is: the direction from sample to light, view frame, in degrees."""

    azimuth_deg: float
    elevation_deg: float


@dataclass(frozen=True)
class Shot:
    """One picture as the camera delivered it.

    Attributes
    ----------
    content : the file's bytes
    ending : what the file should end in, with the dot
    exposed_from_s, exposed_to_s : the earliest start and the latest end of the exposure, on the rig's clock
    settings : what the camera says it was set to
    repeats : it is bit for bit what the camera delivered just before; noise allows that of black pictures only
    """

    content: bytes
    ending: str
    exposed_from_s: float
    exposed_to_s: float
    settings: Mapping[str, float | str] = field(default_factory=dict)
    repeats: bool = False


class Turntable(Protocol):
    """Turns the sample about the camera's axis; positive is counter-clockwise as the camera sees it."""

    def home(self) -> None:
        """Get ready to move and know the position. Raises if the device is faulty or the wrong one."""

    def check(self, angle_deg: float) -> None:
        """Raise `OutOfRangeError` if it cannot go there; asks no device."""

    def move_to(self, angle_deg: float) -> TurntablePose:
        """Go there, wait until settled, return the pose read back."""

    def locate(self) -> TurntablePose:
        """Ask the device, now. Raises if, once homed, it has a fault, lost its torque or was reset."""

    def stop(self) -> None:
        """Halt and keep holding."""

    def release(self) -> None:
        """Let go: the table can be turned by hand afterwards."""

    def close(self) -> None:
        """Give the port back; motion and torque stay as they are."""


class LightArm(Protocol):
    """Carries a lamp over the sample's hemisphere."""

    def home(self) -> None:
        """Find the reference marks."""

    def check(self, azimuth_deg: float, elevation_deg: float) -> None:
        """Raise `OutOfRangeError` if it cannot go there; asks no device."""

    def move_to(self, azimuth_deg: float, elevation_deg: float) -> ArmPose:
        """Bring the lamp to a direction in the view frame, wait until settled, return the pose read back."""

    def locate(self) -> ArmPose:
        """Ask the device, now."""

    def stop(self) -> None:
        """Halt; the position stays known."""

    def close(self) -> None:
        """Give the port back."""


class Lights(Protocol):
    """Lamps by number."""

    def check(self, lamp: int) -> None:
        """Raise `OutOfRangeError` if there is no such lamp; asks no device."""

    def switch_on(self, lamp: int = 0) -> None:
        """Light one lamp, and wait until it is warm."""

    def switch_off(self) -> None:
        """All dark. Safe at any time, and twice."""

    def close(self) -> None:
        """Give the port back; the lamps stay as they are."""


class Camera(Protocol):
    """Takes pictures one by one."""

    def configure(self) -> Mapping[str, float | str]:
        """Open, or open again, set everything that can be set, and return what the camera reads back."""

    def capture(self, not_before_s: float, exposure_ev: float = 0.0) -> Shot:
        """Take a picture whose exposure began after an instant of the rig's clock.

        `exposure_ev` is in stops above the exposure time of RIG.toml; it holds for this picture only.
        """

    def close(self) -> None:
        """Let the camera go."""
