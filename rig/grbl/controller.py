"""A conversation with a GRBL controller: one line in flight, each answered before the next is sent."""

from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import TypeVar

from rig.clock import Clock
from rig.errors import DeviceError, GarbledReplyError, LinkError, LinkTimeoutError, PositionLostError, RigError
from rig.grbl import commands
from rig.grbl.codec import Alarm, Dialect, Ok, Position, Refusal, Reply, Setting, Status, Text
from rig.grbl.commands import AXES, Axis, Command, RealTime
from rig.grbl.errors import KeptAlarmError, RefusedError, StillMovingError
from rig.grbl.line import GrblLine, Port

BOOT_S = 3.0
ANSWER_S = 1.0
STOP_S = 2.0
PATIENCE_S = 0.2
SILENCE_S = 0.12
LOOK_S = 0.25
"""How often the state is looked at while a motion is waited for."""
ARRIVAL_S = 1.0
TRIES = 3
RESETS = 3
POLL_S = 0.02
STILL_DEG = 0.0015
"""Two positions that differ by no more were read at rest: reports have three decimals."""

Picked = TypeVar("Picked")


class GrblController:
    """The controller behind a serial port; arm, turntable and lamp may share it.

    Attributes
    ----------
    homed : whether the homing cycle has ended well since the port was opened, and nothing has lost the position since
    lost : whether the position was lost since the port was opened
    """

    def __init__(self, path: str, baud: int, clock: Clock, port: Port | None = None) -> None:
        """Open the port and wait until the controller answers: opening resets many boards, which then boot.

        Raises
        ------
        PortError, LinkTimeoutError
            No port, or silence.
        """
        self._clock = clock
        self._line = GrblLine(path, baud, clock, port)
        self.name = self._line.name
        self.homed = self.lost = False
        self._dialect: Dialect = "grbl"
        self._work_offset: Position | None = None
        self._settings: dict[int, float] | None = None
        self._was_reset = False
        self._guarded = False
        self._booted = False
        self._locked_but_known = False
        self._ready = False
        try:
            self._wait_for_boot()
        except LinkError:
            self._line.close()
            raise

    # Lines

    def command(self, command: Command, timeout_s: float = ANSWER_S, *, watch: bool = False) -> list[Setting]:
        """Send one command and wait for its `ok`; what it lists is returned.

        A command whose answer does not come is sent again, after all that was late has been thrown away: goals are
        absolute, so that doing it twice is doing it once.

        Parameters
        ----------
        timeout_s : for the answer
        watch : look at the state meanwhile, so that a hold or an open door ends the waiting

        Raises
        ------
        DeviceError, PositionLostError
            It was refused, ended in an alarm, or somebody holds the machine.
        LinkTimeoutError, GarbledReplyError
            No answer in time, or a damaged one.
        """
        line = commands.encode(command)
        if not self._ready:
            self.make_ready()
        if self._locked_but_known and not isinstance(command, commands.Unlock):
            raise DeviceError(f"{self.name}: locked after an alarm that kept its position; stop it, then go on")
        self._release_guard()
        repeats = TRIES if commands.may_be_repeated(command) and not watch else 1
        for left in reversed(range(repeats)):
            self._notice(self._line.waiting())
            self._line.write(line)
            try:
                return self._await_ok(_name(command), self._clock.now_s() + timeout_s, watch=watch)
            except (LinkTimeoutError, GarbledReplyError, RefusedError):
                if not left:
                    raise
                self._resynchronise()
        raise AssertionError("unreachable")

    def send_guarded(self, first: Command, *rest: Command) -> None:
        """Send several lines in one go and wait for the first one's `ok`; the rest waits in the controller.

        It takes no other line until those are done, so that the next command first ends them by a soft reset.
        """
        if not self._ready:
            self.make_ready()
        self._release_guard()
        self._notice(self._line.waiting())
        self._guarded = True
        self._line.write(b"".join(commands.encode(command) for command in (first, *rest)))
        self._await_ok(_name(first), self._clock.now_s() + ANSWER_S)

    def finish_motion(self, timeout_s: float) -> None:
        """Wait until the planner is empty: the `ok` of a dwell comes when all before it is done.

        An answer that was late may be taken for it, so that the state has the last word.
        """
        with suppress(LinkTimeoutError, GarbledReplyError):
            self.command(commands.Dwell(), timeout_s, watch=True)
        deadline_s = self._clock.now_s() + ARRIVAL_S
        while (report := self.status()).state != "Idle":
            self._refuse_standstill(report, "the end of motion")
            if self._clock.now_s() > deadline_s:
                raise StillMovingError(f"{self.name}: still in state {report.state} after {timeout_s:.0f} s; home it")
            self._clock.sleep(POLL_S)

    # Reports

    def status(self, timeout_s: float = ANSWER_S, tries: int = TRIES) -> Status:
        """Ask for a report; works at any time, moving or not. The machine position is always filled in."""
        for left in reversed(range(tries)):
            self._notice(self._line.waiting())
            self._line.act(RealTime.STATUS)
            try:
                report = self._await(lambda reply: reply if isinstance(reply, Status) else None, timeout_s, "?")
            except GarbledReplyError:
                continue
            except LinkTimeoutError:
                if not left:
                    raise
                self._notice(self._line.drain(SILENCE_S))
                continue
            self._work_offset = report.work_offset or self._work_offset
            if report.machine is not None:
                return report
            if report.work is not None and len(report.work) == len(self._work_offset or ()):
                machine = tuple(a + b for a, b in zip(report.work, self._work_offset or (), strict=True))
                return Status(report.state, report.phase, machine, report.work, self._work_offset, fields=report.fields)
        raise GarbledReplyError(f"{self.name}: no usable status report; check the cable, and set $10=3")

    def position(self) -> Position:
        """Read where it stands or is: at rest, only what two reports agree on, for reports have no checksum."""
        before: Position | None = None
        for _ in range(2 * TRIES):
            report = self.status()
            if self.homed and report.state in ("Alarm", "Sleep"):
                self._refuse_standstill(report, "?")
            here = report.machine or ()
            if report.is_moving or (before is not None and _agree(before, here)):
                return here
            before = here
        raise GarbledReplyError(f"{self.name}: no two status reports agree; check the cable")

    def place(self, axis: Axis) -> float:
        """Read one axis.

        Raises
        ------
        DeviceError
            The controller has no such axis.
        """
        position = self.position()
        if AXES.index(axis) >= len(position):
            has = ", ".join(AXES[: len(position)])
            raise DeviceError(f"{self.name}: has no axis {axis}, only {has}; mend the axis in RIG.toml")
        return position[AXES.index(axis)]

    # Settings

    @property
    def hangs_on_settings(self) -> bool:
        """Whether a setting must not be written any more: after a soft reset grblHAL may hang then."""
        return self._was_reset and self._dialect == "grblHAL"

    def settings(self, *, anew: bool = False) -> Mapping[int, float]:
        """Read the `$` settings, once; those that are no numbers are left out."""
        if self._settings is None or anew:
            listed = self.command(commands.AskSettings(), 2 * ANSWER_S)
            self._settings = {setting.number: setting.value for setting in listed}
        return self._settings

    # Motion and its end

    def home(self, timeout_s: float) -> None:
        """Run the homing cycle, from whatever state.

        Raises
        ------
        PositionLostError
            A switch was not found.
        """
        self.homed = False
        self.make_ready()
        self.command(commands.Home(), timeout_s)
        self.homed, self.lost = True, False

    def make_ready(self) -> None:
        """See that lines are heard: end what an earlier run left, be it a motion, a hold or a dwell."""
        self._ready = True
        report = self.status()
        if report.state not in ("Idle", "Alarm") or self._guarded:
            self.halt()
            return
        self._line.write(commands.encode(commands.Help()))
        try:
            self._await_ok("$", self._clock.now_s() + ANSWER_S)
        except RefusedError:
            return  # half a line was left; now it is gone
        except (LinkTimeoutError, GarbledReplyError):
            self.halt()

    def hold(self) -> None:
        """Brake on the path; `resume` goes on."""
        self._line.act(RealTime.HOLD)

    def resume(self) -> None:
        """Go on after a hold or the closed door."""
        self._line.act(RealTime.RESUME)

    def cancel_jog(self) -> None:
        """Brake a jog and forget the rest of it; the position stays known."""
        self._line.act(RealTime.JOG_CANCEL)

    def halt(self) -> None:
        """Brake now, keeping the position; then clear what was planned. Safe at any time, and twice.

        A feed hold brakes within the acceleration. A soft reset after it empties the planner and darkens the lamp, and
        the position stays known, since nothing moves any more. Homing hears neither hold nor question: the
        reset ends it, and the position is unknown.
        """
        self._line.act(RealTime.HOLD)
        deadline_s = self._clock.now_s() + STOP_S
        with suppress(RigError):  # whatever it says or fails to say, the reset follows
            while self.status(PATIENCE_S, 1).is_moving and self._clock.now_s() < deadline_s:
                self._clock.sleep(POLL_S)
        self.reset()

    def reset(self) -> None:
        """Reset softly, and wait for the banner. After an alarm it is deaf for a while."""
        self._was_reset = True
        self._guarded = False
        for _ in range(RESETS):
            self._notice(self._line.waiting(), loudly=False)
            self._line.act(RealTime.RESET)
            try:
                banner = self._await(_banner, ANSWER_S, "reset", loudly=False)
            except (LinkTimeoutError, GarbledReplyError):
                continue
            self._dialect = banner.dialect
            self._unlock_if_kept()
            return
        raise LinkTimeoutError(f"{self.name}: does not come back from a reset; switch it off and on")

    def sleep(self) -> None:
        """Switch the motors off; the position is lost, for they can be turned by hand now."""
        self.homed = False
        self.command(commands.Sleep())

    def close(self) -> None:
        """Give the port back."""
        self._line.close()

    # Within

    def _wait_for_boot(self) -> None:
        silent_s, deadline_s = self._clock.now_s() + BOOT_S, self._clock.now_s() + 2 * BOOT_S
        while True:
            try:
                self.status(tries=1)
            except DeviceError:
                continue  # an alarm of before our time: the state tells it
            except (LinkTimeoutError, GarbledReplyError):
                if self._clock.now_s() > silent_s:
                    self._line.act(RealTime.RESET)  # after a limit alarm it hears nothing else
                if self._clock.now_s() > deadline_s:
                    raise LinkTimeoutError(
                        f"{self.name}: silent; check its power and cable, and that it runs GRBL 1.1 at this baud rate"
                    ) from None
            else:
                self._booted = True
                self.lost = False
                return

    def _release_guard(self) -> None:
        if self._guarded:
            self.reset()

    def _resynchronise(self) -> None:
        """End a line that may have lost its end, and throw away what is late."""
        self._line.write(commands.encode(commands.Help()))
        self._notice(self._line.drain(SILENCE_S))

    def _unlock_if_kept(self) -> None:
        """After an alarm that kept the position there is nothing to home for."""
        if self._locked_but_known and self.status().state == "Alarm":
            self.command(commands.Unlock())
        self._locked_but_known = False

    def _await_ok(self, what: str, deadline_s: float, *, watch: bool = False) -> list[Setting]:
        listed: list[Setting] = []
        look_s = self._clock.now_s() + LOOK_S
        while True:
            try:
                reply = self._line.next_reply(min(deadline_s, look_s) if watch else deadline_s, what)
            except LinkTimeoutError:
                if not watch or self._clock.now_s() > deadline_s:
                    raise
                self._line.act(RealTime.STATUS)
                look_s = self._clock.now_s() + LOOK_S
                continue
            match reply:
                case Ok():
                    return listed
                case Refusal() as refusal:
                    raise RefusedError(f"{self.name}: {what}: {refusal}; home it, and check limits and settings")
                case Setting():
                    listed.append(reply)
                case Status():
                    self._refuse_standstill(reply, what)
                case _:
                    self._notice([reply], what)

    def _refuse_standstill(self, report: Status, what: str) -> None:
        if report.state == "Alarm" and self._locked_but_known:
            raise DeviceError(f"{self.name}: locked after an alarm that kept its position; stop it, then go on")
        if report.state in ("Alarm", "Sleep"):
            self._lose()
            raise PositionLostError(
                f"{self.name}: in state {report.state} during {what} (a reset, a power sag?); its position is lost, "
                "home it"
            )
        if report.state in ("Hold", "Door"):
            raise DeviceError(
                f"{self.name}: {what}: somebody {'opened the door' if report.state == 'Door' else 'holds it'}; "
                "see why, then run again"
            )

    def _notice(self, replies: list[Reply], what: str = "unasked", *, loudly: bool = True) -> None:
        """Look at what nobody waits for: an alarm, or a banner of a controller that has restarted by itself."""
        for reply in replies:
            if isinstance(reply, Alarm):
                if reply.position_lost:
                    self._lose()
                else:
                    self._locked_but_known = not self.lost
                if loudly:
                    raise self._alarm_error(what, reply)
            elif isinstance(reply, Text) and reply.kind == "banner":
                self._dialect = reply.dialect
                if loudly and self._booted:
                    self._lose()
                    raise PositionLostError(f"{self.name}: {what}: it restarted by itself; check its supply, home it")

    def _lose(self) -> None:
        self.homed, self.lost, self._locked_but_known = False, True, False

    def _alarm_error(self, what: str, alarm: Alarm) -> DeviceError:
        if alarm.position_lost:
            return PositionLostError(f"{self.name}: {what}: {alarm}; its position is lost, home it")
        return KeptAlarmError(f"{self.name}: {what}: {alarm}; its position is kept, stop it and ask for another goal")

    def _await(
        self, pick: Callable[[Reply], Picked | None], timeout_s: float, what: str, *, loudly: bool = True
    ) -> Picked:
        deadline_s = self._clock.now_s() + timeout_s
        while True:
            reply = self._line.next_reply(deadline_s, what)
            picked = pick(reply)
            if picked is not None:
                return picked
            self._notice([reply], what, loudly=loudly)


def _banner(reply: Reply) -> Text | None:
    return reply if isinstance(reply, Text) and reply.kind == "banner" else None


def _name(command: Command) -> str:
    return commands.encode(command).decode("ascii").strip()


def _agree(one: Position, other: Position) -> bool:
    return len(one) == len(other) and all(abs(a - b) <= STILL_DEG for a, b in zip(one, other, strict=True))
