"""Devices that live in memory, for tests and for trying plans: they obey, and remember what they were told."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from rig.clock import Clock
from rig.devices import ArmPose, Shot, TurntablePose
from rig.errors import DeviceError, OutOfRangeError


@dataclass
class FakeClock:
    """Fits `rig.clock.Clock`; time passes only while somebody sleeps."""

    time_s: float = 0.0

    def now_s(self) -> float:
        """Return the time."""
        return self.time_s

    def sleep(self, seconds: float) -> None:
        """Let it pass."""
        self.time_s += seconds


@dataclass
class FakeTurntable:
    """Fits `rig.devices.Turntable`; it turns at once, and misses its goal by `error_deg`."""

    min_deg: float = -360.0
    max_deg: float = 720.0
    error_deg: float = 0.0
    angle_deg: float = 0.0
    torque: bool = False
    stops: int = 0
    _commanded_deg: float | None = None

    def home(self) -> None:
        """Switch torque on."""
        self.torque = True

    def check(self, angle_deg: float) -> None:
        """Refuse what is beyond the limits."""
        if not self.min_deg <= angle_deg <= self.max_deg:
            raise OutOfRangeError(
                f"turntable: {angle_deg:g}° is outside {self.min_deg:g}..{self.max_deg:g}°; nothing moved"
            )

    def move_to(self, angle_deg: float) -> TurntablePose:
        """Turn."""
        self.check(angle_deg)
        if not self.torque:
            raise DeviceError("turntable: not homed yet; home it first")
        self._commanded_deg, self.angle_deg = angle_deg, angle_deg + self.error_deg
        return self.locate()

    def locate(self) -> TurntablePose:
        """Tell."""
        return TurntablePose(self._commanded_deg, self.angle_deg)

    def stop(self) -> None:
        """Count."""
        self.stops += 1

    def release(self) -> None:
        """Switch torque off."""
        self.torque = False

    def close(self) -> None:
        """Nothing to give back."""


@dataclass
class FakeArm:
    """Fits `rig.devices.LightArm`."""

    min_elevation_deg: float = 5.0
    max_elevation_deg: float = 88.0
    pose: ArmPose = ArmPose(0.0, 45.0)  # noqa: RUF009  # frozen
    homed: bool = False
    stops: int = 0

    def home(self) -> None:
        """Take the position as known."""
        self.homed = True

    def check(self, azimuth_deg: float, elevation_deg: float) -> None:
        """Refuse what is beyond the limits."""
        if not (self.min_elevation_deg <= elevation_deg <= self.max_elevation_deg and abs(azimuth_deg) <= 360):
            raise OutOfRangeError(
                f"light arm: azimuth {azimuth_deg:g}°, elevation {elevation_deg:g}° is outside its reach; nothing moved"
            )

    def move_to(self, azimuth_deg: float, elevation_deg: float) -> ArmPose:
        """Be there."""
        self.check(azimuth_deg, elevation_deg)
        if not self.homed:
            raise DeviceError("light arm: not homed yet; home it first")
        self.pose = ArmPose(azimuth_deg % 360, elevation_deg)
        return self.pose

    def locate(self) -> ArmPose:
        """Tell."""
        return self.pose

    def stop(self) -> None:
        """Count."""
        self.stops += 1

    def close(self) -> None:
        """Nothing to give back."""


@dataclass
class FakeLights:
    """Fits `rig.devices.Lights`."""

    lamp: int | None = None
    lamps: int = 1

    def check(self, lamp: int) -> None:
        """Refuse a lamp beyond the last."""
        if lamp not in range(self.lamps):
            raise OutOfRangeError(f"lights: lamp {lamp} does not exist; this rig has lamps 0..{self.lamps - 1}")

    def switch_on(self, lamp: int = 0) -> None:
        """Remember the lamp."""
        self.check(lamp)
        self.lamp = lamp

    def switch_off(self) -> None:
        """Forget it."""
        self.lamp = None

    def close(self) -> None:
        """Nothing to give back."""


@dataclass
class FakeCamera:
    """Fits `rig.devices.Camera`; each picture comes from `paint`, which may look at the other fakes."""

    paint: Callable[[], bytes]
    clock: Clock = field(default_factory=FakeClock)
    exposure_s: float = 0.01
    exposed_s: float = 0.01
    """The exposure time of the last picture."""

    def configure(self) -> Mapping[str, float | str]:
        """Tell the settings."""
        return {"exposure_ms": 1000 * self.exposure_s}

    def capture(self, not_before_s: float, exposure_ev: float = 0.0) -> Shot:
        """Expose from now on."""
        start_s = max(self.clock.now_s(), not_before_s) + 1e-6
        self.exposed_s = self.exposure_s * 2**exposure_ev
        content = self.paint()
        self.clock.sleep(start_s - self.clock.now_s() + self.exposed_s)
        settings = {"exposure_ms": 1000 * self.exposed_s}
        return Shot(content, ".jpg", start_s, start_s + self.exposed_s, settings)

    def close(self) -> None:
        """Nothing to give back."""
