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
from firmware_sim.side_channel import Answer, Handler, SideChannelServer
from firmware_sim.wire import Wire

CONFIG_NAME, FRAMES_NAME, CHANNEL_NAME, RIG_NAME, LOG_NAME = (
    "sim.json",
    "frames.bin",
    "side-channel.sock",
    "RIG.toml",
    "server.log",
)
LONGEST_WAIT_S = 0.05
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}


class Server:
    """One loop over everything that can have something to say."""

    def __init__(self, config: SimConfig, folder: Path, shared: SharedFrame, clock: Clock) -> None:
        self._clock = clock
        self._shared = shared
        self._running = True
        self._devices = Devices(config, clock)
        self._wires = {"turntable": Wire(self._devices.bus, clock), "arm": Wire(self._devices.arm, clock)}
        self._channel = SideChannelServer(folder / CHANNEL_NAME, self._handlers())

    @property
    def ports(self) -> dict[str, str]:
        return {name: wire.path for name, wire in self._wires.items()}

    def stop(self) -> None:
        self._running = False

    def run(self, studio: "subprocess.Popen[bytes]") -> None:
        """Serve until standard input closes, somebody asks for the end, or the camera's process is lost."""
        while self._running:
            for wire in self._wires.values():
                wire.service()
            if studio.poll() is not None:
                raise SimServerError(f"the camera's process ended by itself with status {studio.returncode}")
            for ready in self._wait():
                if isinstance(ready, socket.socket):
                    self._channel.serve(ready)
                elif ready == sys.stdin.fileno():
                    self._running = False

    def close(self) -> None:
        self._channel.close()
        for wire in self._wires.values():
            wire.close()

    def _wait(self) -> list[int | socket.socket]:
        due_s = [due for wire in self._wires.values() if (due := wire.due_s()) is not None]
        wait_s = min([LONGEST_WAIT_S, *(max(0.0, due - self._clock()) for due in due_s)])
        sources = [sys.stdin.fileno(), *(wire.master for wire in self._wires.values()), *self._channel.sockets()]
        # Unlike epoll, select waits for fractions of a millisecond.
        with selectors.SelectSelector() as selector:
            for source in sources:
                selector.register(source, selectors.EVENT_READ)
            return [key.fileobj for key, _ in selector.select(wait_s)]  # type: ignore[misc] # what we registered

    def _handlers(self) -> dict[str, Handler]:
        own: dict[str, Handler] = {"status": self._status, "poses": self._poses, "shutdown": self._shutdown}
        faults = (turntable_faults(self._devices), arm_faults(self._devices), camera_faults(self._shared))
        for table in faults:
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
            "turntable_moving": self._devices.servo.is_turning(),
            "azimuth_deg": azimuth_deg,
            "elevation_deg": elevation_deg,
            "arm_state": self._devices.arm.state,
            "lamp": lamp,
            "camera": camera,
            "wires": {name: {"port": wire.path, "recent": wire.recent()} for name, wire in self._wires.items()},
        }

    @validate_call
    def _poses(self, at: list[float]) -> Answer:
        return {"poses": [self._devices.pose(time_s) for time_s in at]}

    @validate_call
    def _shutdown(self) -> Answer:
        self.stop()
        return {}


@contextmanager
def _studio(folder: Path) -> Iterator["subprocess.Popen[bytes]"]:
    """Run the camera's process; it ends with the standard input that we hold."""
    paths = {"--config": CONFIG_NAME, "--frames": FRAMES_NAME, "--channel": CHANNEL_NAME}
    options = [word for option, name in paths.items() for word in (option, str(folder / name))]
    command = [sys.executable, "-m", "firmware_sim.studio", *options]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, env=os.environ | ONE_THREAD)
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


def serve(folder: Path) -> None:
    """Play the devices that `folder` describes, and say on standard output where they are.

    Parameters
    ----------
    folder : holds the configuration as JSON; what is made beside it is removed at the end
    """
    with suppress(PermissionError):
        os.nice(-5)  # hosts give up after some milliseconds; real firmware has its processor for itself
    config = SimConfig.model_validate_json((folder / CONFIG_NAME).read_text("utf-8"))
    with ExitStack() as stack:
        shared = stack.enter_context(SharedFrame(folder / FRAMES_NAME, create=True))
        stack.callback((folder / FRAMES_NAME).unlink, missing_ok=True)
        shared["best_focus"] = config.camera.best_focus
        server = Server(config, folder, shared, monotonic_s)
        stack.callback(server.close)
        for number in (signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, lambda *_: server.stop())
        studio = stack.enter_context(_studio(folder))
        sys.stdout.write(json.dumps(server.ports) + "\n")
        sys.stdout.flush()
        server.run(studio)


def main() -> None:
    """Serve until the parent lets go."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, required=True)
    serve(parser.parse_args().folder)


if __name__ == "__main__":
    main()
