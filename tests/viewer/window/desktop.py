"""A screen that nobody sees, and hands to use it with: Xvfb and xdotool."""

import ctypes
import os
import shutil
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from threading import Event

import numpy as np
import pytest
from numpy.typing import NDArray

Codes = NDArray[np.uint8]
PATIENCE_S = 40.0
MISSING = [program for program in ("Xvfb", "xdotool") if shutil.which(program) is None]
needs_desktop = pytest.mark.skipif(bool(MISSING), reason=f"needs {' and '.join(MISSING)}: apt-get install xvfb xdotool")


class _ClientMessage(ctypes.Structure):
    """XClientMessageEvent, with the room of the largest event."""

    _fields_ = (
        ("type", ctypes.c_int),
        ("serial", ctypes.c_ulong),
        ("send_event", ctypes.c_int),
        ("display", ctypes.c_void_p),
        ("window", ctypes.c_ulong),
        ("message_type", ctypes.c_ulong),
        ("format", ctypes.c_int),
        ("data", ctypes.c_long * 5),
        ("rest", ctypes.c_long * 16),
    )


@dataclass(frozen=True)
class Desktop:
    """A running X server.

    Attributes
    ----------
    display : what DISPLAY is to be
    memory : the file that the server keeps its screen in, as an X window dump
    """

    display: str
    memory: Path

    @property
    def environment(self) -> dict[str, str]:
        return {**os.environ, "DISPLAY": self.display}

    def do(self, *words: str | float) -> str:
        """Act by xdotool, and return what it says."""
        ran = subprocess.run(
            ["xdotool", *map(str, words)],
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=PATIENCE_S,
            check=False,
        )
        assert ran.returncode == 0, ran.stderr
        return ran.stdout

    def drag(self, button: int, start: tuple[int, int], *to: tuple[int, int]) -> None:
        """Press at one place of the screen, move, and let go at the last."""
        moves = [word for place in to for word in ("mousemove", "--sync", *place, "sleep", 0.03)]
        self.do("mousemove", "--sync", *start, "sleep", 0.15, "mousedown", button, "sleep", 0.15)
        self.do(*moves, "sleep", 0.15, "mouseup", button)

    def ask_to_close(self, window: int) -> None:
        """Do what a window manager does when the cross in a window's corner is clicked."""
        x11 = ctypes.CDLL("libX11.so.6")
        x11.XOpenDisplay.restype = ctypes.c_void_p
        x11.XInternAtom.restype = ctypes.c_ulong
        connection = ctypes.c_void_p(x11.XOpenDisplay(self.display.encode()))
        protocols, delete = (x11.XInternAtom(connection, name, 0) for name in (b"WM_PROTOCOLS", b"WM_DELETE_WINDOW"))
        message = _ClientMessage(type=33, window=window, message_type=protocols, format=32)
        message.data[0] = delete
        x11.XSendEvent(connection, ctypes.c_ulong(window), 0, ctypes.c_long(0), ctypes.byref(message))
        x11.XCloseDisplay(connection)

    def screen(self) -> Codes:
        """Return what is on the screen, (H, W, 3)."""
        raw = self.memory.read_bytes()
        header = np.frombuffer(raw[:100], ">u4")
        size, width, height, line, colours = (int(header[place]) for place in (0, 4, 5, 12, 19))
        pixels = np.frombuffer(raw, np.uint8, line * height, size + 12 * colours).reshape(height, line // 4, 4)
        return np.ascontiguousarray(pixels[:, :width, 2::-1])


@contextmanager
def desktop(folder: Path, *options: str, size: tuple[int, int] = (800, 640)) -> Iterator[Desktop]:
    """Start a server on a display that is free, and end it."""
    read, write = os.pipe()
    words = ["Xvfb", "-displayfd", str(write), "-fbdir", str(folder), "-nolisten", "tcp", *options]
    server = subprocess.Popen(
        [*words, "-screen", "0", f"{size[0]}x{size[1]}x24"], pass_fds=[write], stderr=subprocess.DEVNULL
    )
    os.close(write)
    try:
        with os.fdopen(read) as said:
            number = said.readline().strip()
        assert number, "Xvfb found no free display"
        yield Desktop(f":{number}", folder / "Xvfb_screen0")
    finally:
        server.terminate()
        server.wait(PATIENCE_S)


def wait_until(condition: Callable[[], bool], what: str) -> None:
    """Wait for something to be seen."""
    tick = Event()
    for _ in range(int(PATIENCE_S / 0.05)):
        if condition():
            return
        tick.wait(0.05)
    raise AssertionError(f"not seen: {what}")
