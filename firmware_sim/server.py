"""The simulator's process: pseudo-terminals, side channel, and the camera's process as its child.

Started by `firmware_sim.launch`, which holds its standard input: when that closes, all of this ends.
"""

import argparse
import json
import os
import selectors
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from pydantic import validate_call

from firmware_sim.camera.shared_frame import SharedFrame
from firmware_sim.clock import Clock, monotonic_s
from firmware_sim.config import SimConfig
from firmware_sim.devices import Devices
from firmware_sim.errors import SimServerError
from firmware_sim.faults import arm_faults, camera_faults, turntable_faults
from firmware_sim.mitsuba.config import MitsubaScene
from firmware_sim.render_queue import RenderQueue
from firmware_sim.render_requests import render_requests
from firmware_sim.resting import last_elsewhere_s
from firmware_sim.scene.pose import Pose
from firmware_sim.scene.rendering import note_on, relevance_of, room_for
from firmware_sim.side_channel import Answer, Handler, SideChannelServer
from firmware_sim.udmx.faults import lights_faults
from firmware_sim.udmx.usb_server import UsbServer
from firmware_sim.wire import Wire

CONFIG_NAME, FRAMES_NAME, CHANNEL_NAME, USB_NAME, RIG_NAME, LOG_NAME = (
    "sim.json",
    "frames.bin",
    "side-channel.sock",
    "usb.sock",
    "RIG.toml",
    "server.log",
)
LONGEST_WAIT_S = 0.05
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}


Process = subprocess.Popen[bytes]


class Server:
    """One loop over everything that can have something to say."""

    def __init__(
        self, config: SimConfig, folder: Path, shared: SharedFrame, clock: Clock, renders: RenderQueue
    ) -> None:
        self._config = config
        self._folder = folder
        self._clock = clock
        self._shared = shared
        self._renders = renders
        self._relevance = relevance_of(config.scene)
        self._running = True
        self._devices = Devices(config, clock)
        self._wires = {"turntable": Wire(self._devices.bus, clock), "arm": Wire(self._devices.grbl.arm, clock)}
        if self._devices.grbl.table is not None:
            self._wires["stepper"] = Wire(self._devices.grbl.table, clock)
        self._schedule()
        self._channel = SideChannelServer(folder / CHANNEL_NAME, self._handlers())
        self._usb = UsbServer(folder / USB_NAME, self._devices.usb)

    def _schedule(self) -> None:
        """Note when a supply is to fail."""
        grbl, config = self._devices.grbl, self._config
        pairs = ((grbl.arm, config.arm.faults), (grbl.table, config.stepper.faults if config.stepper else None))
        self._losses = [
            (self._clock() + faults.power_loss_at_s, wire.controller, faults.power_loss_s)
            for wire, faults in pairs
            if wire is not None and faults is not None and faults.power_loss_at_s is not None
        ]

    def _lose_power_if_due(self) -> None:
        for loss in [loss for loss in self._losses if loss[0] <= self._clock()]:
            self._losses.remove(loss)
            loss[1].lose_power(loss[2])

    @property
    def ports(self) -> dict[str, str]:
        return {name: wire.path for name, wire in self._wires.items()}

    def stop(self) -> None:
        self._running = False

    def run(self, studio: Process, darkroom: Process | None) -> None:
        """Serve until standard input closes, somebody asks for the end, or the camera's process is lost.

        Without the renderer the devices go on; who asks for progress is told that it is lost.
        """
        while self._running:
            self._lose_power_if_due()
            for wire in self._wires.values():
                wire.service()
            if studio.poll() is not None:
                raise SimServerError(f"the camera's process ended by itself with status {studio.returncode}")
            if darkroom is not None and darkroom.poll() is not None:
                words = self._last_words()
                self._renders.fail(
                    f"the renderer ended by itself with status {darkroom.returncode} ({words}); start again"
                )
                darkroom = None
            for ready in self._wait():
                if isinstance(ready, socket.socket):
                    (self._usb if ready in self._usb.sockets() else self._channel).serve(ready)
                elif ready == sys.stdin.fileno():
                    self._running = False

    def _last_words(self) -> str:
        """Return the last line that a child of ours has written, for the log may go with its folder."""
        words = (self._folder / LOG_NAME).read_text("utf-8", errors="replace").strip().splitlines()
        return words[-1] if words else "it said nothing"

    def close(self) -> None:
        self._channel.close()
        self._usb.close()
        for wire in self._wires.values():
            wire.close()

    def _wait(self) -> list[int | socket.socket]:
        due_s = [due for wire in self._wires.values() if (due := wire.due_s()) is not None]
        wait_s = min([LONGEST_WAIT_S, *(max(0.0, due - self._clock()) for due in due_s)])
        sources = [sys.stdin.fileno(), *(wire.master for wire in self._wires.values())]
        sources += [*self._channel.sockets(), *self._usb.sockets()]
        # Unlike epoll, select waits for fractions of a millisecond.
        with selectors.SelectSelector() as selector:
            for source in sources:
                selector.register(source, selectors.EVENT_READ)
            return [key.fileobj for key, _ in selector.select(wait_s)]  # type: ignore[misc] # what we registered

    def _handlers(self) -> dict[str, Handler]:
        own: dict[str, Handler] = {"status": self._status, "shutdown": self._shutdown}
        own |= {"poses": self._poses, "poses.before": self._poses_before}
        faults = [turntable_faults(self._devices), arm_faults(self._devices), camera_faults(self._shared)]
        faults.append(lights_faults(self._devices.usb, self._devices.dome))
        renders = render_requests(self._renders, self._config, lambda: Pose(*self._devices.pose(self._clock())))
        for table in (*faults, renders):
            own |= table
        return own

    @validate_call
    def _status(self) -> Answer:
        now_s = self._clock()
        turntable_deg, azimuth_deg, elevation_deg, lamp = self._devices.pose(now_s)
        camera = {name: self._shared[name] for name in ("streaming", "delivered", "dropped", "number")}
        return {
            "time_s": now_s,
            "turntable_deg": turntable_deg,
            "turntable_moving": self._devices.turntable_is_moving(),
            "azimuth_deg": azimuth_deg,
            "elevation_deg": elevation_deg,
            "arm_state": self._devices.arm.state,
            "lamp": lamp,
            "camera": camera,
            "render": self._renders.progress(),
            "dome": self._devices.shining(now_s),
            "usb": [plugged.as_status() for plugged in self._devices.usb.devices],
            "wires": {name: {"port": wire.path, "recent": wire.recent()} for name, wire in self._wires.items()},
        }

    @validate_call
    def _poses(self, at: list[float]) -> Answer:
        return {"poses": [self._pose(time_s) for time_s in at]}

    @validate_call
    def _poses_before(self, at: float) -> Answer:
        """Return an instant before the pose of a time at rest was reached."""
        return {"time_s": last_elsewhere_s(self._pose, at)}

    def _pose(self, time_s: float) -> Pose:
        """Return the pose as far as the camera can see it."""
        return self._relevance.of(Pose(*self._devices.pose(time_s), self._devices.shining(time_s)))

    @validate_call
    def _shutdown(self) -> Answer:
        self.stop()
        return {}


