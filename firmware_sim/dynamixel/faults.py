"""What can happen to the replies on their way: nothing comes, it comes late, a bit is wrong."""

from collections import deque
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True)
class Reply:
    """Bytes, and when they go out."""

    due_s: float
    content: bytes


class ReplyFault(Protocol):
    """One mishap for one reply."""

    def apply(self, reply: Reply) -> Reply | None:
        """Return what comes of the reply; None if nothing does."""


@dataclass(frozen=True)
class Mute:
    """The reply is lost."""

    def apply(self, _: Reply) -> Reply | None:
        return None


@dataclass(frozen=True)
class Delay:
    """The reply comes late, perhaps when its host has given up and asks the next question."""

    seconds: float

    def apply(self, reply: Reply) -> Reply | None:
        return Reply(reply.due_s + self.seconds, reply.content)


@dataclass(frozen=True)
class FlipBit:
    """One bit changes on the line; `bit` counts from the packet's first and wraps at its end."""

    bit: int

    def apply(self, reply: Reply) -> Reply | None:
        content = bytearray(reply.content)
        place = self.bit % (8 * len(content))
        content[place // 8] ^= 1 << place % 8
        return Reply(reply.due_s, bytes(content))


class FaultQueue:
    """Mishaps in waiting: each befalls one reply, in order."""

    def __init__(self) -> None:
        self._waiting: deque[ReplyFault] = deque()

    def add(self, fault: ReplyFault, replies: int) -> None:
        self._waiting.extend([fault] * replies)

    def clear(self) -> None:
        self._waiting.clear()

    def befall(self, reply: Reply) -> Reply | None:
        return self._waiting.popleft().apply(reply) if self._waiting else reply
