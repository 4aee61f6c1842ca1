"""A page about a build: what was found, how sure that is, and what a smaller table would cost."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from litrig.base.page import Figure, Section, Table, write_page
from litrig.base.pictures import write_picture
from litrig.base.plots import ACCENT, QUIET, plot
from processing.amc.build import AmcResult
from processing.amc.isotropic import isotropic_matcap
from processing.amc.low_rank import RankError, error_curve
from processing.amc.report import describe

F32 = NDArray[np.float32]

_SLICES_SHOWN, _SMALLEST_SIDE_PX = 8, 128
_RANKS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128)


def write_report(folder: Path, results: Mapping[str, AmcResult]) -> Path:
    """Write FOLDER/index.html and its pictures; return the page.

    Parameters
    ----------
    results : by what tells their files apart; "" where there is one
    """
    folder.mkdir(parents=True, exist_ok=True)
    sections = [section for name, result in results.items() for section in _sections(folder, name, result)]
    first = next(iter(results.values()))
    page = folder / "index.html"
    depth, size = first.amc.slices.shape[:2]
    captured = len(first.amc.slice_angles_deg)
    lead = f"{captured} captured slices became {depth} of {size} × {size}. Digest of the frames: {first.amc.source}"
    write_page(page, "Anisotropic MatCap", lead, sections)
    return page


def _sections(folder: Path, name: str, result: AmcResult) -> list[Section]:
    title, prefix = (f" ({name})", f"{name}_") if name else ("", "")
    # The evidence on each R has a table of its own.
    text = " ".join(f"{line[0].upper()}{line[1:]}." for line in describe(result) if not line.startswith(" "))
    return [
        Section(f"Slices{title}", text, _slices(folder, prefix, result)),
        _invariance(folder, prefix, title, result),
        _residuals(folder, prefix, title, result),
        _ranks(folder, prefix, title, result),
    ]


def _slices(folder: Path, prefix: str, result: AmcResult) -> list[Figure]:
    amc = result.amc
    shown = np.unique(np.linspace(0, len(amc.slices), min(_SLICES_SHOWN, len(amc.slices)), endpoint=False).astype(int))
    figures = []
    for index in shown:
        angle_deg = 360 * index / (amc.repeats * len(amc.slices))
        figures.append(_picture(folder, f"{prefix}slice_{index:03d}.png", amc.slices[index], f"k at {angle_deg:.1f}°"))
    figures.append(_picture(folder, f"{prefix}mean.png", isotropic_matcap(amc), "mean of all: the isotropic MatCap"))
    if result.flaws.filled:
        marks = np.full((*result.flaws.turning.shape, 3), 0.05, np.float32)
        marks[result.flaws.turning], marks[result.flaws.still] = (1, 0.6, 0.1), (0.2, 0.6, 1)
        caption = "folds and cuts (orange) and still pixels (blue), as the first picture shows them"
        figures.append(_picture(folder, f"{prefix}flaws.png", marks, caption))
    return figures


def _picture(folder: Path, file: str, linear: F32, caption: str) -> Figure:
    times = max(1, _SMALLEST_SIDE_PX // len(linear))
    write_picture(folder / file, linear.repeat(times, axis=0).repeat(times, axis=1))
    return Figure(file, caption, size=(times * linear.shape[1], times * linear.shape[0]))


def _invariance(folder: Path, prefix: str, title: str, result: AmcResult) -> Section:
    found = result.invariance
    file = f"{prefix}rotation.png"
    turns_deg = np.linspace(0, 360, 361)
    with plot(folder / file) as axes:
        axes.plot(turns_deg, found.rotation_difference(turns_deg), color=ACCENT)
        axes.axhline(found.noise * np.sqrt(2), color=QUIET, linestyle=":", label="noise alone")
        axes.set(xlabel="sample turned by, degrees", ylabel="RMS difference, linear light", xticks=range(0, 361, 45))
        axes.legend(frameon=False, labelcolor=QUIET)
    text = (
        "Where the curve comes down to the noise, the turned material looks the same (the AMC paper, figure 4). "
        f"Verdict: {found.found}, in {found.confidence:.0%} of resamplings of the sphere's regions. "
        f"The change has {found.over_noise:.3g} times the noise's energy."
    )
    rows = [
        (entry.repeats, f"{entry.outside_surface:.2%}", f"{entry.outside_picture:.2%}", f"{entry.rotation_rms:.2e}")
        for entry in found.evidence[1:]
    ]
    table = Table(("R", "outside, in the surface", "outside, in the picture", "RMS after 360°/R"), rows)
    caption = "RMS difference between the slices and the slices turned"
    return Section(f"Invariance{title}", text, [Figure(file, caption, wide=True)], table)


def _residuals(folder: Path, prefix: str, title: str, result: AmcResult) -> Section:
    file = f"{prefix}residuals.png"
    with plot(folder / file) as axes:
        axes.plot(result.amc.slice_angles_deg, result.residuals, ".", color=ACCENT)
        axes.axhline(result.invariance.noise, color=QUIET, linestyle=":", label="noise")
        axes.set(xlabel="tangent angle of the slice, degrees", ylabel="RMS residual, linear light", ylim=(0, None))
        axes.legend(frameon=False, labelcolor=QUIET)
    text = f"What the table leaves of each slice. {result.coverage:.1%} of the disc was seen."
    if result.flaws.filled:
        text += f" {result.flaws.filled:.1%} of its values were filled."
    return Section(f"Residuals{title}", text, [Figure(file, "residual of each captured slice", wide=True)])


def _ranks(folder: Path, prefix: str, title: str, result: AmcResult) -> Section:
    curve = error_curve(result.amc, [rank for rank in _RANKS if rank <= len(result.amc.slices)])
    file = f"{prefix}ranks.png"
    with plot(folder / file) as axes:
        lossy = [entry for entry in curve if np.isfinite(entry.psnr_db)]
        axes.plot(
            [entry.stored_bytes / 2**20 for entry in lossy], [entry.psnr_db for entry in lossy], ".-", color=ACCENT
        )
        axes.set(xlabel="MiB as floats, before packing", ylabel="PSNR, dB")
    rows = [(entry.rank, f"{entry.stored_bytes / 2**20:.2f}", _decibels(entry)) for entry in curve]
    text = "What a low-rank table (X.amc.exr) of so many pictures would cost and yield."
    figure = Figure(file, "error against memory", wide=True)
    return Section(f"Fewer pictures{title}", text, [figure], Table(("rank", "MiB", "PSNR, dB"), rows))


def _decibels(entry: RankError) -> str:
    return f"{entry.psnr_db:.1f}" if np.isfinite(entry.psnr_db) else "nothing lost"
