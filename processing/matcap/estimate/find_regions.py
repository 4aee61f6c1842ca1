"""The sharpest features of a MatCap, found by themselves: bumps and steps of brightness along the meridians."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, signal

from processing.matcap.estimate.meridians import Meridians
from processing.matcap.estimate.profiles import SAMPLES_A_TEXEL, Of, Profiles
from processing.matcap.estimate.region_estimate import most_trusted
from processing.matcap.estimate.regions import Region
from processing.matcap.estimate.rules import settle
from processing.matcap.estimate.signatures import signatures

F64 = NDArray[np.float64]

# What is fainter than this share of the picture's range is taken for noise, texture, or the steps of 8 bits.
_LEAST_CONTRAST = 0.08
_LEAST_RANGE = 1e-6
_TEXELS_A_MERIDIAN = 6
_SMOOTHING_TEXELS = (1.5, 3.0, 6.0, 12.0)
_LEAST_NOISES, _NOISE_SAMPLES = 5.0, 31
_MOST_CANDIDATES = 40
# Neighbours that agree on a feature: how many, within which share of its variance (and a pixel), how far apart.
_AGREEING, _AGREEMENT, _APART_MERIDIANS = 4, 0.12, 2.5
_SIDE_PX = 5
_REACH_DEVIATIONS = 2.0
# Where noise keeps all from being trusted, what is in doubt is better than nothing.
_LENIENCIES = (1.0, 3.0)
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
    asked = [_Asked.of_candidates(meridians, clipped, of) for of in kinds]
    for leniency in _LENIENCIES:
        found: list[FoundRegion] = []
        for answers in asked:
            agreed = _agreed(meridians, answers, leniency)
            for one in sorted(agreed, key=lambda feature: feature.variance):
                if not any(_is_part(one, other, meridians.size) for other in found):
                    found.append(one)
        if found:
            return sorted(found, key=lambda one: one.variance)[:most]
    return []


@dataclass(frozen=True)
class _Asked:
    """What the signatures of candidates say, each (P,)."""

    of: Of
    theta: F64
    phi: F64
    variances: F64
    slopes: F64
    misfits: F64

    @classmethod
    def of_candidates(cls, meridians: Meridians, clipped: NDArray[np.bool_], of: Of) -> "_Asked":
        theta, phi = _candidates(meridians, of)
        keep = np.flatnonzero(~_clipped_at(clipped, theta, phi))[:_MOST_CANDIDATES]
        theta, phi = theta[keep], phi[keep]
        answers = signatures(meridians, theta, phi, of)
        settled = settle(answers, "plateau")
        misfits = answers.misfits[np.arange(len(theta)), settled.at]
        return cls(of, theta, phi, settled.variances, settled.slopes, misfits)


def _is_part(one: FoundRegion, other: FoundRegion, size: int) -> bool:
    """Tell whether a feature is another one again, or lies within one of another kind.

    The flank of a light is no step, and a light that settles stands on no ground.
    """
    apart_px = float(np.hypot(one.region.x - other.region.x, one.region.y - other.region.y))
    if one.of == other.of:
        return apart_px < 2 * _SIDE_PX
    return bool(apart_px < _REACH_DEVIATIONS * np.sqrt(other.variance) * size / 2)


def _candidates(meridians: Meridians, of: Of) -> tuple[F64, F64]:
    """Return (θ, φ) of bumps or steps that stand out from noise, the narrowest first."""
    count = max(int(np.pi * meridians.size / 2 / _TEXELS_A_MERIDIAN), 24)
    phi = np.pi * np.arange(count) / count
    profiles = Profiles(meridians, np.zeros(count), phi, of, meridians.rim)
    inside = np.abs(profiles.t) < min(meridians.rim, _NEAR_RIM)
    raw, t = profiles.raw()[:, inside], profiles.t[inside]
    contrast = _LEAST_CONTRAST * float(np.ptp(raw))
    noise = _noise(raw[:, ::SAMPLES_A_TEXEL]).repeat(SAMPLES_A_TEXEL, axis=1)
    rows: list[tuple[float, float, float]] = []
    for texels in _SMOOTHING_TEXELS if contrast > _LEAST_RANGE * meridians.brightest else ():
        smoothing = texels * meridians.texel
        # White noise of 1 a pixel, after a Gaussian, or its derivative.
        left = 1 / np.sqrt(2 * np.sqrt(np.pi) * texels)
        if of == "edges":
            left /= np.sqrt(2) * smoothing
        lines = profiles.smoothed(smoothing)[:, inside]
        for line, angle, value, noisy in zip(lines, phi, raw, left * noise, strict=True):
            peaks, about = signal.find_peaks(line, prominence=_LEAST_RANGE * line.max())
            widths = signal.peak_widths(line, peaks, 0.5)[0] * profiles.spacing / 2.355
            for place, width, prominence in zip(peaks, widths, about["prominences"], strict=True):
                # The light that a step adds is the area under its slope.
                rise = prominence * width * 2.5 if of == "edges" else prominence
                stands_out = rise > contrast and prominence > _LEAST_NOISES * noisy[place]
                if stands_out and (of != "edges" or _is_step(value, int(place), width / profiles.spacing)):
                    rows.append((width, t[place], angle))
    rows.sort()
    table = np.array(rows).reshape(-1, 3)
    return _apart(table, meridians.texel)


def _apart(table: F64, texel: float) -> tuple[F64, F64]:
    """Leave out what was found at a finer scale already, within a few texels on the same meridian."""
    kept: list[F64] = []
    for row in table:
        if not any(row[2] == other[2] and abs(row[1] - other[1]) < 3 * texel for other in kept):
            kept.append(row)
    found = np.array(kept).reshape(-1, 3)
    return found[:, 1], found[:, 2]


def _noise(lines: F64) -> F64:
    """Return the standard deviation of noise at each sample, by second differences, which features hardly have."""
    bends = np.abs(np.diff(lines, 2, axis=1, prepend=lines[:, :1], append=lines[:, -1:]))
    usual = ndimage.median_filter(bends, size=(1, _NOISE_SAMPLES), mode="nearest")
    return np.asarray(usual / (0.6745 * np.sqrt(6)))


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


def _agreed(meridians: Meridians, asked: _Asked, leniency: float) -> list[FoundRegion]:
    of = asked.of
    steepest, worst = most_trusted(of)
    good = np.isfinite(asked.variances) & (asked.slopes < leniency * steepest) & (asked.misfits < leniency * worst)
    theta, phi, variances = asked.theta[good], asked.phi[good], asked.variances[good]
    x, y = np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi)
    found, taken = [], np.zeros(len(theta), np.bool_)
    for first in np.argsort(variances):
        if taken[first]:
            continue
        reach = _APART_MERIDIANS * _TEXELS_A_MERIDIAN * meridians.texel
        near = np.hypot(x - x[first], y - y[first]) < max(reach, np.sqrt(variances[first]))
        apart = leniency * _AGREEMENT * variances[first] + meridians.texel**2
        alike = near & (np.abs(variances - variances[first]) < apart)
        taken |= alike
        members = np.flatnonzero(alike)
        if len(members) >= _AGREEING:
            middle = members[np.argsort(variances[members])[len(members) // 2]]
            region = Region.around(float(theta[middle]), float(phi[middle]), meridians.size, _SIDE_PX)
            found.append(FoundRegion(region, of, float(variances[middle])))
    return found
