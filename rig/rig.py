"""The rig as a whole: its parts, the state that it is in, and how it comes to rest."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from enum import StrEnum
from types import TracebackType
from typing import Self, TypeVar

from litrig.base.directions import F64, angle_between_deg, direction_from_angles
from rig.clock import Clock, MonotonicClock
from rig.config import RigConfig
from rig.devices import ArmPose, Camera, LightArm, Lights, Shot, Turntable, TurntablePose
from rig.drivers import ARMS, CAMERAS, LIGHTS, TURNTABLES, Bench
from rig.errors import OutOfRangeError, PositionLostError, RigError
from rig.rig_lock import RigLock, lock_rig

DOME_TOLERANCE_DEG = 0.01
"""How far a wanted direction may be from the lamp's own: both come from the same RIG.toml, but for rounding."""


class RigState(StrEnum):
    """What the rig is doing."""

    IDLE = "idle"
    MOVING = "moving"
    EXPOSING = "exposing"
    PAUSED = "paused"
    HOLD = "hold"
    ALARM = "alarm"


class Rig:
    """Turntable, light arm, lights and camera, as far as they are there.

    A context manager: left normally, the ports are given back and everything stays as it is; left by an error or a
    second Ctrl-C, the rig goes on hold first: motion stops, lamps go dark, torque stays.
    """

    def __init__(
        self,
        config: RigConfig,
        *,
        clock: Clock,
        turntable: Turntable | None = None,
        arm: LightArm | None = None,
        lights: Lights | None = None,
        camera: Camera | None = None,
        lock: RigLock | None = None,
    ) -> None:
        self.config, self.clock = config, clock
        self._lock = lock
        self._turntable, self._arm, self._lights, self._camera = turntable, arm, lights, camera
        self._moving: Turntable | LightArm | None = None
        self.state = RigState.IDLE
        self.position_known = False

    def __enter__(self) -> Self:
        """Use the rig."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Hold if something went wrong, then give the ports back."""
        try:
            if kind is not None:
                self.hold()
        finally:
            self._close()

    @property
    def turntable(self) -> Turntable:
        """The turntable; an error if the rig has none."""
        return _present(self._turntable, "turntable")

    @property
    def arm(self) -> LightArm:
        """The light arm; an error if the rig has none."""
        return _present(self._arm, "arm")

    @property
    def lights(self) -> Lights:
        """The lamps; an error if the rig has none."""
        return _present(self._lights, "lights")

    @property
    def camera(self) -> Camera:
        """The camera; an error if the rig has none."""
        return _present(self._camera, "camera")

    @property
    def directions_deg(self) -> tuple[tuple[float, float], ...]:
        """Azimuth and elevation of each lamp of a dome; empty if the lamp rides on the arm."""
        return () if self.config.lights is None else self.config.lights.directions_deg

    @property
    def has_dome(self) -> bool:
        """Whether each lamp has its place, and none rides on the arm."""
        return bool(self.directions_deg)

    @property
    def can_darken(self) -> bool:
        """Whether it has lamps that go dark when they are told to."""
        return self._lights is not None and self.config.lights is not None and self.config.lights.switchable

    def nearest_lamp(self, direction: F64) -> int:
        """Return the lamp of a dome whose direction is nearest to a vector (3,) in the view frame."""
        off_deg = [angle_between_deg(direction, direction_from_angles(*angles)) for angles in self.directions_deg]
        return off_deg.index(min(off_deg))

    def home(self) -> None:
        """Home whatever moves, lamps dark."""
        if self._arm is None and self._turntable is None:
            raise RigError("this rig has nothing that moves: RIG.toml has neither [turntable] nor [arm]")
        self.get_ready()

    def get_ready(self) -> None:
        """Home whatever moves, if anything does; lamps dark."""
        self.position_known = False  # until it ends well
        with self._doing(RigState.MOVING):
            if self._arm is not None:
                self._moving = self._arm
                self._arm.home()
            if self._lights is not None:
                self._lights.switch_off()
            if self._turntable is not None:
                self._turntable.home()
        self.position_known = True

    def turn_to(self, angle_deg: float) -> TurntablePose:
        """Turn the sample."""
        with self._doing(RigState.MOVING):
            self._moving = self.turntable
            return self.turntable.move_to(angle_deg)

    def check_light(self, azimuth_deg: float, elevation_deg: float, lamp: int) -> None:
        """Refuse a light that cannot be had: out of the arm's reach, or not where that lamp of the dome hangs.

        Raises
        ------
        OutOfRangeError, RigError
            Nothing was sent.
        """
        self.lights.check(lamp)
        if not self.has_dome:
            if self._arm is None:
                raise RigError(
                    "this rig has no arm, and its lamps have no directions; add [arm] to RIG.toml, or azimuth_deg and "
                    "elevation_deg to each [[lights.lamp]]"
                )
            self.arm.check(azimuth_deg, elevation_deg)
            return
        here = self.locate_light(lamp)
        off_deg = angle_between_deg(
            direction_from_angles(azimuth_deg, elevation_deg),
            direction_from_angles(here.azimuth_deg, here.elevation_deg),
        )
        if not off_deg <= DOME_TOLERANCE_DEG:
            raise OutOfRangeError(
                f"lights: lamp {lamp} hangs at azimuth {here.azimuth_deg:g}°, elevation {here.elevation_deg:g}°, not "
                f"at {azimuth_deg:g}°, {elevation_deg:g}°; ask for its own direction"
            )

    def light_from(self, azimuth_deg: float, elevation_deg: float, lamp: int = 0) -> ArmPose:
        """Light a lamp: that of the arm, brought to a direction, or one of a dome, which hangs there."""
        self.point_light(azimuth_deg, elevation_deg, lamp)
        self.lights.switch_on(lamp)
        return self.locate_light(lamp)

    def point_light(self, azimuth_deg: float, elevation_deg: float, lamp: int = 0) -> None:
        """Bring the lamp of the arm to a direction; a lamp of a dome hangs there."""
        self.check_light(azimuth_deg, elevation_deg, lamp)
        if not self.has_dome:
            with self._doing(RigState.MOVING):
                self._moving = self.arm
                self.arm.move_to(azimuth_deg, elevation_deg)

    def locate_light(self, lamp: int = 0) -> ArmPose:
        """Tell where a lamp is: ask the arm, or look up the dome."""
        return ArmPose(*self.directions_deg[lamp]) if self.has_dome else self.arm.locate()

    def darken(self) -> None:
        """Put the lamps out, if the rig has any."""
        if self._lights is not None:
            self._lights.switch_off()

    def expose(self, not_before_s: float, exposure_ev: float = 0.0) -> Shot:
        """Take a picture, so many stops above the exposure of RIG.toml."""
        with self._doing(RigState.EXPOSING):
            return self.camera.capture(not_before_s, exposure_ev)

    def pause(self) -> None:
        """Stay where it is: torque on, lamps dark."""
        if self._lights is not None:
            self._lights.switch_off()
        self.state = RigState.PAUSED

    def hold(self) -> list[Exception]:
        """Stop all motion, darken the lamps, keep torque. Tries every part, and returns what did not obey."""
        parts = sorted(
            (part for part in (self._turntable, self._arm) if part), key=lambda part: part is not self._moving
        )
        stops: list[Callable[[], None]] = [part.stop for part in parts]
        if self._lights is not None:
            stops.append(self._lights.switch_off)
        failures = [failure for stop in stops if (failure := _attempt(stop))]
        if any(isinstance(failure, PositionLostError) for failure in failures):
            self.position_known = False
        self.state = RigState.HOLD
        return failures

    def park(self) -> None:
        """Bring a rig whose position is known to rest, lamps dark, and let go."""
        if not self.position_known:
            return
        with self._doing(RigState.MOVING):
            if self._lights is not None:
                self._lights.switch_off()
            if self._arm is not None and self.config.arm is not None:
                self._arm.move_to(self.config.arm.park_azimuth_deg, self.config.arm.park_elevation_deg)
            if self._turntable is not None and self.config.turntable is not None:
                self._turntable.move_to(self.config.turntable.park_deg)
                self._turntable.release()

    @contextmanager
    def _doing(self, state: RigState) -> Iterator[None]:
        self.state = state
        with self.minding_position():
            yield
        self.state = RigState.IDLE

    @contextmanager
    def minding_position(self) -> Iterator[None]:
        """Take note if a part that is asked where it is has lost its position."""
        try:
            yield
        except PositionLostError:
            self.state, self.position_known = RigState.ALARM, False
            raise

    def _close(self) -> None:
        for part in (self._turntable, self._arm, self._lights, self._camera):
            if part is not None:
                _attempt(part.close)
        if self._lock is not None:
            self._lock.release()


