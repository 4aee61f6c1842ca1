"""What `litrig capture plan` says of a plan, in lines for people and as JSON for programs."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from acquisition.coverage import Coverage, LightCoverage, TurnCoverage
    from acquisition.forecast import Forecast
    from acquisition.plans import Plan

NEAR_ZENITH_DEG = 89.5
"""From here on the azimuth tells nothing."""


@dataclass(frozen=True)
class PlanReport:
    """Everything that is known of a plan before it is shot.

    Attributes
    ----------
    free_bytes : on the disk where it would go; None if that is not known
    remarks : what a person should know besides
    """

    plan: "Plan"
    forecast: "Forecast"
    coverage: "Coverage"
    free_bytes: int | None = None
    remarks: tuple[str, ...] = ()

    @property
    def by_role(self) -> Mapping[str, int]:
        """How many steps each role has."""
        return Counter(step.role.value for step in self.plan)

    @property
    def asks(self) -> list[tuple[int, str]]:
        """Before which steps a person is asked for what."""
        return [(step.step, step.ask) for step in self.plan if step.ask]

    def as_json(self) -> Mapping[str, Any]:
        """Return it for programs."""
        return {
            "kind": self.plan.kind,
            "steps": len(self.plan),
            "by_role": dict(self.by_role),
            "asks": [{"step": step, "ask": ask} for step, ask in self.asks],
            "forecast": self.forecast.as_json(),
            "coverage": self.coverage.as_json(),
            "free_bytes": self.free_bytes,
            "remarks": list(self.remarks),
            "plan": self.plan.parameters(),
        }

    def lines(self) -> Iterator[str]:
        """Yield it line by line."""
        roles = ", ".join(f"{count} {role}" for role, count in self.by_role.items())
        yield f"steps     {len(self.plan)}: {roles}"
        yield from self._time()
        yield from self._way()
        if self.coverage.lights is not None:
            yield from _lights(self.coverage.lights)
        if self.coverage.turn is not None:
            yield _turn(self.coverage.turn)
        free = "" if self.free_bytes is None else f", {size_text(self.free_bytes)} free"
        yield f"disk      about {size_text(self.forecast.disk_bytes)}{free}"
        for step, ask in self.asks:
            yield f"person    before step {step}: {ask}"
        for assumption in self.forecast.assumptions:
            yield f"assumed   {assumption}"
        for remark in self.remarks:
            yield f"note      {remark}"

    def _time(self) -> Iterator[str]:
        expected = self.forecast
        waiting = ", and what the person needs" if expected.asks else ""
        yield f"time      {time_text(expected.total_s)}{waiting}"
        parts = {
            "homing and parking": expected.homing_s,
            "moves": expected.moves_s,
            "settling": expected.settles_s,
            "exposures": expected.exposures_s,
            "judging and saving": expected.steps_s,
        }
        yield "          " + ", ".join(f"{name} {time_text(seconds)}" for name, seconds in parts.items())

    def _way(self) -> Iterator[str]:
        ways = {"turntable": self.forecast.table_deg, "light arm": self.forecast.arm_deg}
        told = [f"{name} {way_deg:,.0f}°" for name, way_deg in ways.items() if way_deg]
        if told:
            yield f"path      {', '.join(told)}"


def _lights(covered: "LightCoverage") -> Iterator[str]:
    yield (
        f"lights    {covered.lights} at elevations {covered.min_elevation_deg:.1f}..{covered.max_elevation_deg:.1f}°, "
        f"{covered.spacing_deg:.1f}° from neighbour to neighbour (the nearest two {covered.nearest_deg:.1f}°)"
    )
    azimuth = "" if covered.gap_elevation_deg > NEAR_ZENITH_DEG else f"azimuth {covered.gap_azimuth_deg:.0f}°, "
    yield (
        f"          the largest cap without a light: {covered.gap_deg:.1f}° around {azimuth}elevation "
        f"{covered.gap_elevation_deg:.0f}°"
    )


def _turn(covered: "TurnCoverage") -> str:
    largest = f"{covered.step_deg:.4g}° apart"
    if covered.gap_deg > covered.step_deg + 1e-3:
        largest += f", largest gap {covered.gap_deg:.4g}°"
    return f"turn      {covered.slices} angles from {covered.first_deg:g}° to {covered.last_deg:.6g}°, {largest}"


def time_text(seconds: float) -> str:
    """Say a time as people do."""
    if seconds < 99.5:
        return f"{seconds:.0f} s"
    if seconds < 599.5:
        minutes, rest = divmod(round(seconds), 60)
        return f"{minutes} min {rest:02d} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 100 else f"{minutes // 60} h {minutes % 60:02d} min"


def size_text(size_bytes: float) -> str:
    """Say a size in powers of 1000."""
    power = min(4, max(1, math.floor(math.log10(max(size_bytes, 1)) / 3)))
    return f"{size_bytes / 1000**power:.3g} {['kB', 'MB', 'GB', 'TB'][power - 1]}"
