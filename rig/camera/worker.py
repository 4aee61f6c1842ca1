"""The process that holds the camera: what can hang lives here, so that it cannot keep the rig from stopping.

It answers one JSON line on its standard output to each on its input, a picture's bytes right behind the line, and dies
with its parent: by the kernel's word even while it hangs in the driver, and by the end of its input otherwise.
"""

import ctypes
import json
import signal
import sys
import time
from collections.abc import Mapping
from typing import Any, BinaryIO

import cv2
import numpy as np

_PR_SET_PDEATHSIG = 1
_MANUAL_EXPOSURE = 1
_EXPOSURE_UNIT_MS = 0.1
_MOST_STALE_FRAMES = 200

_ALLOWED_OFF = {
    "pixel_format": 0.0,
    "width": 0.0,
    "height": 0.0,
    "fps": 0.05,
    "exposure_ms": 0.05,
    "gain": 0.0,
    "white_balance_k": 0.02,
    "focus": 0.02,
}
"""Settings that are read back, and the share by which they may be off: drivers round to their steps."""

Answer = dict[str, Any]


class WorkerError(Exception):
    """Told to the parent as it stands."""


class OpenedCamera:
    """A V4L2 device behind OpenCV."""

    def __init__(self, config: Mapping[str, Any]) -> None:
        self._config = config
        self._exposure_ms: float = config["exposure_ms"]
        self._keeps_jpeg = config["pixel_format"] == "MJPG"
        fourcc = cv2.VideoWriter.fourcc(*config["pixel_format"])
        self._capture = cv2.VideoCapture(config["device"], cv2.CAP_V4L2, [cv2.CAP_PROP_FOURCC, fourcc])
        if not self._capture.isOpened():
            raise WorkerError("cannot be opened as a camera; check cable, device path, and that nobody else uses it")
        # The format as it comes: the camera's own JPEG is kept bit for bit.
        self._set(cv2.CAP_PROP_CONVERT_RGB, 0 if self._keeps_jpeg else 1)

    def configure(self) -> Answer:
        """Set everything in the order that drivers want, and read it back."""
        config = self._config
        self._set(cv2.CAP_PROP_FRAME_WIDTH, config["width"])
        self._set(cv2.CAP_PROP_FRAME_HEIGHT, config["height"])
        if config["fps"] is not None:
            self._set(cv2.CAP_PROP_FPS, config["fps"])
        self._set(cv2.CAP_PROP_AUTO_EXPOSURE, _MANUAL_EXPOSURE)
        self._set(cv2.CAP_PROP_EXPOSURE, round(config["exposure_ms"] / _EXPOSURE_UNIT_MS))
        self._set(cv2.CAP_PROP_AUTO_WB, 0)
        if config["white_balance_k"] is not None:
            self._set(cv2.CAP_PROP_WB_TEMPERATURE, config["white_balance_k"])
        self._set(cv2.CAP_PROP_AUTOFOCUS, 0)
        if config["focus"] is not None:
            self._set(cv2.CAP_PROP_FOCUS, config["focus"])
        if config["gain"] is not None:
            self._set(cv2.CAP_PROP_GAIN, config["gain"])
        self._set(cv2.CAP_PROP_BUFFERSIZE, 1)
        settings = self._settings()
        for key, allowed in _ALLOWED_OFF.items():
            wanted, found = config[key], settings[key]
            if wanted is not None and not _agree(wanted, found, allowed):
                raise WorkerError(f"has {key} = {found}, not {wanted} as RIG.toml asks; choose a value that it knows")
        return settings

    def capture(self, not_before_s: float, exposure_ms: float) -> tuple[Answer, bytes]:
        """Throw away stale frames until one was exposed after the given instant, for that long; return it.

        Noise makes each picture another one: `repeats` tells one that is bit for bit that which came before it.
        """
        if exposure_ms != self._exposure_ms:
            not_before_s = max(not_before_s, self._expose_for(exposure_ms))
        exposure_s, before = exposure_ms / 1000, None
        for _ in range(_MOST_STALE_FRAMES):
            # Some drivers stamp the start of the exposure, others its end: only what holds for both counts.
            stamp_s, picture = self._next()
            if before is not None and stamp_s - exposure_s > not_before_s:
                break
            before = picture
        else:
            raise WorkerError("delivers only pictures from before it was asked; its time stamps are not monotonic time")
        repeats = before is not None and np.array_equal(picture, before)
        times = {"exposed_from_s": stamp_s - exposure_s, "exposed_to_s": stamp_s + exposure_s}
        return {**times, "repeats": repeats, "settings": self._settings()}, self._encode(picture)

    def _next(self) -> tuple[float, np.ndarray[Any, Any]]:
        """Return the next picture of the stream and its time stamp."""
        if not self._capture.grab():
            raise WorkerError("delivers no picture any more; check the cable, then start again")
        stamp_s = self._capture.get(cv2.CAP_PROP_POS_MSEC) / 1000
        good, picture = self._capture.retrieve()
        if not good:
            raise WorkerError("delivers a damaged picture; check the cable")
        return stamp_s, np.asarray(picture)

    def _expose_for(self, exposure_ms: float) -> float:
        """Change the exposure time, and return from when on it holds: what is under way ends as it began."""
        longer_ms = max(exposure_ms, self._exposure_ms)
        self._set(cv2.CAP_PROP_EXPOSURE, round(exposure_ms / _EXPOSURE_UNIT_MS))
        found_ms = self._settings()["exposure_ms"]
        if not _agree(exposure_ms, found_ms, _ALLOWED_OFF["exposure_ms"]):
            raise WorkerError(f"exposes for {found_ms:g} ms, not {exposure_ms:g} as asked; choose a smaller bracket")
        self._exposure_ms = exposure_ms
        return time.monotonic() + longer_ms / 1000

    def release(self) -> None:
        """Give the device back."""
        self._capture.release()

    def _encode(self, picture: np.ndarray[Any, Any]) -> bytes:
        if self._keeps_jpeg:
            return picture.tobytes().rstrip(b"\0")  # drivers pad the buffer
        return cv2.imencode(".png", picture)[1].tobytes()

    def _settings(self) -> Answer:
        get = self._capture.get
        return {
            "pixel_format": int(get(cv2.CAP_PROP_FOURCC)).to_bytes(4, "little").decode("ascii", errors="replace"),
            "width": int(get(cv2.CAP_PROP_FRAME_WIDTH)),
            "height": int(get(cv2.CAP_PROP_FRAME_HEIGHT)),
            "exposure_ms": round(get(cv2.CAP_PROP_EXPOSURE) * _EXPOSURE_UNIT_MS, 3),
            "fps": round(get(cv2.CAP_PROP_FPS), 3),
            "focus": int(get(cv2.CAP_PROP_FOCUS)),
            "gain": int(get(cv2.CAP_PROP_GAIN)),
            "white_balance_k": int(get(cv2.CAP_PROP_WB_TEMPERATURE)),
        }

    def _set(self, control: int, value: float) -> None:
        self._capture.set(control, value)  # what a camera does not know it refuses; the read-back tells


