"""A V4L2 camera, held by a worker process that may hang without harm."""

import json
import os
import select
import subprocess
import sys
from collections.abc import Mapping
from typing import Any

from rig.clock import Clock
from rig.config import CameraConfig
from rig.devices import Shot
from rig.errors import CameraError, CameraHangsError
from rig.serial_port import holders

ENDINGS = {"MJPG": ".jpg", "YUYV": ".png"}
START_S = 20.0
LARGEST_PICTURE_BYTES = 256_000_000
_CHUNK_BYTES = 1 << 20


class V4l2Camera:
    """Fits `rig.devices.Camera`."""

    def __init__(self, config: CameraConfig, clock: Clock, environment: Mapping[str, str] | None = None) -> None:
        """Start the worker; `environment` adds to what it inherits."""
        self._config, self._clock = config, clock
        self._environment = {**os.environ, **(environment or {})}
        self._pending = b""
        self._worker = self._start_worker()

    def configure(self) -> Mapping[str, float | str]:
        """Open the camera with the settings of RIG.toml; exposure, white balance and focus become manual.

        A worker that ended, or was ended because the camera hung, is started anew.

        Raises
        ------
        CameraError
            There is none, it is taken, or it does not do what RIG.toml asks.
        """
        if self._worker.poll() is not None:
            self.close()
            self._worker, self._pending = self._start_worker(), b""
        try:
            answer, _ = self._ask({"do": "open", "config": self._config.model_dump()}, START_S)
        except CameraError as error:
            users = holders(self._config.device)
            raise CameraError(f"{error}; held by {users}" if users else str(error)) from error
        settings: Mapping[str, float | str] = answer["settings"]
        return settings

    def capture(self, not_before_s: float, exposure_ev: float = 0.0) -> Shot:
        """Take a picture that was exposed after an instant, so many stops longer than RIG.toml says.

        Raises
        ------
        CameraError
            The camera hangs (its worker is ended then), was unplugged, or delivers no picture.
        """
        exposure_ms = self._config.exposure_ms * 2**exposure_ev
        timeout_s = exposure_ms / 1000 + self._config.timeout_s
        command = {"do": "capture", "not_before_s": not_before_s, "exposure_ms": exposure_ms}
        answer, content = self._ask(command, timeout_s)
        return Shot(
            content,
            ENDINGS[self._config.pixel_format],
            answer["exposed_from_s"],
            answer["exposed_to_s"],
            answer["settings"],
            answer["repeats"],
        )

    def close(self) -> None:
        """End the worker, hanging or not."""
        self._worker.kill()
        self._worker.wait()
        for stream in (self._worker.stdin, self._worker.stdout):
            if stream is not None:
                stream.close()

    def _start_worker(self) -> "subprocess.Popen[bytes]":
        return subprocess.Popen(
            [sys.executable, "-m", "rig.camera.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=self._environment,
            start_new_session=True,  # Ctrl-C in the terminal must not take the picture away
        )

    def _ask(self, command: Mapping[str, Any], timeout_s: float) -> tuple[dict[str, Any], bytes]:
        assert self._worker.stdin is not None  # noqa: S101  # opened as a pipe above
        deadline_s = self._clock.now_s() + timeout_s
        try:
            self._worker.stdin.write(json.dumps(command).encode() + b"\n")
            self._worker.stdin.flush()
        except OSError as error:
            raise CameraError(f"camera {self._config.device}: its process ended; start again") from error
        while b"\n" not in self._pending:
            self._receive(deadline_s)
        line, self._pending = self._pending.split(b"\n", 1)
        answer = json.loads(line)
        if not 0 <= answer["bytes"] <= LARGEST_PICTURE_BYTES:
            raise CameraError(f"camera {self._config.device}: announces a picture of {answer['bytes']} bytes; refused")
        while len(self._pending) < answer["bytes"]:
            self._receive(deadline_s)
        content, self._pending = self._pending[: answer["bytes"]], self._pending[answer["bytes"] :]
        if "error" in answer:
            raise CameraError(f"camera {self._config.device}: {answer['error']}")
        return answer, content

    def _receive(self, deadline_s: float) -> None:
        assert self._worker.stdout is not None  # noqa: S101  # opened as a pipe above
        descriptor = self._worker.stdout.fileno()
        ready, _, _ = select.select([descriptor], [], [], max(0.0, deadline_s - self._clock.now_s()))
        if not ready:
            self._worker.kill()
            raise CameraHangsError(
                f"camera {self._config.device}: no picture within {self._config.timeout_s:g} s; it hangs, unplug it "
                "and plug it in again"
            )
        arrived = os.read(descriptor, _CHUNK_BYTES)
        if not arrived:
            raise CameraError(f"camera {self._config.device}: its process ended; check the camera, then start again")
        self._pending += arrived
