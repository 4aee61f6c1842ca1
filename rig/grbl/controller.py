"""A conversation with a GRBL 1.1 controller: one line in flight, each answered before the next is sent."""

from collections.abc import Callable
from contextlib import suppress
from typing import TypeVar

import serial

from rig.clock import Clock
from rig.errors import DeviceError, GarbledReplyError, LinkError, LinkTimeoutError, PositionLostError, RigError
from rig.grbl import codec
from rig.grbl.codec import Alarm, Axes, Ok, Refusal, Reply, Status, Text
from rig.serial_port import open_serial

BOOT_S = 3.0
ANSWER_S = 1.0
STOP_S = 2.0
PATIENCE_S = 0.2
RESETS = 3
BRAKING_STATES = ("Run", "Jog", "Hold:1")
POLL_S = 0.002
LONGEST_LINE = 4096

Picked = TypeVar("Picked")


class GrblController:
    """The controller behind a serial port; arm and lamp share it."""

    def __init__(self, path: str, baud: int, clock: Clock) -> None:
        """Open the port and wait until the controller answers: opening resets many boards, which then boot.

        Raises
        ------
        PortError, LinkTimeoutError
            No port, or silence.
        """
        self.name = f"GRBL controller on {path}"
        self._clock = clock
        self._port: serial.Serial = open_serial(path, baud)
        self._pending = b""
        self._work_offset: Axes | None = None
        try:
            self._wait_for_boot()
        except LinkError:
            self._port.close()
            raise

    def command(self, line: bytes, timeout_s: float = ANSWER_S) -> None:
        """Send one line and wait for its `ok`.

        Raises
        ------
        DeviceError, PositionLostError
            It was refused, or ended in an alarm.
        LinkTimeoutError
            No answer in time.
        """
        self._drain()
        self._write(line)
        deadline_s = self._clock.now_s() + timeout_s
        what = line.decode("ascii").strip()
        while True:
            match self._next_reply(deadline_s, what):
                case Ok():
                    return
                case Refusal() as refusal:
                    raise DeviceError(f"{self.name}: {what}: {refusal}; home it, and check limits and settings")
                case Alarm() as alarm:
                    raise self._alarm_error(what, alarm)
                case _:
                    continue

    def status(self, timeout_s: float = ANSWER_S) -> Status:
        """Ask for a report; works at any time, moving or not. The machine position is always filled in."""
        for _ in range(3):
            self._drain()
            self._write(codec.STATUS_REPORT)
            try:
                report = self._await(lambda reply: reply if isinstance(reply, Status) else None, timeout_s, "?")
            except GarbledReplyError:
                continue
            self._work_offset = report.work_offset or self._work_offset
            if report.machine is None and report.work is not None and self._work_offset is not None:
                sums = (a + b for a, b in zip(report.work, self._work_offset, strict=True))
                return Status(report.state, Axes(*sums), report.work, self._work_offset)
            if report.machine is not None:
                return report
        raise GarbledReplyError(f"{self.name}: no usable status report; check the cable, and set $10=3")

    def finish_motion(self, timeout_s: float) -> None:
        """Wait until the planner is empty: the `ok` of a dwell comes when all before it is done."""
        self.command(b"G4 P0\n", timeout_s)

    def halt(self) -> None:
        """Brake now, keeping the position; then clear what was planned. Safe at any time, and twice.

        A feed hold brakes within the acceleration. A soft reset after it empties the planner and darkens the lamp, and
        the position stays known, since nothing moves any more. Homing hears neither hold nor question: the
        reset ends it, and the position is unknown.
        """
        self._write(codec.FEED_HOLD)
        deadline_s = self._clock.now_s() + STOP_S
        with suppress(RigError):  # whatever it says or fails to say, the reset follows
            while self.status(PATIENCE_S).state in BRAKING_STATES and self._clock.now_s() < deadline_s:
                self._clock.sleep(0.02)
        self.reset()

    def reset(self) -> None:
        """Reset softly, and wait for the banner. After an alarm it is deaf for a while."""
        for _ in range(RESETS):
            self._forget()
            self._write(codec.SOFT_RESET)
            try:
                self._await(lambda reply: reply if _is_banner(reply) else None, ANSWER_S, "reset")
            except LinkTimeoutError:
                continue
            return
        raise LinkTimeoutError(f"{self.name}: does not come back from a reset; switch it off and on")

    def close(self) -> None:
        """Give the port back."""
        self._port.close()

    def _wait_for_boot(self) -> None:
        deadline_s = self._clock.now_s() + BOOT_S
        while True:
            try:
                self.status()
            except (LinkTimeoutError, GarbledReplyError):
                if self._clock.now_s() > deadline_s:
                    raise LinkTimeoutError(
                        f"{self.name}: silent; check its power and cable, and that it runs GRBL 1.1 at this baud rate"
                    ) from None
            else:
                return

    def _alarm_error(self, what: str, alarm: Alarm) -> DeviceError:
        if alarm.position_lost:
            return PositionLostError(f"{self.name}: {what}: {alarm}; its position is lost, home it")
        return DeviceError(f"{self.name}: {what}: {alarm}; its position is kept, reset and home it")

    def _await(self, pick: Callable[[Reply], Picked | None], timeout_s: float, what: str) -> Picked:
        deadline_s = self._clock.now_s() + timeout_s
        while True:
            picked = pick(self._next_reply(deadline_s, what))
            if picked is not None:
                return picked

    def _next_reply(self, deadline_s: float, what: str) -> Reply:
        while b"\n" not in self._pending:
            if self._clock.now_s() > deadline_s:
                raise LinkTimeoutError(f"{self.name}: no answer to {what}; check power and cable")
            arrived = self._read()
            self._pending += arrived
            if len(self._pending) > LONGEST_LINE:
                raise GarbledReplyError(f"{self.name}: endless line; check the baud rate")
            if not arrived:
                self._clock.sleep(POLL_S)
        line, self._pending = self._pending.split(b"\n", 1)
        return codec.parse_line(line)

    def _drain(self) -> None:
        """Take in what came unasked, and raise what it says of an alarm."""
        while arrived := self._read():
            self._pending += arrived[-LONGEST_LINE:]
        *lines, _ = self._pending.split(b"\n")
        self._pending = b""
        for line in lines:
            with suppress(GarbledReplyError):
                reply = codec.parse_line(line)
                if isinstance(reply, Alarm):
                    raise self._alarm_error("unasked", reply)

    def _forget(self) -> None:
        while self._read():
            pass
        self._pending = b""

    def _read(self) -> bytes:
        try:
            return bytes(self._port.read(LONGEST_LINE))
        except (serial.SerialException, OSError) as error:
            raise LinkTimeoutError(f"{self.name}: the port went away ({error}); check the USB cable") from error

    def _write(self, content: bytes) -> None:
        try:
            self._port.write(content)
        except (serial.SerialException, OSError) as error:
            raise LinkTimeoutError(f"{self.name}: the port went away ({error}); check the USB cable") from error


def _is_banner(reply: Reply) -> bool:
    return isinstance(reply, Text) and reply.kind == "banner"
