"""The machine's clock: timing never depends on it, but the labels in journals do."""

from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path

from rig.doctor.finding import Findings, Part


def _now() -> datetime:
    return datetime.now(UTC)


def check_clock(now: Callable[[], datetime] = _now) -> Findings:
    """Compare with the youngest thing that is known to lie in the past: this program."""
    part = Part("clock")
    time = now()
    made = datetime.fromtimestamp(Path(__file__).stat().st_mtime, UTC)
    if time < made:
        yield part.warning(
            "time",
            f"it is {time:%Y-%m-%d %H:%M} UTC by this machine, which is before litrig was installed",
            "set the clock (timedatectl set-ntp true); sessions would bear wrong dates",
        )
    else:
        yield part.ok("time", f"{time:%Y-%m-%d %H:%M} UTC")
