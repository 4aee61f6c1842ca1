"""The plot of signatures (the MatCap paper, figure 4)."""

from pathlib import Path

import numpy as np

from litrig.base.plots import ACCENT, INK, LINE, QUIET, plot
from processing.matcap.estimate.estimate import FilterEstimate


def plot_signatures(path: Path, estimate: FilterEstimate) -> None:
    """Draw variance over the window's size at every pixel of the region that decided, and mark where it was read.

    The signature that was chosen is bright, and so is its cross. Other regions are grey.

    Raises
    ------
    InputError
        The picture cannot be written.
    """
    with plot(path) as axes:
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel("half width of the window ε, degrees")
        axes.set_ylabel("variance, rad²")
        axes.grid(color=LINE, linewidth=0.6)
        for index, region in enumerate(estimate.regions):
            decided = index == estimate.chosen
            degrees = np.degrees(region.signatures.windows)
            for row, variances in enumerate(region.signatures.variances):
                if np.isfinite(variances).any() and not (decided and row == region.chosen):
                    axes.plot(degrees, variances, color=ACCENT if decided else QUIET, linewidth=0.6, alpha=0.45)
            if decided:
                axes.plot(degrees, region.signatures.variances[region.chosen], color=INK, linewidth=1.4)
                axes.plot(np.degrees(region.window), region.variance, "x", color=INK, markersize=9, markeredgewidth=2)
                axes.axhline(region.variance, color=INK, linewidth=0.6, linestyle=":")
                axes.set_ylim(region.variance / 20, region.variance * 20)
        axes.set_title(f"filter size {estimate.filter_size:.4g} rad²", color=INK, fontsize=10)
