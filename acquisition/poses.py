"""Where everything stood when a frame was taken, and whether that was where it should."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass

from acquisition.plans import Step
from litrig.base.directions import angle_between_deg, direction_from_angles
from rig.devices import ArmPose, TurntablePose
from rig.rig import Rig


@dataclass(frozen=True)
class Poses:
    """Where everything stood at one instant."""

    turntable: TurntablePose | None
    light: ArmPose | None

    def as_json(self) -> Mapping[str, float]:
        """Return them as the journal has them."""
        angles = {} if self.turntable is None else {"angle_deg": round(self.turntable.angle_deg, 4)}
        return angles if self.light is None else {**angles, **_rounded(asdict(self.light))}


def locate(step: Step, rig: Rig) -> Poses:
    """Ask everything that the step moved where it is; a part that lost torque, was reset or has a fault raises."""
    with rig.minding_position():
        return Poses(
            None if step.angle_deg is None else rig.turntable.locate(),
            None if step.aim is None else rig.locate_light(step.aim.lamp),
        )


def judge(step: Step, rig: Rig, poses: tuple[Poses, Poses]) -> tuple[float, str]:
    """Return the largest error in degrees of the poses before and after, and what is wrong with it, if anything is."""
    turned_deg = lit_deg = 0.0
    for pose in poses:
        if step.angle_deg is not None and pose.turntable is not None:
            turned_deg = max(turned_deg, abs(pose.turntable.angle_deg - step.angle_deg))
        if step.aim is not None and pose.light is not None:
            wanted = direction_from_angles(step.aim.azimuth_deg, step.aim.elevation_deg)
            found = direction_from_angles(pose.light.azimuth_deg, pose.light.elevation_deg)
            lit_deg = max(lit_deg, angle_between_deg(wanted, found))
    # Both joints of the arm may be off at once.
    for part, off_deg, joints in ((rig.config.turntable, turned_deg, 1), (rig.config.arm, lit_deg, 2)):
        if part is not None and off_deg > part.tolerance_deg * math.sqrt(joints):
            return off_deg, f"was taken {off_deg:.2f}° off its pose; look what moves the rig"
    return max(turned_deg, lit_deg), ""


def _rounded(values: Mapping[str, float]) -> dict[str, float]:
    return {key: round(value, 4) for key, value in values.items()}
