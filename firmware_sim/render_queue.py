"""What is to be rendered, in which order, and how far that is."""

from collections.abc import Iterable
from typing import NamedTuple

from firmware_sim.scene.pose import Pose, Size


class Job(NamedTuple):
    """One picture."""

    pose: Pose
    size: Size


class RenderQueue:
    """A plan, and before it the one picture that the camera waits for.

    Parameters
    ----------
    room : how many pictures of a plan may be rendered ahead; the others have to wait until the camera needs them
    note : something that a person should know about the rendering
    """

    def __init__(self, room: int, note: str = "") -> None:
        self._room = room
        self._note = note
        self._plan: dict[Job, None] = {}
        self._urgent: Job | None = None
        self._total = 0
        self._left_out = 0
        self._failed = ""

    def ahead(self, jobs: Iterable[Job], *, anew: bool) -> None:
        """Take up a plan, in place of the one before or behind it; a picture that comes up twice counts once."""
        if anew:
            self._plan, self._total, self._left_out = {}, 0, 0
        for job in jobs:
            if job in self._plan:
                continue
            if self._total < self._room:
                self._plan[job] = None
                self._total += 1
            else:
                self._left_out += 1

    def urgent(self, job: Job) -> None:
        """Put a picture before all others, and forget an older one of this kind: the devices are elsewhere by now."""
        self._urgent = job

    def next(self) -> Job | None:
        """Return what to render now; it stays in the queue until it is `finished`."""
        return self._urgent or next(iter(self._plan), None)

    def finished(self, job: Job) -> None:
        self._plan.pop(job, None)
        if self._urgent == job:
            self._urgent = None

    def fail(self, reason: str) -> None:
        """Say why nothing more will be rendered; the first reason stays."""
        self._failed = self._failed or reason

    def progress(self) -> dict[str, object]:
        """Return how many of the plan's pictures are there, of how many, and `failed`, a reason or nothing."""
        notes = [self._note] if self._note else []
        if self._left_out:
            notes.append(f"{self._left_out} pictures have no room in the cache: rendered when the rig gets there")
        done = self._total - len(self._plan)
        return {"done": done, "total": self._total, "note": "; ".join(notes), "failed": self._failed}
