"""Variance over the window's size at pixels of a MatCap: the signatures of the MatCap paper, section 3.3."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from processing.matcap.estimate.gaussian_in_window import gaussian_behind
from processing.matcap.estimate.meridians import Meridians
from processing.matcap.estimate.profiles import Of, Profiles
from processing.matcap.estimate.valleys import between_valleys

F64 = NDArray[np.float64]

SMALLEST_TEXELS, STEPS = 4, 80
# Edges are smoothed by this share of the window, which takes the steps of 8 bits away; its variance comes off again.
_SMOOTHING_SHARE, _LEAST_SMOOTHING_TEXELS = 1 / 8, 0.7
_CALMING_SHARE = 1 / 12
# What is smoothed by nearly its own width is not measured any more.
_MOST_SMOOTHING = 0.4
_SHARP_TEXELS = 3.0
_CELLS = 256
# Of a window, the share at either end that shows the ground a light stands on.
_FOOT_SHARE = 0.08
# Smoothing fills valleys, and empties them where a slope changes its sign.
_SHY_OF_VALLEYS = 2.0


@dataclass(frozen=True)
class Signatures:
    """What E windows around P pixels say.

    Attributes
    ----------
    of : "values" of R where a light is a point or line; "bumps", R above its ground, where it stands on a wide one;
        "edges", |R′| along θ, where it has an edge
    windows : (E,) half widths ε in radians, geometric
    variances : (P, E) rad², of the profile without the window; NaN where degenerate (the paper's figure 4d)
    misfits : (P, E) which share of the windowed profile does not lie under the windowed Gaussian, 0..1
    widths : (P, E) half of what the window covers, radians: less than ε at the rim, and where another feature begins
    """

    of: Of
    windows: F64
    variances: F64
    misfits: F64
    widths: F64


def window_sizes(meridians: Meridians) -> F64:
    """Return the half widths ε, from a few texels to π/2."""
    return np.geomspace(SMALLEST_TEXELS * meridians.texel, np.pi / 2, STEPS)


def signatures(meridians: Meridians, theta: F64, phi: F64, of: Of) -> Signatures:
    """Ask windows of all sizes around pixels at (θ, φ), each (P,) in radians, |θ| within the rim.

    R is sampled along θ on both sides of the pixel, through the pole. The window, a Gaussian of standard deviation ε/3,
    ends at ±ε, at the rim, and in the valleys beyond which another light begins; between samples if need be, so that
    variance is smooth in ε.
    """
    windows = window_sizes(meridians)
    profiles = Profiles(meridians, theta, phi, of, windows[-1])
    found = [_ask(profiles, window, of, meridians.texel) for window in windows]
    variances, misfits, widths = (np.stack(part, axis=1) for part in zip(*found, strict=True))
    return Signatures(of, windows, variances, misfits, widths)


def signatures_by_equation_6(meridians: Meridians, theta: F64, phi: F64, of: Of) -> Signatures:
    """Ask as the paper has it, bar the sign of equation 6: windows that are full of lights, as if they had no ends."""
    windows = window_sizes(meridians)
    profiles = Profiles(meridians, theta, phi, of, windows[-1])
    profile = profiles.smoothed(_LEAST_SMOOTHING_TEXELS * meridians.texel) if of == "edges" else profiles.raw()
    variances = np.full((len(theta), len(windows)), np.nan)
    cells = (2 * np.arange(_CELLS) + 1) / _CELLS - 1
    for index, window in enumerate(windows):
        # What equation 6 takes for granted is amplified 36-fold in narrow windows: all have as many samples.
        t = window * cells
        seen = (t > profiles.inner[:, None]) & (t < profiles.outer[:, None])
        _, spread = _moments(profiles.between_samples(profile, t) * np.exp(-4.5 * cells**2) * seen, t)
        with np.errstate(divide="ignore", invalid="ignore"):
            behind = spread * (window / 3) ** 2 / ((window / 3) ** 2 - spread)
        variances[:, index] = np.where(behind > 0, behind, np.nan)
    return Signatures(of, windows, variances, np.full(variances.shape, np.nan), np.tile(windows, (len(theta), 1)))


def _ask(profiles: Profiles, window: float, of: Of, texel: float) -> tuple[F64, F64, F64]:
    """Return variances, misfits and widths (P,) of one window."""
    if of != "edges":
        return _ask_smoothed(profiles, window, 0.0, above_ground=of == "bumps")
    least, much = _LEAST_SMOOTHING_TEXELS * texel, _SMOOTHING_SHARE * window
    sharp = _ask_smoothed(profiles, window, least)
    if much <= least:
        return sharp
    blunt = _ask_smoothed(profiles, window, much)
    blunt[0][~(much**2 < _MOST_SMOOTHING * blunt[0])] = np.nan
    # Steps of 8 bits are nothing beside the slope of a sharp edge, which more smoothing would drown.
    is_sharp = sharp[0] < (_SHARP_TEXELS * texel) ** 2
    variances, misfits, widths = (np.where(is_sharp, one, other) for one, other in zip(sharp, blunt, strict=True))
    return variances, misfits, widths


def _ask_smoothed(
    profiles: Profiles, window: float, smoothing: float, *, above_ground: bool = False
) -> tuple[F64, F64, F64]:
    near = profiles.near(window)
    t = profiles.t[near]
    # Brightness need not be smoothed to be averaged, but noise has valleys.
    calm = profiles.smoothed(smoothing or _CALMING_SHARE * window)[:, near]
    profile = calm if smoothing else profiles.raw()[:, near]
    gaussian = np.exp(-4.5 * (t / window) ** 2)
    first, last = np.maximum(profiles.inner, -window), np.minimum(profiles.outer, window)
    seen = calm * gaussian * profiles.share_between(first[:, None], last[:, None], near)
    left, right = between_valleys(calm, np.argmax(seen, axis=1))
    shy = _SHY_OF_VALLEYS * smoothing
    begin = np.maximum(np.where(left > 0, t[left] + shy, -np.inf), first)
    end = np.minimum(np.where(right < len(t) - 1, t[right] - shy, np.inf), last)
    # What a window sees most of may be another feature than its pixel's, or the last bit of darkness.
    own = (begin <= 0) & (end >= 0) & ~profiles.faint(seen)
    if above_ground:
        # At the rim the ground cannot be seen.
        own &= (begin > profiles.inner) & (end < profiles.outer)
    begin, end = np.where(own, begin, 0), np.where(own, end, 0)
    covered = profiles.share_between(begin[:, None], end[:, None], near)
    if above_ground:
        ground = _ground(profile, t, begin[:, None], end[:, None])
        profile = np.maximum(profile - ground, 0)
    weights = gaussian * covered
    u = np.asarray(t / window, np.float64)
    mean, spread = _moments(profile * weights, u)
    centre, behind = gaussian_behind(mean, spread, begin / window, end / window)
    with np.errstate(invalid="ignore", divide="ignore"):
        fitted = np.exp(-((u - centre[:, None]) ** 2) / (2 * behind[:, None])) * weights
        misfit = np.abs(_normalised(profile * weights) - _normalised(fitted)).sum(axis=1) / 2
        variance = behind * window**2 - smoothing**2
    return np.where(own & (variance > 0), variance, np.nan), misfit, (end - begin) / 2


def _ground(profile: F64, t: F64, begin: NDArray[np.floating], end: NDArray[np.floating]) -> F64:
    """Return the line (P, T) that runs under a profile from the one end of the window to the other."""
    foot = _FOOT_SHARE * (end - begin)
    first, last = (t >= begin) & (t <= begin + foot), (t >= end - foot) & (t <= end)
    with np.errstate(invalid="ignore", divide="ignore"):
        left, right = ((profile * part).sum(axis=1) / part.sum(axis=1) for part in (first, last))
        rise = (right - left)[:, None] / (end - begin - foot)
        line: F64 = left[:, None] + rise * (t - begin - foot / 2)
    return line


def _normalised(weighed: F64) -> F64:
    shares: F64 = weighed / weighed.sum(axis=1, keepdims=True)
    return shares


def _moments(weighed: F64, t: F64) -> tuple[F64, F64]:
    """Return mean and variance (P,) of profiles; NaN of black ones."""
    with np.errstate(invalid="ignore", divide="ignore"):
        share = _normalised(weighed)
    mean = share @ t
    return mean, share @ t**2 - mean**2
