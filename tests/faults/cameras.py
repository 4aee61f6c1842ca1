"""What befalls camera and lamps in a session, and that no frame counts which is not what it says."""

import itertools
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from acquisition.events import FrameTaken, RunEvent
from acquisition.plans import Step
from acquisition.runner import Policy
from acquisition.session import Operator, Planned, capture, resume
from acquisition.session_info import SessionInfo
from firmware_sim.config import SphereScene
from firmware_sim.launch import RunningSim
from firmware_sim.scene.brushed_sphere import BrushedSphere
from firmware_sim.scene.pose import Pose
from firmware_sim.scene.sensor import Exposure, Sensor
from firmware_sim.side_channel import SideChannel
from litrig.base.capture_folder import layout
from litrig.base.capture_folder.journal import Entry, read_journal
from litrig.base.capture_folder.reader import good_frames
from litrig.base.capture_folder.verify import verify_capture
from litrig.base.errors import HoldError
from litrig.base.pictures import decode_codes
from rig.config import RigConfig, read_rig
from tests.faults.fake_sessions import FakeRig, jpeg, painted, quick_folder
from tests.faults.outcome import Outcome, Scale
from tests.faults.power_cut import AIM
from tests.faults.real_sessions import quick_sim
from tests.faults.step_plans import arc, lamps_of_dome, lights_of_arm, turn, turn_with_revisits

IMPATIENT = Policy(wait_s=0.2)
TIMEOUT_S = 5.0
EVERY = 4


@dataclass
class Watched:
    """A session in this process on a simulated rig, and what came of it.

    Attributes
    ----------
    at : what is done when so many frames are there
    """

    sim: RunningSim
    plan: Planned
    folder: Path
    at: Mapping[int, Callable[[SideChannel], object]] = field(default_factory=dict)
    changes: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    hold: str = ""
    frames: int = 0

    def run(self, *, again: bool = False) -> "Watched":
        operator = Operator(watch=self._watch)
        options: dict[str, Any] = {"operator": operator, "policy": IMPATIENT, "environment": self.sim.environment}
        try:
            self._befall()
            if again:
                resume(self.folder, self.config, **options)
            else:
                capture(self.config, self.plan, self.folder, SessionInfo("x"), **options)
        except HoldError as error:
            self.hold = str(error)
        return self

    @property
    def config(self) -> RigConfig:
        table = read_rig(self.sim.rig_toml).model_dump(exclude_none=True)
        for section, values in {"camera": {"timeout_s": TIMEOUT_S}, **self.changes}.items():
            table[section] = {**table[section], **values}
        return RigConfig.model_validate(table)

    @property
    def entries(self) -> list[Entry]:
        return read_journal(self.folder / layout.JOURNAL)

    @property
    def good(self) -> list[Entry]:
        return good_frames(self.entries)

    def is_whole(self) -> bool:
        return layout.is_closed(self.folder) and not verify_capture(self.folder).findings

    def _watch(self, event: RunEvent, total: int) -> None:
        if isinstance(event, FrameTaken):
            self.frames += 1
            self._befall()

    def _befall(self) -> None:
        if mishap := self.at.get(self.frames):
            mishap(self.sim.side_channel)


def asked(name: str, **parameters: object) -> Callable[[SideChannel], object]:
    return lambda channel: channel.request(name, **parameters)


@contextmanager
def folders() -> Iterator[Iterator[Path]]:
    """Make names for sessions, one after the other."""
    with tempfile.TemporaryDirectory() as name:
        yield (Path(name) / f"s{count}" for count in itertools.count())


