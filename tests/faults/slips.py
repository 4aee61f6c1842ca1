"""A table that is turned on its shaft in the middle of a turn: seen when the first slice is looked at again."""

import itertools
import random
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from acquisition.plans import Step
from acquisition.revisit import Revisits
from firmware_sim.camera.encode import encode
from firmware_sim.camera.shared_frame import MJPG
from firmware_sim.config import ReliefScene, SphereScene
from firmware_sim.scene.brushed_sphere import BrushedSphere
from firmware_sim.scene.pose import Pose, Scene
from firmware_sim.scene.relief import Relief
from firmware_sim.scene.sensor import Exposure, Sensor
from litrig.base.capture_folder.capture import Role
from litrig.base.pictures import decode_codes
from litrig.base.radiometry import U8
from tests.faults.cameras import EVERY, Watched, asked, folders
from tests.faults.outcome import Outcome, Scale
from tests.faults.real_sessions import quick_sim
from tests.faults.step_plans import turn_with_revisits

SIZE = (240, 320)
TOLERANCE_DEG = 0.3
USUALLY_OFF_DEG = 0.1
TICK_DEG = 0.044
"""How far off the servo's own word may be."""
SLICES = (12, 64, 128)
EXPOSURES = (Exposure(0.01, 0, 5000, 0), Exposure(0.0025, 50, 5000, 0))
"""A good one, and one that is short and amplified: noisy."""
SMALL_DEG = 1
SLIPS_DEG = (2, 3, 5, 8, 13, 20, 30, 40)


@dataclass
class Turn:
    """A turn of a sample before a camera.

    Attributes
    ----------
    slip_deg : how far it is turned on its shaft
    off_deg : how far it stands off its goals at most, and says so
    """

    scene: Scene
    slices: int
    exposure: Exposure
    chance: random.Random
    slip_deg: float = 0.0
    off_deg: float = TOLERANCE_DEG

    def __post_init__(self) -> None:
        self._sensor = Sensor(20_000.0, 6.0, self.chance.randrange(10**6))
        self.revisits = Revisits(TOLERANCE_DEG)
        for step in range(self.slices // 8 + 2):
            angle_deg = 360 * step / self.slices
            codes, read_deg = self.shoot(angle_deg)
            self.revisits.watch(Step(step, angle_deg=angle_deg), read_deg, codes)

    def shoot(self, angle_deg: float) -> tuple[U8, float]:
        """Return a picture and the angle that the table reads."""
        read_deg = angle_deg + self.chance.uniform(-self.off_deg, self.off_deg)
        true_deg = read_deg + self.slip_deg + self.chance.uniform(-TICK_DEG, TICK_DEG)
        light = self.scene.light([Pose(true_deg, 40.0, 50.0, 1.0)], SIZE)
        content = encode(self._sensor.expose(light, self.exposure), MJPG, 95, "422")
        return np.asarray(decode_codes(content, ".jpg", "camera"), np.uint8), read_deg

    def look_again(self) -> str:
        codes, read_deg = self.shoot(0.0)
        return self.revisits.judge(Step(99, Role.CLOSURE, angle_deg=0.0), read_deg, codes)


def _turns(chance: random.Random, count: int, off_deg: float) -> Iterator[Turn]:
    scenes: tuple[Scene, ...] = (BrushedSphere(SphereScene()), Relief(ReliefScene()))
    cases = itertools.cycle(itertools.product(scenes, SLICES, EXPOSURES))
    for scene, slices, exposure in itertools.islice(cases, count):
        yield Turn(scene, slices, exposure, chance, off_deg=off_deg)


def fault_11_slips_seen(campaign: Scale) -> Outcome:
    """The table is turned on its shaft by 1° to 40°, before smooth and detailed samples, in light and noise: seen."""
    chance = random.Random(11)
    missed = small_missed = 0
    for place, turn in enumerate(_turns(chance, campaign.trials, USUALLY_OFF_DEG)):
        turn.slip_deg = SLIPS_DEG[place % len(SLIPS_DEG)] * chance.choice((-1, 1))
        missed += not turn.look_again()
        turn.slip_deg = SMALL_DEG * chance.choice((-1, 1))
        small_missed += not turn.look_again()
    detail = f"from {SLIPS_DEG[0]}° on {missed} of {campaign.trials} missed, of {SMALL_DEG}° {small_missed}"
    return Outcome(
        2 * campaign.trials, missed, detail, passed=not missed and small_missed <= max(1, campaign.trials // 10)
    )


def fault_11_no_slip(campaign: Scale) -> Outcome:
    """The first slice is looked at again and nothing has slipped, the table as far off as it may be: no alarm."""
    chance = random.Random(12)
    alarms: list[str] = []
    for turn in _turns(chance, campaign.trials, TOLERANCE_DEG):
        alarms += [said for _ in range(3) if (said := turn.look_again())]
    detail = f"{len(alarms)} false alarms in {3 * campaign.trials} looks{'; '.join(['', *alarms[:2]])}"
    return Outcome(3 * campaign.trials, len(alarms), detail, passed=not alarms)


def fault_11_slip_in_a_session(campaign: Scale) -> Outcome:
    """The table slips in the middle of a turn: on hold at the next look; what was shot since is shot again, no more."""
    wrong = 0
    plan = turn_with_revisits(12, EVERY)
    looks = [step.step for step in plan if step.role is Role.CLOSURE]
    with quick_sim("amc") as sim, folders() as names:
        for trial in range(campaign.trials):
            place, slip_deg = 1 + trial * 5 % (len(plan) - 1), SLIPS_DEG[trial % len(SLIPS_DEG)]
            at = {place: asked("turntable.slip", degrees=slip_deg)}
            session = Watched(sim, plan, next(names), at).run()
            sim.side_channel.request("turntable.slip", degrees=-slip_deg)
            recalled = [entry["steps"] for entry in session.entries if entry["ev"] == "recall"]
            look = next(step for step in looks if step >= place)
            since = [step for step in range(look + 1) if step > max([-1, *(s for s in looks if s < look)])]
            wrong += recalled != [since] or "slipped" not in session.hold
            before = len(session.entries)
            again = Watched(sim, plan, session.folder).run(again=True)
            shot = [entry["step"] for entry in again.entries[before:] if entry["ev"] == "frame"]
            wrong += sorted(shot) != sorted({*since, *range(look + 1, len(plan))}) or not again.is_whole()
    detail = "flagged at the next look; exactly the frames since were called back and shot again"
    return Outcome(campaign.trials, wrong, detail, passed=wrong == 0)
