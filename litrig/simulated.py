"""Telling a simulated rig where a session will lead, so that it can render what its camera will see."""

from collections.abc import Iterable, Iterator
from pathlib import Path

from acquisition.plans import Step
from firmware_sim.launch import RunningSim
from firmware_sim.scene.pose import PlannedPose
from firmware_sim.side_channel import SideChannel
from litrig.base.progress import Progress, Report


def planned_poses(steps: Iterable[Step]) -> Iterator[PlannedPose]:
    """Go through the poses of steps, as its devices will be commanded."""
    for step in steps:
        if step.aim is None:
            yield PlannedPose(turntable_deg=step.angle_deg)
        else:
            yield PlannedPose(step.angle_deg, step.aim.azimuth_deg, step.aim.elevation_deg)


def render_ahead(sim: RunningSim, steps: Iterable[Step], report: Report, job: str = "frames") -> None:
    """Have the frames of steps rendered, and wait for them; nothing to wait for where formulas make the light."""
    note = sim.render_progress().note

    def tell(done: int, total: int) -> None:
        if total:
            report(Progress(job, done, total, note))

    sim.render_ahead(planned_poses(steps), tell)


def announce(channel: Path, steps: Iterable[Step], report: Report) -> None:
    """Do so for a simulator that somebody else started."""
    with SideChannel(channel) as open_channel:
        render_ahead(RunningSim(Path(), {}, open_channel), steps, report)