def _agree(wanted: float | str, found: float | str, share: float) -> bool:
    if isinstance(wanted, str) or isinstance(found, str):
        return wanted == found
    return abs(found - wanted) <= max(share * abs(wanted), _EXPOSURE_UNIT_MS if share else 0.0)


def main() -> None:
    """Serve until the input ends."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent to decide about
    serve(sys.stdin.buffer, sys.stdout.buffer)


def serve(commands: BinaryIO, answers: BinaryIO) -> None:
    """Answer each command line."""
    camera: OpenedCamera | None = None
    for line in commands:
        command = json.loads(line)
        answer: Answer
        content = b""
        try:
            if command["do"] == "open":
                if camera is not None:
                    camera.release()
                camera = OpenedCamera(command["config"])
                answer = {"settings": camera.configure()}
            elif camera is None:
                raise WorkerError("not open")  # noqa: TRY301  # told like the others
            else:
                answer, content = camera.capture(command["not_before_s"], command["exposure_ms"])
        except WorkerError as error:
            answer = {"error": str(error)}
        except cv2.error as error:
            answer = {"error": f"OpenCV: {error}"}
        answers.write(json.dumps({**answer, "bytes": len(content)}).encode() + b"\n" + content)
        answers.flush()


if __name__ == "__main__":
    main()
