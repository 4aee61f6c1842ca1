"""The plots of a report, each one function from data to a PNG."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from acquisition.consistency import Suspect
from acquisition.plans import Step
from acquisition.report.times import PARTS, StepTimes
from acquisition.report.tones import Tones
from litrig.base.directions import direction_from_angles
from litrig.base.plots import ACCENT, INK, LINE, QUIET, plot

if TYPE_CHECKING:
    from matplotlib.axes import Axes

F64 = NDArray[np.float64]

WIDE, HALF, SQUARE = (11.5, 3.4), (5.6, 3.4), (5.6, 5.4)
RED, BLUE, GREEN, VIOLET = "#e25c4a", "#689cde", "#5cb8a0", "#d65cbe"
_PART_COLOURS = dict(zip(PARTS, (BLUE, GREEN, ACCENT, VIOLET), strict=True))
_FEW, _MANY = 40, 300
_STEEP = 3.0


def plot_tones(path: Path, tones: Tones) -> None:
    """Draw the histogram of every frame as a column, log counts, with median and spread."""
    with plot(path, WIDE) as axes:
        counts = np.log10(1 + tones.histograms.T)
        extent = (-0.5, len(tones.steps) - 0.5, 0.0, 1.0)
        axes.imshow(counts, origin="lower", aspect="auto", extent=extent, cmap="magma", interpolation="nearest")
        places = np.arange(len(tones.steps))
        axes.plot(places, tones.quantile(0.5), color=INK, linewidth=1.2, label="median")
        for share in (0.05, 0.95):
            label = "5 % and 95 %" if share < 0.5 else None
            axes.plot(places, tones.quantile(share), color=ACCENT, linewidth=0.9, label=label)
        axes.set(xlabel="frame, in the order of the plan", ylabel="display value", ylim=(0, 1))
        _legend(axes)


def plot_exposure(path: Path, steps: Sequence[int], means: F64) -> None:
    """Draw the mean of each frame."""
    with plot(path, HALF) as axes:
        _dots(axes, steps, means, ACCENT)
        axes.set(xlabel="step", ylabel="mean display value", ylim=(0, max(0.05, 1.15 * float(np.nanmax(means)))))


def plot_clipped(path: Path, steps: Sequence[int], clipped: F64, limit: float) -> None:
    """Draw the clipped share of each frame, in per cent, and where it becomes a remark."""
    with plot(path, HALF) as axes:
        axes.vlines(steps, 0, 100 * clipped, color=RED, linewidth=1.4)
        _dots(axes, steps, 100 * clipped, RED)
        top = max(1.2 * float(np.nanmax(100 * clipped)), 0.5)
        _limit(axes, 100 * limit, "remark", top)
        axes.set(xlabel="step", ylabel="clipped pixels, %", ylim=(-0.02 * top, top))


def plot_sharpness(path: Path, minutes: F64, sharpness: F64, name: str) -> None:
    """Draw the sharpness of each frame over the time of shooting."""
    with plot(path, HALF) as axes:
        axes.plot(minutes, sharpness, "o", markersize=3, color=BLUE)
        axes.set(xlabel="minutes since the first frame", ylabel=name, ylim=(0, 1.15 * float(np.nanmax(sharpness))))


def plot_drift(path: Path, drifts: Sequence[tuple[str, F64, F64]]) -> None:
    """Draw the light of frames of one pose over time, each relative to the first: name, minutes, ratios."""
    with plot(path, HALF) as axes:
        axes.axhline(0, color=LINE, linewidth=1)
        for index, (name, minutes, ratios) in enumerate(drifts):
            colour = (ACCENT, BLUE, GREEN, VIOLET, RED, INK)[index % 6]
            axes.plot(minutes, 100 * (ratios - 1), "o-", markersize=4, linewidth=1, color=colour, label=name)
        largest = max(float(np.nanmax(np.abs(100 * (ratios - 1)))) for _, _, ratios in drifts)
        axes.set(
            xlabel="minutes since the first frame",
            ylabel="light, % from the first",
            ylim=(-1.3 * largest - 0.5, 2.2 * largest + 1),
        )
        _legend(axes, columns=2)


def plot_pose(path: Path, steps: Sequence[int], before_deg: F64, after_deg: F64, tolerance_deg: float | None) -> None:
    """Draw how far a part was from its pose before and after each exposure."""
    with plot(path, HALF) as axes:
        axes.plot(steps, before_deg, "o", markersize=4, markerfacecolor="none", color=BLUE, label="before")
        axes.plot(steps, after_deg, "o", markersize=2.4, color=ACCENT, label="after")
        largest = float(np.nanmax(np.concatenate([before_deg, after_deg, [tolerance_deg or 0.0]])))
        top = 1.25 * largest or 0.1
        if tolerance_deg is not None:
            _limit(axes, tolerance_deg, "tolerance", top)
        axes.set(xlabel="step", ylabel="pose error, deg", ylim=(-0.03 * top, top))
        _legend(axes)


def plot_times(path: Path, times: StepTimes) -> int:
    """Draw the times of each frame in the order of shooting, stacked; return how many go beyond the plot's top."""
    parts = np.nan_to_num(times.parts_s)
    places, bottom = np.arange(len(times.steps)), np.zeros(len(times.steps))
    totals = parts.sum(axis=1)
    top = min(float(totals.max()), _STEEP * float(np.quantile(totals, 0.95))) or 1.0
    with plot(path, WIDE) as axes:
        for part, column in zip(PARTS, parts.T, strict=True):
            if not column.any():
                continue
            if len(places) <= _MANY:
                axes.bar(places, column, bottom=bottom, width=0.86, color=_PART_COLOURS[part], label=part)
            else:  # one shape in place of thousands
                ends = (bottom, bottom + column)
                axes.fill_between(places, *ends, step="mid", color=_PART_COLOURS[part], linewidth=0, label=part)
            bottom = bottom + column
        axes.set(
            xlabel="frame, in the order of shooting",
            ylabel="seconds",
            ylim=(0, 1.1 * top),
            xlim=(-0.8, len(places) - 0.2),
        )
        _legend(axes)
    return int(np.count_nonzero(totals > 1.1 * top))


