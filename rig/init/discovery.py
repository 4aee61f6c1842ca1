"""What is plugged in: serial ports and what answers on them, and cameras that deliver a picture."""

import contextvars
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TypeVar

import serial
from serial.tools import list_ports

from rig.camera.v4l2 import V4l2Camera
from rig.clock import Clock, MonotonicClock
from rig.config import CameraConfig
from rig.doctor.controller_wire import BAUD, BOOT_S, ControllerWire
from rig.doctor.servo import USUAL_BAUDS
from rig.doctor.servo_wire import TRIES, ServoWire
from rig.errors import CameraError, PortError
from rig.serial_port import open_serial

WINDOW_S = 0.3
LONG_WINDOW_S = 0.85
CAMERA_PATIENCE_S = 5.0
CAMERA_FORMS: Sequence[tuple[int, int, str]] = (
    (1280, 720, "MJPG"),
    (640, 480, "MJPG"),
    (1280, 720, "YUYV"),
    (640, 480, "YUYV"),
)
"""Tried in this order: the camera's own JPEG is kept bit for bit."""


@dataclass(frozen=True)
class FoundServos:
    """A bus of Dynamixel servos: model numbers by id."""

    port: str
    baud: int
    models: Mapping[int, int]


@dataclass(frozen=True)
class FoundController:
    """A GRBL controller, what it calls itself, and its `$` settings."""

    port: str
    version: str
    settings: Mapping[int, float]


@dataclass(frozen=True)
class FoundCamera:
    """A camera that delivered a picture in this form."""

    config: CameraConfig


@dataclass(frozen=True)
class Silent:
    """A path that nothing known answers on, and why not."""

    path: str
    reason: str


@dataclass(frozen=True)
class Discovery:
    """Everything that was found."""

    servos: tuple[FoundServos, ...] = ()
    controllers: tuple[FoundController, ...] = ()
    cameras: tuple[FoundCamera, ...] = ()
    silent: tuple[Silent, ...] = field(default=())


Found = FoundServos | FoundController | FoundCamera | Silent
Item = TypeVar("Item")


def discover(ports: Iterable[str], cameras: Iterable[str], environment: Mapping[str, str] | None = None) -> Discovery:
    """Ask at every path, all ports side by side. Nothing moves.

    Parameters
    ----------
    ports : device paths of serial ports
    cameras : device paths
    environment : added to the environment of the camera's process
    """
    clock = MonotonicClock()
    jobs: list[Callable[[], Found]] = [partial(ask_port, path, clock) for path in ports]
    jobs += [partial(ask_camera, path, clock, environment or {}) for path in cameras]
    with ThreadPoolExecutor(max_workers=max(1, len(jobs))) as pool:
        runs = [pool.submit(contextvars.copy_context().run, job) for job in jobs]
        found = [run.result() for run in runs]
    return Discovery(_of(FoundServos, found), _of(FoundController, found), _of(FoundCamera, found), _of(Silent, found))


def serial_ports(folder: Path = Path("/dev/serial/by-id")) -> list[str]:
    """Return the serial ports of this machine, by the names that survive replugging where there are any."""
    by_id = {str(link.resolve()): str(link) for link in sorted(folder.glob("*"))}
    return [by_id.get(info.device, info.device) for info in sorted(list_ports.comports()) if info.vid is not None]


def camera_devices(folder: Path = Path("/dev")) -> list[str]:
    """Return the video devices of this machine, likewise; many cameras have a second one without pictures."""
    by_id = {str(link.resolve()): str(link) for link in sorted((folder / "v4l/by-id").glob("*"))}
    devices = sorted(folder.glob("video[0-9]*"), key=lambda path: int(path.name[5:]))
    return [by_id.get(str(device), str(device)) for device in devices]


def ask_port(path: str, clock: Clock) -> Found:
    """Ask a port who is there: GRBL first, which a question mark does no harm to; nor does it to a servo."""
    try:
        with closing(open_serial(path, BAUD)) as port:
            controller = ControllerWire(port, clock)
            if controller.state(BOOT_S / 3):
                return FoundController(path, controller.version(), controller.settings())
            for baud in USUAL_BAUDS:
                if models := _models(port, baud, clock):
                    return FoundServos(path, baud, models)
            port.baudrate = BAUD
            if controller.state(BOOT_S):  # a board that boots long after its port was opened
                return FoundController(path, controller.version(), controller.settings())
    except PortError as error:
        return Silent(path, str(error).removeprefix(f"{path}: "))
    except (serial.SerialException, OSError) as error:
        return Silent(path, f"went away ({error})")
    return Silent(path, "opens, but neither a servo nor a GRBL controller answers")


def ask_camera(path: str, clock: Clock, environment: Mapping[str, str]) -> Found:
    """Find a form in which the camera delivers a picture."""
    reason = ""
    for width, height, pixel_format in CAMERA_FORMS:
        config = CameraConfig.model_validate(
            {"device": path, "width": width, "height": height, "pixel_format": pixel_format}
        )
        camera = V4l2Camera(config.model_copy(update={"timeout_s": CAMERA_PATIENCE_S}), clock, environment)
        try:
            camera.configure()
            camera.capture(clock.now_s())
        except CameraError as error:
            reason = reason or str(error).removeprefix(f"camera {path}: ")
            if "cannot be opened" in reason:
                break
        else:
            return FoundCamera(config)
        finally:
            camera.close()
    return Silent(path, reason)


def _models(port: serial.Serial, baud: int, clock: Clock) -> Mapping[int, int]:
    """Ping at a baud rate; where anybody answers, long enough for all, and again, for an answer may be lost."""
    try:
        port.baudrate = baud
    except (serial.SerialException, OSError, ValueError):  # the adapter does not have it
        return {}
    wire = ServoWire(port, clock)
    models: dict[int, int] = {}
    heard = wire.ping_all(WINDOW_S)
    if heard.statuses or heard.is_damaged:
        for _ in range(TRIES):
            heard = wire.ping_all(LONG_WINDOW_S)
            models |= {
                status.servo_id: int.from_bytes(status.content[:2], "little")
                for status in heard.statuses
                if len(status.content) >= 3
            }
            if models and not heard.is_damaged:
                break
    return dict(sorted(models.items()))


def _of(kind: type[Item], found: Iterable[object]) -> tuple[Item, ...]:
    return tuple(item for item in found if isinstance(item, kind))
