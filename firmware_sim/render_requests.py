"""What can be asked over the side channel about rendered pictures."""

from collections.abc import Callable
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, validate_call

from firmware_sim.config import SimConfig
from firmware_sim.mitsuba.config import MitsubaScene
from firmware_sim.render_queue import Job, RenderQueue
from firmware_sim.resting import resting_pose
from firmware_sim.scene.pose import PlannedPose, Pose
from firmware_sim.scene.relevance import standard
from firmware_sim.scene.rendering import relevance_of
from firmware_sim.side_channel import Answer, Handler

BATCH = 400
"""Poses that fit into one request."""

Side = Annotated[int, Field(ge=1, le=4096)]
Angles = tuple[FiniteFloat, FiniteFloat, FiniteFloat, FiniteFloat]


class PoseRequest(BaseModel):
    """A planned pose on the wire."""

    model_config = ConfigDict(extra="forbid")

    turntable_deg: FiniteFloat | None = None
    azimuth_deg: FiniteFloat | None = None
    elevation_deg: FiniteFloat | None = None
    lamp: FiniteFloat = Field(default=1.0, ge=0, le=1)


def render_requests(queue: RenderQueue, config: SimConfig, pose_now: Callable[[], Pose]) -> dict[str, Handler]:
    """Return the requests of the front door (ahead, progress), the camera (urgent) and the renderer (the rest)."""
    size = (config.camera.height, config.camera.width)

    def job_of(planned: PoseRequest) -> Job:
        pose = resting_pose(PlannedPose(**planned.model_dump()), pose_now(), config)
        return Job(standard(relevance_of(config.scene).of(pose)), size)

    @validate_call
    def ahead(poses: Annotated[list[PoseRequest], Field(max_length=BATCH)], anew: bool = True) -> Answer:
        """Render the pictures of poses before they are needed, in place of the plan before unless told otherwise."""
        if isinstance(config.scene, MitsubaScene):
            queue.ahead(map(job_of, poses), anew=anew)
        return queue.progress()

    @validate_call
    def progress() -> Answer:
        return queue.progress()

    @validate_call
    def urgent(pose: Angles, size: tuple[Side, Side]) -> Answer:
        """Render one picture before all others."""
        queue.urgent(Job(Pose(*pose), size))
        return {}

    @validate_call
    def following() -> Answer:
        """Return what to render next, None for nothing."""
        return {"job": queue.next()}

    @validate_call
    def finished(pose: Angles, size: tuple[Side, Side]) -> Answer:
        """Take note that a picture is in the cache."""
        queue.finished(Job(Pose(*pose), size))
        return {}

    @validate_call
    def failed(reason: str) -> Answer:
        """Take note that nothing more will be rendered."""
        queue.fail(reason)
        return {}

    return {
        "render.ahead": ahead,
        "render.progress": progress,
        "render.urgent": urgent,
        "render.next": following,
        "render.finished": finished,
        "render.failed": failed,
    }