def fault_23_black_frames(campaign: Scale) -> Outcome:
    """A frame comes out black, once or again and again: shot again at most twice, then on hold; none counts."""
    wrong = trials = 0
    steps = tuple(Step(number, angle_deg=20.0 * number, aim=AIM) for number in range(4))
    for place, times in itertools.islice(itertools.product(range(len(steps)), (1, 2, 3, 4)), campaign.trials):
        with quick_folder() as root:
            rig = FakeRig()
            left = [times]

            def paint(rig: FakeRig = rig, place: int = place, left: list[int] = left) -> bytes:
                if rig.exposures > place + 1 and left[0]:  # the first exposure is of the room
                    left[0] -= 1
                    return jpeg(np.zeros_like(painted(0)))
                return rig.picture()

            rig.paint = paint
            held = ""
            try:
                rig.capture(steps, root / "s")
            except HoldError as error:
                held = str(error)
            entries = read_journal(root / "s" / layout.JOURNAL)
            dark = [entry for entry in entries if entry["ev"] == "frame" and entry["checks"]["mean"] < 0.01]
            expected = place if times > 2 else len(steps)
            wrong += bool(dark) or bool(held) != (times > 2) or len(good_frames(entries)) != expected
            wrong += bool(held) and f"step {place}: after 3 tries the frame is" not in held
            trials += 1
    return Outcome(trials, wrong, "none counts; two in a row are shot again, three hold the rig", passed=wrong == 0)


