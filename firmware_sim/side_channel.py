"""The side channel: JSON lines over a Unix socket, to look behind the devices and to break them.

A request is `{"do": NAME, …parameters}`; the answer is a JSON object, with the key `error` if the request was refused.
"""

import json
import socket
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from pydantic import ValidationError

from firmware_sim.errors import SideChannelError, SimError

Answer = dict[str, Any]
Handler = Callable[..., Answer]
LONGEST_LINE_BYTES = 100_000
PATIENCE_S = 5.0


class SideChannel:
    """The client's end. One request at a time; connects when first asked.

    Parameters
    ----------
    path : the socket that the simulator listens on
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._socket: socket.socket | None = None
        self._pending = b""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def request(self, do: str, **parameters: object) -> Answer:
        """Ask for one thing and wait for the answer.

        Raises
        ------
        SideChannelError
            Nobody answers there, or the request was refused.
        """
        try:
            self._connected().sendall(json.dumps({"do": do, **parameters}).encode() + b"\n")
            answer: Answer = json.loads(self._line())
        except (OSError, ValueError) as error:
            self.close()
            raise SideChannelError(f"{self.path}: the simulator does not answer ({error}); is it running?") from error
        if "error" in answer:
            raise SideChannelError(f"{do}: {answer['error']}")
        return answer

    def status(self) -> Answer:
        """Return poses, lamp, counters of the camera, and the last bytes of each wire with their times."""
        return self.request("status")

    def shutdown(self) -> None:
        """Ask the simulator to end."""
        self.request("shutdown")

    def _connected(self) -> socket.socket:
        if self._socket is None:
            self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
            self._socket.settimeout(PATIENCE_S)
            self._socket.connect(str(self.path))
            self._pending = b""
        return self._socket

    def _line(self) -> bytes:
        while b"\n" not in self._pending:
            received = self._connected().recv(65536)
            if not received:
                raise ConnectionError("the connection was closed")
            self._pending += received
        line, self._pending = self._pending.split(b"\n", 1)
        return line


class SideChannelServer:
    """The simulator's end. It owns its sockets; the server's loop says when one has something."""

    def __init__(self, path: Path, handlers: Mapping[str, Handler]) -> None:
        self._path = path
        self._handlers = handlers
        self._pending: dict[socket.socket, bytes] = {}
        self._listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._listener.bind(str(path))
        self._listener.listen()

    def sockets(self) -> list[socket.socket]:
        return [self._listener, *self._pending]

    def serve(self, ready: socket.socket) -> None:
        """Take a new connection, or the requests that have come over an old one."""
        if ready is self._listener:
            connection, _ = self._listener.accept()
            connection.settimeout(PATIENCE_S)
            self._pending[connection] = b""
            return
        try:
            received = ready.recv(65536)
            if not received or len(self._pending[ready]) > LONGEST_LINE_BYTES:
                self._drop(ready)
                return
            *lines, self._pending[ready] = (self._pending[ready] + received).split(b"\n")
            for line in lines:
                ready.sendall(json.dumps(self._answer(line)).encode() + b"\n")
        except OSError:  # the client went away in the middle: its loss
            self._drop(ready)

    def close(self) -> None:
        for connection in list(self._pending):
            self._drop(connection)
        self._listener.close()
        self._path.unlink(missing_ok=True)

    def _drop(self, connection: socket.socket) -> None:
        with suppress(KeyError):
            del self._pending[connection]
        connection.close()

    def _answer(self, line: bytes) -> Answer:
        try:
            request = json.loads(line)
            name = request.pop("do")
            handler = self._handlers[name]
        except (ValueError, AttributeError, KeyError):
            return {"error": f"not a request; known are {', '.join(sorted(self._handlers))}"}
        try:
            return handler(**request)
        except ValidationError as error:
            return {"error": "; ".join(f"{_place(item['loc'])}: {item['msg']}" for item in error.errors())}
        except SimError as error:
            return {"error": str(error)}


def _place(place: tuple[int | str, ...]) -> str:
    return ".".join(str(part) for part in place)
