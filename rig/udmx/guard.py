"""A small process that darkens the lamps when the one that lit them was killed outright.

A uDMX has no watchdog: it holds its last values for as long as it has power. So the driver starts this module and holds
its standard input. A line `release` there ends it quietly; if the input closes without, whoever held it has died.
"""

import json
import subprocess
import sys
from collections.abc import Iterable

from rig.clock import MonotonicClock
from rig.errors import RigError
from rig.udmx.backend import load_backend
from rig.udmx.link import UdmxLink

RELEASE = b"release\n"
RELEASE_PATIENCE_S = 5.0
TRIES = 20
PAUSE_S = 0.25


class Guard:
    """The driver's end.

    Parameters
    ----------
    port, usb_backend, usb_address : of the controller, as RIG.toml has them
    slots : to be set to zero
    """

    def __init__(self, port: str | None, usb_backend: str | None, usb_address: str, slots: Iterable[int]) -> None:
        """Start it."""
        self._process = subprocess.Popen(
            [sys.executable, "-m", "rig.udmx.guard"],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,  # what ends the host must not end this
        )
        self._tell(json.dumps([port, usb_backend, usb_address, sorted(slots)]).encode() + b"\n")

    def release(self) -> None:
        """Let it end, the lamps as they are; may be called twice."""
        if self._process.poll() is None:
            self._tell(RELEASE)
            try:
                self._process.wait(RELEASE_PATIENCE_S)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        if self._process.stdin is not None and not self._process.stdin.closed:
            self._process.stdin.close()

    def _tell(self, line: bytes) -> None:
        assert self._process.stdin is not None  # noqa: S101  # opened as a pipe above
        try:
            self._process.stdin.write(line)
            self._process.stdin.flush()
        except BrokenPipeError as error:
            raise RigError("lights: the process that guards the lamps ended by itself; start again") from error


def main() -> int:
    """Wait, and darken the lamps if need be; the status says whether that worked."""
    first = sys.stdin.buffer.readline()
    if sys.stdin.buffer.readline() == RELEASE or not first:
        return 0
    port, usb_backend, usb_address, slots = json.loads(first)
    clock = MonotonicClock()
    for _ in range(TRIES):  # the kernel may not have taken the device from the dead yet
        try:
            link = UdmxLink(port, load_backend(usb_backend, usb_address), clock)
            link.show(dict.fromkeys(slots, 0))
        except RigError:
            clock.sleep(PAUSE_S)
        else:
            link.close()
            return 0
    return 1


if __name__ == "__main__":
    raise SystemExit(main())