def plot_lights(path: Path, wanted: Sequence[Step], taken: Mapping[int, F64], suspects: Sequence[Suspect]) -> None:
    """Draw light directions on the disc of (l_u, l_v): wanted, taken, missing, and where suspects look lit from.

    Parameters
    ----------
    taken : (3,) the direction of each step's frame
    """
    with plot(path, SQUARE) as axes:
        turn = np.linspace(0, 2 * np.pi, 181)
        for elevation_deg in (0, 30, 60):
            radius = np.cos(np.radians(elevation_deg))
            axes.plot(
                radius * np.cos(turn), radius * np.sin(turn), color=LINE if elevation_deg else QUIET, linewidth=0.8
            )
            axes.annotate(
                f"{elevation_deg}°", (0, -radius), (3, 3), textcoords="offset points", color=QUIET, fontsize=7
            )
        aims = {
            step.step: direction_from_angles(step.aim.azimuth_deg, step.aim.elevation_deg)
            for step in wanted
            if step.aim
        }
        missing = [direction for step, direction in aims.items() if step not in taken]
        _points(
            axes, list(aims.values()), "o", QUIET, "wanted", markersize=8, markerfacecolor="none", markeredgewidth=0.7
        )
        _points(axes, list(taken.values()), "o", ACCENT, "taken", markersize=4)
        _points(axes, missing, "x", RED, "missing", markersize=7)
        for suspect in suspects:
            said, looks = (direction_from_angles(*angles) for angles in (suspect.said_deg, suspect.looks_deg))
            axes.annotate(
                "",
                (looks[0], looks[1]),
                (said[0], said[1]),
                arrowprops={"arrowstyle": "->", "color": VIOLET, "linewidth": 1.1},
            )
        _points(
            axes,
            [direction_from_angles(*one.said_deg) for one in suspects],
            "o",
            VIOLET,
            "lit from elsewhere?",
            markersize=6,
        )
        axes.set(
            xlabel="$l_u$, to the right", ylabel="$l_v$, up", aspect="equal", xlim=(-1.08, 1.08), ylim=(-1.08, 1.08)
        )
        _legend(axes, below=True)


def _points(axes: "Axes", directions: Sequence[F64], marker: str, colour: str, label: str, **style: object) -> None:
    if not directions:
        return
    u, v = np.array(directions)[:, :2].T
    axes.plot(u, v, marker, linestyle="none", color=colour, label=label, **style)  # type: ignore[arg-type]


def _dots(axes: "Axes", steps: Sequence[int], values: F64, colour: str) -> None:
    style = "o-" if len(steps) <= _FEW else "o"
    axes.plot(steps, values, style, markersize=3.2 if len(steps) <= _MANY else 1.8, linewidth=0.8, color=colour)


def _limit(axes: "Axes", value: float, name: str, top: float) -> None:
    if value > top:
        return
    axes.axhline(value, color=RED, linewidth=0.9, linestyle=(0, (5, 4)))
    axes.annotate(
        name,
        (1, value),
        (-2, 3),
        xycoords=("axes fraction", "data"),
        textcoords="offset points",
        ha="right",
        color=RED,
        fontsize=8,
    )


def _legend(axes: "Axes", *, columns: int = 4, below: bool = False) -> None:
    style: dict[str, Any] = {"frameon": False, "labelcolor": QUIET, "fontsize": 8, "ncols": columns}
    if below:
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), **style)
    else:
        axes.legend(loc="upper right", **style)
