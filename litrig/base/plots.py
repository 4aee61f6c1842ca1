"""Plots in the colours of the pages."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from litrig.base.files import replacing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

INK, QUIET, LINE, PAPER, ACCENT = "#e8e6e1", "#a09c94", "#34322e", "#191816", "#d9a75a"
DPI = 150


@contextmanager
def plot(path: Path, size_inch: tuple[float, float] = (6.0, 3.4)) -> Iterator["Axes"]:
    """Yield axes to draw on, and write them as PNG when the body ends.

    No global state is touched: the figure belongs to nobody else.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=size_inch, dpi=DPI, facecolor=PAPER, layout="constrained")
    axes = figure.add_subplot(facecolor=PAPER)
    axes.tick_params(colors=QUIET)
    axes.xaxis.label.set_color(QUIET)
    axes.yaxis.label.set_color(QUIET)
    for spine in axes.spines.values():
        spine.set_color(LINE)
    axes.spines[["top", "right"]].set_visible(False)
    yield axes
    with replacing(path) as temporary:
        figure.savefig(temporary, facecolor=PAPER)
