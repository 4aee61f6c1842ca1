"""What can happen to bytes on their way: nothing comes, it comes late, twice, damaged, or from somebody else."""

import random
from collections import deque
from dataclasses import dataclass, replace
from typing import Protocol

from firmware_sim.dynamixel.config import TurntableFaults
from firmware_sim.dynamixel.packets import BROADCAST, crc16


@dataclass(frozen=True)
class Reply:
    """Bytes, and when they go out."""

    due_s: float
    content: bytes


class ReplyFault(Protocol):
    """One mishap for one reply."""

    def apply(self, reply: Reply) -> list[Reply]:
        """Return what comes of the reply."""


@dataclass(frozen=True)
class Mute:
    """The reply is lost."""

    def apply(self, _: Reply) -> list[Reply]:
        return []


@dataclass(frozen=True)
class Delay:
    """The reply comes late, perhaps when its host has given up and asks the next question."""

    seconds: float

    def apply(self, reply: Reply) -> list[Reply]:
        return [replace(reply, due_s=reply.due_s + self.seconds)]


@dataclass(frozen=True)
class FlipBit:
    """One bit changes on the line; `bit` counts from the packet's first and wraps at its end."""

    bit: int

    def apply(self, reply: Reply) -> list[Reply]:
        return [replace(reply, content=flipped(reply.content, self.bit))]


@dataclass(frozen=True)
class DropByte:
    """One byte is lost; `byte` counts from the packet's first and wraps at its end."""

    byte: int

    def apply(self, reply: Reply) -> list[Reply]:
        return [replace(reply, content=without(reply.content, self.byte))]


@dataclass(frozen=True)
class Duplicate:
    """The reply comes once more, after a while."""

    seconds: float = 0.0

    def apply(self, reply: Reply) -> list[Reply]:
        return [reply, replace(reply, due_s=reply.due_s + self.seconds)]


@dataclass(frozen=True)
class Foreign:
    """Another servo says something else first; `alone`: instead."""

    alone: bool = False

    def apply(self, reply: Reply) -> list[Reply]:
        other = bytearray(reply.content)
        other[4] = (other[4] + 1) % BROADCAST
        for place in range(9, len(other) - 2):
            other[place] ^= 0x55
        other[-2:] = crc16(bytes(other[:-2])).to_bytes(2, "little")
        stranger = replace(reply, content=bytes(other))
        return [stranger] if self.alone else [stranger, reply]


@dataclass(frozen=True)
class Collision:
    """A twin with the same id answers a byte later: where one pulls the line down, it is down."""

    def apply(self, reply: Reply) -> list[Reply]:
        first, second = reply.content + b"\xff", b"\xff" + reply.content
        return [replace(reply, content=bytes(a & b for a, b in zip(first, second, strict=True)))]


def flipped(content: bytes, bit: int) -> bytes:
    """Return bytes with one bit changed."""
    place = bit % (8 * len(content))
    changed = content[place // 8] ^ 1 << place % 8
    return content[: place // 8] + bytes([changed]) + content[place // 8 + 1 :]


def without(content: bytes, byte: int) -> bytes:
    """Return bytes with one left out."""
    place = byte % len(content)
    return content[:place] + content[place + 1 :]


class FaultQueue:
    """Mishaps in waiting, each for one reply, in order; and those that befall a share of all replies.

    Attributes
    ----------
    echo : the host hears what it says
    clash : a twin with the same id talks too
    """

    def __init__(self, shares: TurntableFaults | None = None) -> None:
        self._waiting: deque[ReplyFault] = deque()
        self._deaf_to: deque[int] = deque()
        self.echo = self.clash = False
        self.spread(shares or TurntableFaults())

    def add(self, fault: ReplyFault, replies: int) -> None:
        self._waiting.extend([fault] * replies)

    def lose_heard(self, byte: int, packets: int) -> None:
        """Lose one byte of each of the next packets on their way to the servo."""
        self._deaf_to.extend([byte] * packets)

    def spread(self, shares: TurntableFaults) -> None:
        """Let shares of all replies be struck from now on."""
        self._shares, self._random = shares, random.Random(shares.seed)  # noqa: S311  # mishaps, not secrets

    def clear(self) -> None:
        self._waiting.clear()
        self._deaf_to.clear()
        self.echo = self.clash = False
        self.spread(TurntableFaults())

    def heard(self, content: bytes) -> bytes:
        """Return what of the host's bytes reaches the servo."""
        return without(content, self._deaf_to.popleft()) if content and self._deaf_to else content

    def befall(self, reply: Reply) -> list[Reply]:
        """Return what comes of a reply."""
        if self._waiting:
            return self._waiting.popleft().apply(reply)
        if self.clash:
            return Collision().apply(reply)
        fault = self._by_chance()
        return fault.apply(reply) if fault else [reply]

    def _by_chance(self) -> ReplyFault | None:
        shares, chance = self._shares, self._random
        for share, fault in (
            (shares.flip, FlipBit(chance.randrange(1 << 16))),
            (shares.drop, DropByte(chance.randrange(1 << 16))),
            (shares.mute, Mute()),
            (shares.duplicate, Duplicate()),
            (shares.delay, Delay(shares.delay_s)),
            (shares.foreign, Foreign()),
            (shares.wrong_id, Foreign(alone=True)),
        ):
            if share and chance.random() < share:
                return fault
        return None
