"""What one region of a MatCap says about its material's filter."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from processing.matcap.estimate.meridians import Meridians
from processing.matcap.estimate.profiles import Of
from processing.matcap.estimate.regions import Region
from processing.matcap.estimate.rules import Rule, Settled, settle
from processing.matcap.estimate.signatures import Signatures, signatures, signatures_by_equation_6

F64 = NDArray[np.float64]

# A signature that slopes more, or a profile that is less of a Gaussian, says little.
_TRUSTED_SLOPE, _TRUSTED_MISFIT = 0.15, 0.08
# Above a ground that is not straight no signature is level for long, but where the ground is right the Gaussian is too.
_TRUSTED_BUMP_SLOPE, _TRUSTED_BUMP_MISFIT = 0.4, 0.01
# Of the window within the disc, the share that must be the feature's own lest a neighbour is worth a word.
_NARROWED = 0.9
# Standard deviations in pixels below which the pixels themselves blur as much.
_RESOLVED_PX = 1.5


@dataclass(frozen=True)
class RegionEstimate:
    """What one region says.

    Attributes
    ----------
    of : "values" of R, "bumps" (R above its ground), or "edges"
    variance : rad², the chosen quantile over the region's pixels; NaN where all signatures are degenerate
    least, most : rad², over its pixels
    chosen : the pixel with that variance, or that nearest to it; −1 where none
    window : its ε* in radians
    slope : |d log variance/d log ε|, the median of its pixels: how much the choice of the window matters
    trusted : the signatures settle, and the profiles are one Gaussian
    """

    region: Region
    of: Of
    variance: float
    least: float
    most: float
    chosen: int
    window: float
    slope: float
    trusted: bool
    remarks: tuple[str, ...]
    signatures: Signatures
    settled: Settled


@dataclass(frozen=True)
class Question:
    """How regions are asked.

    Attributes
    ----------
    rule : which window of a signature counts
    quantile : 0 to 1, which pixel of a region counts
    clipped : (S, S) bool, pixels that may have been brighter than the picture could hold
    """

    rule: Rule
    quantile: float
    clipped: NDArray[np.bool_]


def most_trusted(of: Of) -> tuple[float, float]:
    """Return the steepest signature, and the greatest misfit, with which a profile is trusted."""
    if of == "bumps":
        return _TRUSTED_BUMP_SLOPE, _TRUSTED_BUMP_MISFIT
    return _TRUSTED_SLOPE, _TRUSTED_MISFIT


def best_of(meridians: Meridians, region: Region, kinds: tuple[Of, ...], question: Question) -> RegionEstimate:
    """Ask a region for its bump, its edge, or whichever it has.

    A bump has steep flanks, which pass for edges, but an edge does not pass for a bump: so bumps come first.
    """
    answers = [ask(meridians, region, of, question) for of in kinds]
    trusted = [one for one in answers if one.trusted]
    return trusted[0] if trusted else min(answers, key=lambda one: (np.isnan(one.variance), one.slope))


def ask(meridians: Meridians, region: Region, of: Of, question: Question) -> RegionEstimate:
    """Ask a region for the variance of R or |R′|.

    Raises
    ------
    InputError
        The region is not on the disc.
    """
    theta, phi = region.angles(meridians.size, meridians.rim)
    by_rule = signatures if question.rule == "plateau" else signatures_by_equation_6
    asked = by_rule(meridians, theta, phi, of)
    settled = settle(asked, question.rule)
    usable = settled.variances[np.isfinite(settled.variances)]
    if not usable.size:
        remark = f"region {region}: all its signatures are degenerate; choose a brighter, sharper place"
        return RegionEstimate(region, of, np.nan, np.nan, np.nan, -1, np.nan, np.inf, False, (remark,), asked, settled)
    variance = float(np.quantile(usable, question.quantile))
    chosen = int(np.nanargmin(np.abs(settled.variances - variance)))
    known = np.isfinite(settled.slopes)
    slope = float(np.median(settled.slopes[known])) if known.any() else np.inf
    misfit = _misfit(asked, settled)
    steepest, worst = most_trusted(of)
    remarks = []
    if _is_clipped(region, np.sqrt(variance), question.clipped):
        remarks.append("its light is clipped at white, which makes the filter size too large")
    if np.sqrt(variance) < _RESOLVED_PX * meridians.texel / np.cos(theta[chosen]):
        remarks.append("it is as sharp as pixels allow: the filter size is at most this")
    if question.rule == "plateau":
        if _is_narrowed(meridians, float(theta[chosen]), asked, settled, chosen):
            remarks.append("another light is near; what lies beyond the valley between is left out")
        if misfit >= worst:
            remarks.append(f"{misfit:.0%} of its profile is not under one Gaussian; choose a simpler light")
        if slope >= steepest:
            remarks.append("its signatures do not settle; choose a sharper light")
    return RegionEstimate(
        region=region,
        of=of,
        variance=variance,
        least=float(usable.min()),
        most=float(usable.max()),
        chosen=chosen,
        window=float(asked.windows[settled.at[chosen]]),
        slope=slope,
        trusted=slope < steepest and not misfit >= worst,
        remarks=tuple(f"region {region}: {remark}" for remark in remarks),
        signatures=asked,
        settled=settled,
    )


def _misfit(asked: Signatures, settled: Settled) -> float:
    rows = np.flatnonzero(settled.at >= 0)
    return float(np.median(asked.misfits[rows, settled.at[rows]]))


def _is_clipped(region: Region, reach: float, clipped: NDArray[np.bool_]) -> bool:
    size = len(clipped)
    seen = region.grown(int(np.ceil(reach * size / 2)), size)
    return bool(clipped[seen.y : seen.y + seen.height, seen.x : seen.x + seen.width].any())


def _is_narrowed(meridians: Meridians, theta: float, asked: Signatures, settled: Settled, chosen: int) -> bool:
    window, width = asked.windows[settled.at[chosen]], asked.widths[chosen, settled.at[chosen]]
    in_disc = (min(window, meridians.rim - theta) + min(window, meridians.rim + theta)) / 2
    return bool(width < _NARROWED * in_disc)
