"""A picture of what a plan covers: lights in the disc that the camera looks at, angles of the turntable around it."""

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from acquisition.coverage import Coverage, LightCoverage
from acquisition.plans import Aim, Plan
from litrig.base.directions import F64, direction_from_angles
from litrig.base.plots import ACCENT, INK, LINE, PAPER, QUIET, plot

if TYPE_CHECKING:
    from matplotlib.axes import Axes

CIRCLES_DEG = (0, 15, 30, 45, 60, 75)
LABELS_AT_RAD = math.radians(-67.5)
RING = 1.14
"""Radius of the turntable's ring, where the hemisphere's edge is 1."""
TICK = 0.05


def plot_coverage(path: Path, plan: Plan, covered: Coverage) -> None:
    """Draw a plan's lights at (l_u, l_v) with the order of shooting, and its turntable angles as a ring.

    The dashed line is the edge of the largest cap without a light.

    Raises
    ------
    InputError
        The picture cannot be written.
    """
    with plot(path, (6.0, 6.0)) as axes:
        axes.set_aspect("equal")
        axes.set_axis_off()
        if covered.lights is not None:
            _draw_disc(axes)
            _draw_gap(axes, covered.lights)
            _draw_lights(axes, plan.poses.aims)
        if plan.poses.turn is not None:
            _draw_turn(axes, np.unique(np.fromiter(plan.poses.turn, float)))
        axes.set_title(_title(plan), color=INK, fontsize=10)


def _draw_disc(axes: "Axes") -> None:
    for elevation_deg in CIRCLES_DEG:
        radius = math.cos(math.radians(elevation_deg))
        axes.plot(*_circle(radius), color=LINE, linewidth=1, zorder=0)
        if elevation_deg:
            u, v = radius * math.cos(LABELS_AT_RAD), radius * math.sin(LABELS_AT_RAD)
            axes.text(
                u, v, f"{elevation_deg}°", color=QUIET, fontsize=7, ha="center", va="center", zorder=0.5
            ).set_bbox({"facecolor": PAPER, "edgecolor": "none", "pad": 1.0})
    for angle_rad in np.radians(range(0, 180, 45)):
        ends = np.array([-1.0, 1.0])
        axes.plot(ends * math.cos(angle_rad), ends * math.sin(angle_rad), color=LINE, linewidth=0.6, zorder=0)
    axes.annotate("u", (1.03, 0), color=QUIET, fontsize=9, va="center")
    axes.annotate("v", (0, 1.03), color=QUIET, fontsize=9, ha="center")


def _draw_lights(axes: "Axes", aims: tuple[Aim, ...]) -> None:
    directions = np.array([direction_from_angles(aim.azimuth_deg, aim.elevation_deg) for aim in aims])
    u, v, height = directions.T
    front = height >= 0
    axes.plot(u, v, color=ACCENT, linewidth=0.8, alpha=0.55, zorder=2)
    size = min(28.0, 2500 / len(aims))
    axes.scatter(u[front], v[front], s=size, color=ACCENT, zorder=3)
    axes.scatter(u[~front], v[~front], s=size, facecolors="none", edgecolors=ACCENT, zorder=3)
    axes.scatter(u[:1], v[:1], s=3 * size, facecolors="none", edgecolors=INK, linewidths=1.2, zorder=4)
    axes.annotate("first", (u[0], v[0]), xytext=(7, 7), textcoords="offset points", color=INK, fontsize=8, zorder=4)


def _draw_gap(axes: "Axes", covered: LightCoverage) -> None:
    """Draw the edge of the largest empty cap, as far as it is in front."""
    middle = direction_from_angles(covered.gap_azimuth_deg, covered.gap_elevation_deg)
    aside = np.cross(middle, np.eye(3)[int(np.argmin(np.abs(middle)))])
    aside /= np.linalg.norm(aside)
    along, across = _circle(math.sin(math.radians(covered.gap_deg)))
    edge = math.cos(math.radians(covered.gap_deg)) * middle[:, None]
    edge = edge + aside[:, None] * along + np.cross(middle, aside)[:, None] * across
    edge[:, edge[2] < 0] = np.nan
    axes.plot(edge[0], edge[1], color=QUIET, linewidth=1, linestyle="--", zorder=1)


def _draw_turn(axes: "Axes", angles_deg: F64) -> None:
    axes.plot(*_circle(RING), color=LINE, linewidth=1, zorder=0)
    angles = np.radians(angles_deg)
    radii = np.array([RING - TICK / 2, RING + TICK / 2, np.nan])  # not a number lifts the pen
    u, v = np.cos(angles)[:, None] * radii, np.sin(angles)[:, None] * radii
    axes.plot(u.ravel(), v.ravel(), color=ACCENT, linewidth=0.9, zorder=1)
    u, v = math.cos(angles[0]), math.sin(angles[0])
    axes.plot([RING * u, (RING + 2 * TICK) * u], [RING * v, (RING + 2 * TICK) * v], color=INK, linewidth=1.6, zorder=2)
    far = RING + 3.6 * TICK
    axes.annotate(f"{angles_deg[0]:g}°", (far * u, far * v), color=INK, fontsize=8, ha="center", va="center")


def _circle(radius: float) -> tuple[F64, F64]:
    around = np.linspace(0, 2 * math.pi, 361)
    return radius * np.cos(around), radius * np.sin(around)


def _title(plan: Plan) -> str:
    parts = []
    if plan.poses.aims:
        parts.append(f"{len(plan.poses.aims)} lights in the order of shooting")
    if plan.poses.turn is not None:
        parts.append(f"{plan.poses.turn.slices} angles of the turntable")
    return "; ".join(parts)
