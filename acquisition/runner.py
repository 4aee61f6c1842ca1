"""Shooting steps, one after the other, and saying what happened.

A frame counts only when the pose was in tolerance before and after its exposure, the exposure began after the pose had
settled, and the frame and its journal line are on the disk. While it is looked at and written, the rig is on its way to
the next pose; it is not exposed there before.
"""

from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field

from acquisition.events import Paused, Retried, RunEvent
from acquisition.keeper import Exposed, Keeper, Rejected
from acquisition.plans import Step
from acquisition.poses import judge, locate
from acquisition.quality import Inspector
from acquisition.revisit import Revisits
from acquisition.room import Room
from litrig.base.capture_folder.capture import Role
from litrig.base.capture_folder.writer import CaptureFolderWriter
from litrig.base.errors import HoldError, InputError
from rig.devices import Shot
from rig.errors import CameraError, CameraHangsError, RigError
from rig.rig import Rig

Settings = Mapping[str, float | str]


@dataclass(frozen=True)
class Policy:
    """How much is tried before a person is called.

    Attributes
    ----------
    tries : how often a step is shot until its frame is good
    reconnects : how often a camera that is lost is opened again, for one frame
    wait_s : before each
    """

    tries: int = 3
    reconnects: int = 3
    wait_s: float = 1.0


USUAL = Policy()


@dataclass
class SoFar:
    """What a session knows from its earlier parts.

    Attributes
    ----------
    settings : what the camera was set to, by the exposure's stops; the frames to come must agree
    since_revisit : the steps of the good frames since the last closure frame that was as it should be
    revisits : what knows the first frames
    confirmed : steps for which a person has done by now what they ask for
    """

    settings: dict[float, Settings] = field(default_factory=dict)
    since_revisit: list[int] = field(default_factory=list)
    revisits: Revisits | None = None
    confirmed: frozenset[int] = frozenset()


def check_plan(steps: Iterable[Step], rig: Rig) -> None:
    """Refuse steps that the rig cannot shoot, before anything moves.

    Raises
    ------
    OutOfRangeError
        A step lies beyond the limits.
    RigError
        The rig lacks a part that the plan needs.
    """
    _ = rig.camera
    for step in steps:
        if step.angle_deg is not None:
            rig.turntable.check(step.angle_deg)
        if step.aim is not None:
            rig.check_light(step.aim.azimuth_deg, step.aim.elevation_deg, step.aim.lamp)


def run(
    steps: Iterable[Step],
    rig: Rig,
    writer: CaptureFolderWriter,
    pause_requested: Callable[[], bool],
    *,
    ask: Callable[[str], bool] = lambda _: False,
    policy: Policy = USUAL,
    so_far: SoFar | None = None,
) -> Iterator[RunEvent]:
    """Home the rig, shoot every step, park.

    Parameters
    ----------
    steps : in this order
    pause_requested : asked before every step
    ask : have a person do something and confirm it; False if nobody is there

    Raises
    ------
    HoldError
        Something failed that a retry does not mend, or a person is needed. The rig holds; the frames so far are safe.
    """
    try:
        with _Run(rig, writer, policy, so_far or SoFar()) as course:
            yield from course.events(deque(steps), pause_requested, ask)
    except KeyboardInterrupt:
        with suppress(InputError):
            writer.record("stop")
        raise
    except (RigError, InputError, OSError) as error:
        reason = str(error)
        if isinstance(error, OSError):  # the disk went away between two writes
            reason = f"{error.filename or writer.folder}: {error.strerror}; check the disk, and that it is there"
        asks = {"asks": error.step} if isinstance(error, _PersonNeededError) else {}
        with suppress(InputError):  # a full disk may be why
            writer.record("hold", reason=reason, **asks)
        raise HoldError(
            f"{reason}. The rig is on hold; the frames so far are safe, and litrig capture resume {writer.folder} "
            "shoots the others"
        ) from error


