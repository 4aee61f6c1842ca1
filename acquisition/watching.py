"""A session seen by its operator: progress with one live line of quality a frame, and what a person is asked for."""

from collections.abc import Callable

from acquisition.events import FrameTaken, Retried, RunEvent
from acquisition.session import Operator, Outlook
from litrig.base.progress import Progress, Report


def watching(
    job: str,
    report: Report,
    ask: Callable[[str], bool] = lambda what: False,
    expect: Callable[[Outlook], None] = lambda outlook: None,
) -> Operator:
    """Return an operator to whom a run is reported as progress of `job`."""
    done = 0

    def watch(event: RunEvent, total: int) -> None:
        nonlocal done
        if isinstance(event, FrameTaken):
            done += 1
            report(Progress(job, done, total, _live_line(event)))
        elif isinstance(event, Retried):
            report(Progress(job, done, total, f"step {event.step.step}, try {event.attempt}: {event.reason}"))

    return Operator(expect=expect, watch=watch, ask=ask)


def _live_line(event: FrameTaken) -> str:
    quality = event.quality
    return (
        f"mean {quality.mean:.2f}  clipped {100 * quality.clipped:.1f} %  sharp {quality.sharpness:.4f}  "
        f"pose ±{event.pose_error_deg:.2f}°"
    )