def fault_24_dead_lamps(campaign: Scale) -> Outcome:
    """A lamp of a dome is dead, each in turn: on hold before its frame counts, and never otherwise."""
    wrong = trials = false_alarms = clean = 0
    lamps = 24
    with quick_sim("dome", dome={"lamps": lamps}) as sim, folders() as names:
        plan = lamps_of_dome(read_rig(sim.rig_toml))
        for _ in range(max(1, campaign.trials // 50)):
            false_alarms += sum(entry["ev"] == "retry" for entry in Watched(sim, plan, next(names)).run().entries)
            clean += lamps
        for lamp in itertools.islice(range(lamps), campaign.trials):
            sim.side_channel.request("lights.dead", lamp=lamp)
            session = Watched(sim, plan, next(names)).run()
            sim.side_channel.request("lights.mend")
            step = next(step for step in plan if step.aim is not None and step.aim.lamp == lamp)
            name = f"lamp {lamp}" if lamp else "the lamp"
            flagged = f"step {step.step}: after 3 tries" in session.hold and f"{name} did not light" in session.hold
            wrong += not flagged or any(entry["step"] == step.step for entry in session.good)
            trials += 1
    wrong += false_alarms
    detail = f"all flagged before the frame counted; {false_alarms} false alarms in {clean} clean frames"
    return Outcome(trials, wrong, detail, passed=wrong == 0)


def fault_24_dead_lamp_of_the_arm(campaign: Scale) -> Outcome:
    """The lamp on the arm dies at each pose of a PTM session: on hold before that frame counts, and never otherwise."""
    wrong = trials = false_alarms = clean = 0
    with quick_sim("ptm") as sim, folders() as names:
        arm_plan = lights_of_arm(6)
        clean_run = Watched(sim, arm_plan, next(names)).run()
        false_alarms += sum(entry["ev"] == "retry" for entry in clean_run.entries)
        clean += len(clean_run.good)
        for place in itertools.islice(range(6), campaign.trials):
            session = Watched(sim, arm_plan, next(names), {place: asked("arm.lamp_dead")}).run()
            sim.side_channel.request("arm.lamp_dead", dead=False)
            # When the arm is lit for the next pose already, that frame may still have its light.
            wrong += "did not light" not in session.hold or len(session.good) > place + 1
            wrong += any(entry["checks"]["light"] < 0.001 for entry in session.good)
            trials += 1
    wrong += false_alarms
    detail = f"all flagged before the frame counted; {false_alarms} false alarms in {clean} clean frames"
    return Outcome(trials, wrong, detail, passed=wrong == 0)


def fault_25_frozen_camera(campaign: Scale) -> Outcome:
    """The camera delivers the same picture for ever, from any frame on: none of them counts; mended, it goes on."""
    wrong = 0
    with quick_sim("amc") as sim, folders() as names:
        for trial in range(campaign.trials):
            place = trial % 8
            frozen_s: list[float] = []

            def freeze(channel: SideChannel, frozen_s: list[float] = frozen_s) -> None:
                channel.request("camera.freeze")
                frozen_s.append(time.monotonic())

            session = Watched(sim, arc(8), next(names), {place: freeze}).run()
            sim.side_channel.request("camera.mend")
            wrong += "the camera is frozen" not in session.hold or len(session.good) < place
            # A picture that was being exposed just then may be the last that is as it should be.
            wrong += any(entry["exposed"]["from_s"] > frozen_s[0] for entry in session.good)
            wrong += len({entry["sha256"] for entry in session.good}) != len(session.good)
            wrong += not Watched(sim, arc(8), session.folder).run(again=True).is_whole()
    return Outcome(campaign.trials, wrong, "on hold before one counts, resumed to a verified bag", passed=wrong == 0)


def fault_26_pictures_show_their_poses(campaign: Scale) -> Outcome:
    """Every picture of a session shows the angle that its line says, not the one before or the way between."""
    slices, size = max(8, min(campaign.trials, 128)), (240, 320)
    scene, sensor = BrushedSphere(SphereScene()), Sensor(1e8, 0.0, 1)
    truths = {}
    for place in range(2 * slices):  # and halfway between
        light = scene.light([Pose(180 * place / slices, 0, 0, 1)], size)
        truths[place] = sensor.expose(light, Exposure(0.01, 0, 5000, 0)).astype(np.float32)
    with quick_sim("amc") as sim, folders() as names:
        session = Watched(sim, turn(slices), next(names)).run()
        wrong = 0
        for entry in session.good:
            path = session.folder / entry["file"]
            codes = decode_codes(path.read_bytes(), ".jpg", str(path)).astype(np.float32)
            nearest = min(truths, key=lambda place: float(np.abs(truths[place] - codes).mean()))
            wrong += (nearest - 2 * entry["step"]) % slices != 0  # brushing looks the same after half a turn
    return Outcome(slices, wrong, f"{slices} slices, each nearest to its own truth of {2 * slices}", passed=wrong == 0)


def fault_27_late_pictures(campaign: Scale) -> Outcome:
    """From some frame on the camera hands over the picture before: found when the first is looked at again."""
    wrong = trials = 0
    plan = turn_with_revisits(12, EVERY)
    with quick_sim("amc") as sim, folders() as names:
        for trial in range(campaign.trials):
            place = 1 + trial % 11
            session = Watched(sim, plan, next(names), {place: asked("camera.lag", frames=30)}).run()
            sim.side_channel.request("camera.mend")
            shot = [entry["file"] for entry in session.entries if entry["ev"] == "frame"]
            late, counts = set(shot[place:]), {entry["file"] for entry in session.good}
            wrong += not session.hold or bool(late & counts) or len(late) > EVERY + 1
            again = Watched(sim, plan, session.folder).run(again=True)
            wrong += not again.is_whole()
            trials += 1
    detail = "found at the next look, the frames since called back and shot again"
    return Outcome(trials, wrong, detail, passed=wrong == 0)


def fault_28_over_exposed(campaign: Scale) -> Outcome:
    """The exposure is too long: each such frame has a remark, and none has one that is exposed well."""
    wrong = trials = 0
    with quick_sim("amc") as sim, folders() as names:
        for exposure_ms in (40.0, 10.0, 80.0)[: campaign.trials]:
            changes = {"camera": {"exposure_ms": exposure_ms, "timeout_s": TIMEOUT_S}}
            session = Watched(sim, arc(8), next(names), changes=changes).run()
            for entry in session.good:
                is_over = entry["checks"]["clipped"] > 0.05
                wrong += is_over != any("clipped" in remark for remark in entry.get("remarks", []))
                wrong += is_over != (exposure_ms > 10)
            trials += len(session.good)
    return Outcome(trials, wrong, "remarked on exactly where more than 5 % are clipped", passed=wrong == 0)


def fault_29_drifting_settings(campaign: Scale) -> Outcome:
    """Gain, exposure, white balance or focus change behind the session's back: on hold; no frame is mixed in."""
    wrong = 0
    controls = ({"gain": 20}, {"exposure_100us": 200}, {"white_balance_k": 3000}, {"focus": 60})
    with quick_sim("amc") as sim, folders() as names:
        for trial in range(campaign.trials):
            changed = controls[trial % len(controls)]
            place = 1 + trial // len(controls) % 7
            session = Watched(sim, arc(8), next(names), {place: asked("camera.drift", **changed)}).run()
            wrong += "the camera's settings changed" not in session.hold
            wrong += len({str(entry["camera"]) for entry in session.good}) != 1 or len(session.good) > place
            wrong += not Watched(sim, arc(8), session.folder).run(again=True).is_whole()
    return Outcome(campaign.trials, wrong, "on hold, 0 frames mixed, resumed to a verified bag", passed=wrong == 0)


def fault_30_camera_lost_for_a_moment(campaign: Scale) -> Outcome:
    """The camera is unplugged and comes back within a second: opened again, at most one frame is shot again."""
    wrong = 0
    with quick_sim("amc") as sim, folders() as names:
        for trial in range(campaign.trials):
            session = Watched(sim, arc(8), next(names), {trial % 8: _unplug_for(0.1 + 0.05 * (trial % 5))}).run()
            shot = [entry for entry in session.entries if entry["ev"] == "frame"]
            wrong += bool(session.hold) or len(shot) != 8 or not session.is_whole()
    return Outcome(campaign.trials, wrong, "goes on by itself, no frame twice", passed=wrong == 0)


def fault_30_camera_lost_for_good(campaign: Scale) -> Outcome:
    """The camera is unplugged and stays away: three tries to open it, then on hold; plugged in, it is resumed."""
    wrong = 0
    with quick_sim("amc") as sim, folders() as names:
        for trial in range(campaign.trials):
            place = 1 + trial % 7  # before the first it would be refused
            session = Watched(sim, arc(8), next(names), {place: asked("camera.unplug")}).run()
            sim.side_channel.request("camera.mend")
            tries = sum(entry["ev"] == "reconnect" for entry in session.entries)
            wrong += not session.hold or tries != 3 or len(session.good) != place
            wrong += not Watched(sim, arc(8), session.folder).run(again=True).is_whole()
    return Outcome(campaign.trials, wrong, "on hold after three tries, resumed to a verified bag", passed=wrong == 0)


def _unplug_for(seconds: float) -> Callable[[SideChannel], object]:
    def mishap(channel: SideChannel) -> None:
        channel.request("camera.unplug")

        def plug_in() -> None:
            with SideChannel(channel.path) as own:  # a connection is for one thread
                own.request("camera.unplug", on=False)

        threading.Timer(seconds, plug_in).start()

    return mishap


def fault_31_hanging_camera(campaign: Scale) -> Outcome:
    """The camera never answers: on hold when exposure and patience are over; plugged in anew, it is resumed."""
    wrong = 0
    with quick_sim("amc") as sim, folders() as names:
        for trial in range(campaign.trials):
            place = trial % 8
            session = Watched(sim, arc(8), next(names), {place: asked("camera.hang")}).run()
            sim.side_channel.request("camera.mend")
            wrong += f"no picture within {TIMEOUT_S:g} s; it hangs" not in session.hold or len(session.good) != place
            wrong += not Watched(sim, arc(8), session.folder).run(again=True).is_whole()
    detail = f"on hold {TIMEOUT_S:g} s after the exposure, resumed to a verified bag"
    return Outcome(campaign.trials, wrong, detail, passed=wrong == 0)


def fault_32_cut_pictures(campaign: Scale) -> Outcome:
    """A JPEG ends early, at each hundredth of its length: rejected and shot again; from the real camera as well."""
    wrong = trials = 0
    steps = tuple(Step(number, angle_deg=20.0 * number, aim=AIM) for number in range(3))
    for percent in range(0, 100, max(1, 100 // campaign.trials)):
        with quick_folder() as root:
            rig = FakeRig()

            def paint(rig: FakeRig = rig, percent: int = percent) -> bytes:
                content = rig.picture()
                return content[: len(content) * percent // 100] if rig.exposures == 3 else content

            rig.paint = paint
            with suppress(HoldError):
                rig.capture(steps, root / "s")
            entries = read_journal(root / "s" / layout.JOURNAL)
            tries = [entry["try"] for entry in entries if entry["ev"] == "frame"]
            wrong += tries != [1, 2, 1] or bool(verify_capture(root / "s").findings)
            trials += 1
    with quick_sim("amc") as sim, folders() as names:
        session = Watched(sim, arc(8), next(names), {3: asked("camera.cut", percent=5)}).run()
        wrong += "damaged JPEG" not in session.hold or len(session.good) > 3
        sim.side_channel.request("camera.mend")
        wrong += not Watched(sim, arc(8), session.folder).run(again=True).is_whole()
        trials += 1
    return Outcome(trials, wrong, f"{trials} of {trials} rejected", passed=wrong == 0)