class _PersonNeededError(RigError):
    """A step asks for something that nobody is there to do."""

    def __init__(self, step: Step) -> None:
        super().__init__(f"step {step.step} needs a person: {step.ask}")
        self.step = step.step


class _Run:
    """One way through the steps."""

    def __init__(self, rig: Rig, writer: CaptureFolderWriter, policy: Policy, so_far: SoFar) -> None:
        self._rig, self._writer, self._policy, self._so_far = rig, writer, policy, so_far
        tolerance_deg = 0.0 if rig.config.turntable is None else rig.config.turntable.tolerance_deg
        self._inspector = Inspector()
        self._keeper = Keeper(writer, self._inspector, so_far.revisits or Revisits(tolerance_deg))
        self._room = Room(writer.folder)
        self._attempts: dict[int, int] = {}
        self._confirmed = set(so_far.confirmed)
        self._last: Step | None = None
        self._taken = 0

    def __enter__(self) -> "_Run":
        """Begin."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: object) -> None:
        """Stop what moves, if anything went wrong, and let the frame under way come onto the disk."""
        if isinstance(error, Exception | KeyboardInterrupt):
            self._rig.hold()
        self._keeper.__exit__(None, None, None)

    def events(
        self, todo: deque[Step], pause_requested: Callable[[], bool], ask: Callable[[str], bool]
    ) -> Iterator[RunEvent]:
        self._rig.get_ready()
        self._measure_ambient(todo)
        while todo or self._keeper.is_busy:
            if not todo or pause_requested() or self._must_ask(todo[0]):
                yield from self._settle(todo)
                if todo and pause_requested():
                    yield self._pause()
                    return
                if todo and self._must_ask(todo[0]):
                    self._ask(todo[0], ask)
                continue
            step = todo[0]
            times_s = self._go(step)
            yield from self._settle(todo)
            if todo and todo[0] is step:
                todo.popleft()
                yield from self._expose(step, todo, times_s)
        self._rig.park()

    # What happens at a step

    def _go(self, step: Step) -> dict[str, float]:
        """Bring everything to its pose; return how long moving and settling took."""
        rig, start_s, settle_s = self._rig, self._rig.clock.now_s(), 0.0
        if step.angle_deg is not None:
            settle_s += rig.turn_to(step.angle_deg).settle_s
        if step.aim is not None and step.lit:
            rig.point_light(step.aim.azimuth_deg, step.aim.elevation_deg, step.aim.lamp)
            there_s = rig.clock.now_s()
            rig.lights.switch_on(step.aim.lamp)
            settle_s += rig.clock.now_s() - there_s
        elif not step.lit:
            rig.darken()
        return {"move": rig.clock.now_s() - start_s - settle_s, "settle": settle_s}

    def _expose(self, step: Step, todo: deque[Step], times_s: dict[str, float]) -> Iterator[RunEvent]:
        start_s = self._rig.clock.now_s()
        before = locate(step, self._rig)
        shot = yield from self._shoot(step)
        after = locate(step, self._rig)
        self._check_settings(step, shot)
        off_deg, reason = judge(step, self._rig, (before, after))
        times_s["expose"] = self._rig.clock.now_s() - start_s
        attempt = self._attempts.get(step.step, 0) + 1
        exposed = Exposed(step, attempt, before, after, shot, off_deg, times_s)
        if reason:
            yield self._retry(Rejected(exposed, reason), todo)
        else:
            self._keeper.keep(exposed)

    def _shoot(self, step: Step) -> Generator[RunEvent, None, Shot]:
        """Take a picture; a camera that is lost is opened again."""
        for left in reversed(range(self._policy.reconnects + 1)):
            try:
                return self._rig.expose(self._rig.clock.now_s(), step.exposure_ev)
            except CameraHangsError:
                raise
            except CameraError as error:
                if not left:
                    raise
                self._writer.record("reconnect", step=step.step, reason=str(error))
                yield Retried(step, self._policy.reconnects - left + 1, str(error))
                self._rig.clock.sleep(self._policy.wait_s)
                with suppress(CameraError):
                    self._rig.camera.configure()
        raise AssertionError

    def _check_settings(self, step: Step, shot: Shot) -> None:
        """Refuse a frame that was taken with other settings than those before it: exposures are never mixed."""
        usual = self._so_far.settings.setdefault(step.exposure_ev, shot.settings)
        changed = [
            f"{key} {usual.get(key)} → {shot.settings.get(key)}"
            for key in sorted({*usual, *shot.settings})
            if usual.get(key) != shot.settings.get(key)
        ]
        if changed:
            raise CameraError(
                f"step {step.step}: the camera's settings changed since the frames before ({', '.join(changed)}); set "
                "them in RIG.toml, so that they come back, or begin a new segment"
            )

    # What became of the frame before

    def _settle(self, todo: deque[Step]) -> Iterator[RunEvent]:
        """Wait for the frame under way; one that does not count is shot again next."""
        fate = self._keeper.fate()
        if fate is None:
            return
        if isinstance(fate, Rejected):
            yield self._retry(fate, todo)
            if fate.doubts_previous:
                self._doubt_previous(fate, todo)
            return
        step = self._last = fate.taken.step
        self._taken += 1
        yield fate.taken
        if fate.alarm:
            self._call_back(step, fate.alarm)
        if step.role is Role.CLOSURE:
            self._so_far.since_revisit.clear()
        else:
            self._so_far.since_revisit.append(step.step)
        self._room.check((self._writer.folder / fate.taken.file).stat().st_size, len(todo))

    def _retry(self, rejected: Rejected, todo: deque[Step]) -> Retried:
        step, attempt = rejected.exposed.step, rejected.exposed.attempt
        self._writer.record("retry", step=step.step, attempt=attempt, reason=rejected.reason)
        if attempt >= self._policy.tries:
            raise CameraError(f"step {step.step}: after {attempt} tries the frame {rejected.reason}")
        self._attempts[step.step] = attempt
        todo.appendleft(step)
        return Retried(step, attempt, rejected.reason)

    def _doubt_previous(self, rejected: Rejected, todo: deque[Step]) -> None:
        """Shoot the frame before again, too: a camera that repeats itself may have begun with that one."""
        step, self._last = self._last, None
        if step is None:
            return
        reason = f"step {rejected.exposed.step.step} {rejected.reason}"
        self._writer.recall([step.step], reason)
        with suppress(ValueError):
            self._so_far.since_revisit.remove(step.step)
        todo.appendleft(step)

    def _call_back(self, step: Step, alarm: str) -> None:
        doubtful = [*self._so_far.since_revisit, step.step]
        self._writer.recall(doubtful, f"step {step.step} {alarm}")
        raise RigError(
            f"step {step.step} {alarm}: the table slipped, or the sample, the lamps or the camera were moved; the "
            f"{len(doubtful)} frames since the last look are called back. Put everything back as it was"
        )

    # What a person does

    def _must_ask(self, step: Step) -> bool:
        return bool(step.ask) and step.step not in self._confirmed

    def _ask(self, step: Step, ask: Callable[[str], bool]) -> None:
        self._rig.darken()
        if not ask(step.ask):
            raise _PersonNeededError(step)
        self._confirmed.add(step.step)
        self._writer.record("confirmed", step=step.step, what=step.ask)

    def _pause(self) -> Paused:
        self._rig.pause()
        self._writer.record("pause", frames=self._taken)
        return Paused(self._taken)

    def _measure_ambient(self, todo: Iterable[Step]) -> None:
        """Look at the room with all lamps dark, to know a lamp that does not light."""
        if not self._rig.can_darken or not any(step.aim is not None and step.lit for step in todo):
            return
        self._rig.darken()
        shot = self._rig.expose(self._rig.clock.now_s())
        _, quality = Inspector().inspect(shot.content, shot.ending, "camera")
        self._inspector.ambient_light = quality.light
        self._writer.record("ambient", light=round(quality.light, 6), mean=round(quality.mean, 6))
