"""The sharpest features of a MatCap, found by themselves: bumps and steps of brightness along the meridians."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import signal

from processing.matcap.estimate.meridians import Meridians
from processing.matcap.estimate.profiles import Of, Profiles
from processing.matcap.estimate.region_estimate import most_trusted
from processing.matcap.estimate.regions import Region
from processing.matcap.estimate.rules import settle
from processing.matcap.estimate.signatures import signatures

F64 = NDArray[np.float64]

# What is fainter than this share of the picture's range is taken for noise, texture, or the steps of 8 bits.
_LEAST_CONTRAST = 0.08
_TEXELS_A_MERIDIAN = 6
_SMOOTHING_TEXELS = 1.5
_MOST_CANDIDATES = 40
# Neighbours that agree on a feature: how many, within which share of its variance (and a pixel), how far apart.
_AGREEING, _AGREEMENT, _APART_MERIDIANS = 4, 0.12, 2.5
_SIDE_PX = 5
_REACH_DEVIATIONS = 2.0
# At the rim each pixel sees a wide angle, and one that a share of the background is in.
_NEAR_RIM = 1.25
# A step has no slope the other way so near, in its own standard deviations; the flank of a narrow light has.
_STEP_REACH, _STEP_PURITY = 4.0, 0.15


@dataclass(frozen=True)
class FoundRegion:
    """A feature that neighbouring meridians agree on."""

    region: Region
    of: Of
    variance: float


def find_regions(
    meridians: Meridians, clipped: NDArray[np.bool_], kinds: tuple[Of, ...], most: int
) -> list[FoundRegion]:
    """Find the features with the least variance, in a MatCap that may have none.

    Bumps (of R) and steps (of |R′|) are looked for along many meridians, and the narrowest are asked for their
    signatures. Those count whose signature has a plateau and whose profile is a Gaussian, that are not clipped, and
    that agree with neighbours.

    Parameters
    ----------
    clipped : (S, S) bool, pixels that may have been brighter than the picture could hold

    Returns
    -------
    found : at most so many, the sharpest first
    """
    found: list[FoundRegion] = []
    for of in kinds:
        theta, phi = _candidates(meridians, of)
        keep = ~_clipped_at(clipped, theta, phi)
        theta, phi = theta[keep][:_MOST_CANDIDATES], phi[keep][:_MOST_CANDIDATES]
        if theta.size:
            agreed = _agreed(meridians, theta, phi, of)
            # The flank of a light is no step, and a light that settles stands on no ground.
            found += [one for one in agreed if not any(_is_part(one, other, meridians.size) for other in found)]
    return sorted(found, key=lambda one: one.variance)[:most]


def _is_part(one: FoundRegion, other: FoundRegion, size: int) -> bool:
    """Whether a feature lies within another of another kind."""
    apart = 2 / size * np.hypot(one.region.x - other.region.x, one.region.y - other.region.y)
    return bool(one.of != other.of and apart < _REACH_DEVIATIONS * np.sqrt(other.variance))


def _candidates(meridians: Meridians, of: Of) -> tuple[F64, F64]:
    """Return (θ, φ) of bumps or steps that stand out, the narrowest first."""
    count = max(int(np.pi * meridians.size / 2 / _TEXELS_A_MERIDIAN), 24)
    phi = np.pi * np.arange(count) / count
    profiles = Profiles(meridians, np.zeros(count), phi, of, meridians.rim)
    inside = np.abs(profiles.t) < meridians.rim
    lines, t = profiles.smoothed(_SMOOTHING_TEXELS * meridians.texel)[:, inside], profiles.t[inside]
    values = Profiles(meridians, np.zeros(count), phi, "values", meridians.rim).smoothed(0)[:, inside]
    contrast = _LEAST_CONTRAST * float(np.ptp(values))
    rows = []
    for line, angle, value in zip(lines, phi, values, strict=True):
        peaks, about = signal.find_peaks(line, prominence=_LEAST_CONTRAST * lines.max())
        if not peaks.size or contrast <= 0:
            continue
        widths = signal.peak_widths(line, peaks, 0.5)[0] * profiles.spacing / 2.355
        for place, width, prominence in zip(peaks, widths, about["prominences"], strict=True):
            # The light that a step adds is the area under its slope.
            rise = prominence if of != "edges" else prominence * width * 2.5
            if rise > contrast and (of != "edges" or _is_step(value, int(place), width / profiles.spacing)):
                rows.append((width, t[place], angle))
    rows.sort()
    table = np.array(rows).reshape(-1, 3)
    table = table[np.abs(table[:, 1]) < _NEAR_RIM]
    return table[:, 1], table[:, 2]


def _is_step(values: F64, place: int, width: float) -> bool:
    near = values[max(place - int(_STEP_REACH * width), 0) : place + int(_STEP_REACH * width) + 1]
    change = np.diff(near)
    up, down = float(change[change > 0].sum()), float(-change[change < 0].sum())
    return min(up, down) < _STEP_PURITY * max(up, down)


def _clipped_at(clipped: NDArray[np.bool_], theta: F64, phi: F64) -> NDArray[np.bool_]:
    size = len(clipped)
    columns = ((1 + np.sin(theta) * np.cos(phi)) * size / 2).astype(int)
    rows = ((1 - np.sin(theta) * np.sin(phi)) * size / 2).astype(int)
    at: NDArray[np.bool_] = clipped[np.clip(rows, 0, size - 1), np.clip(columns, 0, size - 1)]
    return at


def _agreed(meridians: Meridians, theta: F64, phi: F64, of: Of) -> list[FoundRegion]:
    asked = signatures(meridians, theta, phi, of)
    settled = settle(asked, "plateau")
    misfits = asked.misfits[np.arange(len(theta)), settled.at]
    steepest, worst = most_trusted(of)
    good = np.isfinite(settled.variances) & (settled.slopes < steepest) & (misfits < worst)
    theta, phi, variances = theta[good], phi[good], settled.variances[good]
    x, y = np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi)
    found, taken = [], np.zeros(len(theta), np.bool_)
    for first in np.argsort(variances):
        if taken[first]:
            continue
        reach = _APART_MERIDIANS * _TEXELS_A_MERIDIAN * meridians.texel
        near = np.hypot(x - x[first], y - y[first]) < max(reach, np.sqrt(variances[first]))
        apart = _AGREEMENT * variances[first] + meridians.texel**2
        alike = near & (np.abs(variances - variances[first]) < apart)
        taken |= alike
        members = np.flatnonzero(alike)
        if len(members) >= _AGREEING:
            middle = members[np.argsort(variances[members])[len(members) // 2]]
            region = Region.around(float(theta[middle]), float(phi[middle]), meridians.size, _SIDE_PX)
            found.append(FoundRegion(region, of, float(variances[middle])))
    return found
