"""Telling a simulated rig where a plan will lead, so that it can render what its camera will see."""

from collections.abc import Iterator
from pathlib import Path

from acquisition.plans import Plan
from firmware_sim.launch import RunningSim
from firmware_sim.scene.pose import PlannedPose
from firmware_sim.side_channel import SideChannel
from litrig.base.progress import Progress, Report

CHANNEL_VARIABLE = "LITRIG_SIM_CHANNEL"
"""Set by `litrig sim run` for the programs that it starts."""


def planned_poses(plan: Plan) -> Iterator[PlannedPose]:
    """Go through the poses of a plan, as its devices will be commanded."""
    for step in plan:
        if step.aim is None:
            yield PlannedPose(turntable_deg=step.angle_deg)
        else:
            yield PlannedPose(step.angle_deg, step.aim.azimuth_deg, step.aim.elevation_deg)


def render_ahead(sim: RunningSim, plan: Plan, report: Report, job: str = "frames") -> None:
    """Have the frames of a plan rendered, and wait for them; nothing to wait for where formulas make the light."""
    note = sim.render_progress().note
    sim.render_ahead(planned_poses(plan), lambda done, total: report(Progress(job, done, total, note)))


def announce(channel: Path, plan: Plan, report: Report) -> None:
    """Do so for a simulator that somebody else started."""
    with SideChannel(channel) as open_channel:
        render_ahead(RunningSim(Path(), {}, open_channel), plan, report)