def open_rig(
    config: RigConfig,
    *,
    use: frozenset[str] = frozenset({"turntable", "arm", "lights", "camera"}),
    clock: Clock | None = None,
    environment: Mapping[str, str] | None = None,
    locked: bool = False,
) -> Rig:
    """Open the parts of a rig that RIG.toml names and that are to be used.

    Parameters
    ----------
    use : which parts to open; what is not opened cannot fail
    environment : added to the environment of the camera's process
    locked : the caller holds the rig's lock already

    Raises
    ------
    RigError
        Another litrig uses the rig, or a part is missing or taken; those opened before it are closed again.
    """
    lock = None if locked else lock_rig(config)
    bench = Bench(config, clock or MonotonicClock(), environment or {})
    turntable: Turntable | None = None
    arm: LightArm | None = None
    lights: Lights | None = None
    camera: Camera | None = None
    with ExitStack() as opened:
        if lock is not None:
            opened.callback(lock.release)
        opened.callback(_attempt, bench.close)
        if config.turntable is not None and "turntable" in use:
            turntable = TURNTABLES.open(config.turntable, bench)
            opened.callback(_attempt, turntable.close)
        if config.arm is not None and "arm" in use:
            arm = ARMS.open(config.arm, bench)
            opened.callback(_attempt, arm.close)
        if config.lights is not None and "lights" in use:
            lights = LIGHTS.open(config.lights, bench)
            opened.callback(_attempt, lights.close)
        if config.camera is not None and "camera" in use:
            camera = CAMERAS.open(config.camera, bench)
        opened.pop_all()
    return Rig(config, clock=bench.clock, turntable=turntable, arm=arm, lights=lights, camera=camera, lock=lock)


Part = TypeVar("Part")


def _present(part: Part | None, name: str) -> Part:
    if part is None:
        raise RigError(f"this rig has no {name}: RIG.toml has no [{name}]; add it or use another rig")
    return part


def _attempt(action: Callable[[], None]) -> Exception | None:
    try:
        action()
    except Exception as failure:  # whatever befell one part, the others must be stopped too
        return failure
    return None