@contextmanager
def _child(module: str, environment: dict[str, str], **options: Path | str) -> Iterator[Process]:
    """Run one of our modules; it ends with the standard input that we hold."""
    words = [word for name, value in options.items() for word in (f"--{name}", str(value))]
    process = subprocess.Popen(
        [sys.executable, "-m", module, *words], stdin=subprocess.PIPE, env=os.environ | environment
    )
    try:
        yield process
    finally:
        process.terminate()
        try:
            process.wait(timeout=2)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        if process.stdin is not None:
            process.stdin.close()


def serve(folder: Path, cache: Path, variant: str) -> None:
    """Play the devices that `folder` describes, and say on standard output where they are.

    Parameters
    ----------
    folder : holds the configuration as JSON; what is made beside it is removed at the end
    cache : folder of all rendered pictures
    variant : of mitsuba, if it is needed
    """
    with suppress(PermissionError):
        os.nice(-5)  # hosts give up after some milliseconds; real firmware has its processor for itself
    config = SimConfig.model_validate_json((folder / CONFIG_NAME).read_text("utf-8"))
    room = room_for((config.camera.height, config.camera.width))
    files = {"config": folder / CONFIG_NAME, "channel": folder / CHANNEL_NAME, "cache": cache}
    with ExitStack() as stack:
        shared = stack.enter_context(SharedFrame(folder / FRAMES_NAME, create=True))
        stack.callback((folder / FRAMES_NAME).unlink, missing_ok=True)
        shared["best_focus"] = config.camera.best_focus
        server = Server(config, folder, shared, monotonic_s, RenderQueue(room, note_on(variant)))
        stack.callback(server.close)
        for number in (signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, lambda *_: server.stop())
        studio = stack.enter_context(
            _child("firmware_sim.studio", ONE_THREAD, **files, frames=folder / FRAMES_NAME, variant=variant)
        )
        darkroom = None
        if isinstance(config.scene, MitsubaScene):
            darkroom = stack.enter_context(_child("firmware_sim.darkroom", {}, **files, variant=variant))
        sys.stdout.write(json.dumps(server.ports) + "\n")
        sys.stdout.flush()
        server.run(studio, darkroom)


def main() -> None:
    """Serve until the parent lets go."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, required=True)
    parser.add_argument("--cache", type=Path, required=True)
    parser.add_argument("--variant", default="")
    arguments = parser.parse_args()
    serve(arguments.folder, arguments.cache, arguments.variant)


if __name__ == "__main__":
    main()
