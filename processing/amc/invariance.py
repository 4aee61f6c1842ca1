"""Whether the material looks the same when its tangent turns by 360°/R (the AMC paper, section 5.2).

Something that repeats R times a turn has Fourier harmonics divisible by R only. So the energy in the others, over
noise, is the evidence against R; no slice is interpolated, and R = 3 is as exact as R = 2. It is asked twice:

- over the tangent's angle in the surface: there a material of symmetry R repeats exactly;
- over the angle of the tangent's picture. On a tilted surface the two differ, and except for R = 1 and 2 a symmetric
  material repeats only nearly. What lies outside here is what folding a table over that angle averages away.

A verdict needs change over the turn that stands out from the noise. Where it does not, and is not negligible either,
the verdict is that one cannot tell.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from processing.amc.model import Invariance

F64 = NDArray[np.float64]
C64 = NDArray[np.complex64]

Verdict = Invariance | Literal["cannot tell"]

MOST_REPEATS = 4
THRESHOLD = 0.05
LEAST_OVER_NOISE = 2.5
"""Energy of the change in units of the noise's, below which nothing is said: 3, less what its estimate may be off."""
NEGLIGIBLE = 0.005
"""RMS change relative to the mean light that is called none: less than half a code of eight bits."""
MOUNTING = 0.01
"""RMS change relative to the mean light that a sample a little off its axis makes by itself, once a turn."""
UNSEEN_OVER_NOISE, UNSEEN = 0.05, 0.05
"""Energy in units of the noise's that the noise's own estimate may be off, and the RMS change relative to the mean
light up to which a change so deep in the noise is called none."""
_RESAMPLINGS = 200


@dataclass(frozen=True)
class Evidence:
    """How one candidate R fares.

    Attributes
    ----------
    outside_surface : energy in harmonics not divisible by R, noise taken off, as a share of all change; over the
        tangent's angle in the surface
    outside_picture : the same over the angle of its picture: what a table folded over that angle loses
    over_noise : energy outside over the picture's angle, noise not taken off, in units of the noise in those
        harmonics; 1 is noise
    rotation_rms : RMS difference between slices and slices turned by 360°/R, in linear light
    """

    repeats: int
    outside_surface: float
    outside_picture: float
    over_noise: float
    rotation_rms: float

    @property
    def outside(self) -> float:
        """The smaller share, which decides."""
        return min(self.outside_surface, self.outside_picture)


@dataclass(frozen=True)
class InvarianceReport:
    """What was found, and on what evidence.

    Attributes
    ----------
    found : the largest R that one of the two shares speaks for, "isotropic" when nothing changes, or "cannot tell"
    confidence : share of resamplings of the sphere's regions that give the same verdict (bootstrap)
    threshold : largest share of energy outside
    variation : RMS change over the turn beyond noise, relative to the RMS of the mean slice
    over_noise : energy of the change in units of the noise's
    noise : RMS noise of a texel in linear light
    evidence : one entry for each R that was tried
    energies : (M + 1,) mean square of each harmonic over the picture's angle, in linear light
    """

    found: Verdict
    confidence: float
    threshold: float
    variation: float
    over_noise: float
    noise: float
    evidence: tuple[Evidence, ...]
    energies: F64

    def rotation_difference(self, turns_deg: NDArray[np.floating]) -> F64:
        """RMS difference between the slices and the slices turned (the AMC paper's figure 4, as a curve).

        Parameters
        ----------
        turns_deg : (T,) degrees over the picture's angle

        Returns
        -------
        differences : (T,) in linear light
        """
        orders = np.arange(1, len(self.energies))
        differences: F64 = np.sqrt(4 * np.sin(np.radians(np.outer(turns_deg, orders)) / 2) ** 2 @ self.energies[1:])
        return differences

    def of(self, repeats: int) -> Evidence | None:
        """Return the evidence on one R, if it was tried."""
        return next((entry for entry in self.evidence if entry.repeats == repeats), None)


@dataclass(frozen=True)
class _Energies:
    """Mean squares of the harmonics, of the whole sphere or of several draws of its regions.

    Attributes
    ----------
    picture : (B, M + 1) over the angle of the tangent's picture
    surface : (B, M + 1) over the tangent's angle in the surface
    measured_noise : energy of the noise in one harmonic, if it was measured
    """

    picture: F64
    surface: F64
    measured_noise: float | None

    def drawn(self, shares: F64) -> "_Energies":
        """Mix regions, shares (B, P)."""
        return _Energies(shares @ self.picture, shares @ self.surface, self.measured_noise)

    @cached_property
    def noise(self) -> F64:
        """Energy of the noise in a harmonic (B,); both estimates can only be too high."""
        quiet = _quiet(self.picture)
        return quiet if self.measured_noise is None else np.asarray(np.minimum(quiet, self.measured_noise))

    @cached_property
    def change(self) -> F64:
        """Energy of the change without noise (B,)."""
        return np.asarray(np.maximum((self.picture[:, 1:] - self.noise[:, None]).sum(axis=1), 0.0))

    @property
    def variation(self) -> F64:
        return np.asarray(np.sqrt(self.change / np.maximum(self.picture[:, 0], 1e-30)))

    @property
    def over_noise(self) -> F64:
        return np.asarray(self.change / np.maximum(self.noise * (self.picture.shape[1] - 1), 1e-30))

    @cached_property
    def picture_over_noise(self) -> F64:
        """The harmonics from the first on, noise taken off (B, M)."""
        return _over_noise(self.picture)

    @cached_property
    def surface_over_noise(self) -> F64:
        return _over_noise(self.surface)

    def outside(self, repeats: int) -> F64:
        """Return the smaller of the two shares that contradict R (B,)."""
        over = _share_outside(self.surface_over_noise, repeats), _share_outside(self.picture_over_noise, repeats)
        return np.asarray(np.minimum(*over))


def find_invariance(
    over_picture: C64,
    over_surface: C64,
    threshold: float = THRESHOLD,
    *,
    most_repeats: int = MOST_REPEATS,
    noise: float | None = None,
    regions: NDArray[np.integer] | None = None,
) -> InvarianceReport:
    """Test R = 1, 2, …, 4 or more.

    Parameters
    ----------
    over_picture : (M + 1, texels, 3) series over the angle of the tangent's picture, linear light; leave the rim out
    over_surface : (M + 1, texels, 3) series over the tangent's angle in the surface
    threshold : share of the change's energy that may lie outside
    most_repeats : largest R that is tried
    noise : RMS noise of a slice's texel, as `noise_variance` has it, for N = 2M + 1 slices; told from the harmonics
        alone when None
    regions : (texels,) which region of the sphere each texel belongs to; for the confidence, which is 1 without them

    Notes
    -----
    Without measured noise, that of one harmonic is the lower quartile of their energies: a material leaves at least a
    quarter of them empty, either those that its R forbids or the highest ones.
    """
    slices = 2 * len(over_picture) - 1
    measured = None if noise is None else 2 * noise**2 / slices
    parts = _Energies(_mean_squares(over_picture, regions), _mean_squares(over_surface, regions), measured)
    shares = _region_shares(regions)
    whole = parts.drawn(shares[None])
    largest = max(1, min(most_repeats, len(over_picture) - 1))
    found = _verdicts(whole, largest, threshold, most_repeats)[0]
    votes = _verdicts(parts.drawn(_resampled(shares)), largest, threshold, most_repeats)
    return InvarianceReport(
        found=found,
        confidence=sum(vote == found for vote in votes) / len(votes),
        threshold=threshold,
        variation=float(whole.variation[0]),
        over_noise=float(whole.over_noise[0]),
        noise=float(np.sqrt(whole.noise[0] * slices / 2)),
        evidence=tuple(_evidence(whole, repeats) for repeats in range(1, largest + 1)),
        energies=whole.picture[0],
    )


def _verdicts(energies: _Energies, largest: int, threshold: float, most_repeats: int) -> list[Verdict]:
    told, variation = energies.over_noise >= LEAST_OVER_NOISE, energies.variation
    repeats = np.ones(len(told), np.int64)
    for candidate in range(2, largest + 1):
        repeats[energies.outside(candidate) <= threshold] = candidate
    still = (variation <= NEGLIGIBLE) | ((variation <= MOUNTING) & ~(told & (repeats > 1)))
    still |= (energies.over_noise <= UNSEEN_OVER_NOISE) & (variation <= UNSEEN)
    # Slices that cannot hold a harmonic of R do not show whether there is any.
    nothing: Verdict = "isotropic" if largest >= most_repeats else "cannot tell"
    return [
        nothing if none else int(found) if sure else "cannot tell"
        for none, found, sure in zip(still, repeats, told, strict=True)
    ]


def _mean_squares(harmonics: C64, regions: NDArray[np.integer] | None) -> F64:
    """Mean square over texels, channels and angle of each harmonic, a region a row; (P, M + 1)."""
    energies: F64 = np.mean(np.abs(harmonics).astype(np.float64) ** 2, axis=2)
    energies[1:] /= 2
    if regions is None:
        return np.asarray(energies.mean(axis=1)[None])
    return np.stack([energies[:, regions == region].mean(axis=1) for region in np.unique(regions)])


def _region_shares(regions: NDArray[np.integer] | None) -> F64:
    if regions is None:
        return np.ones(1)
    counts = np.unique(regions, return_counts=True)[1]
    shares: F64 = counts / counts.sum()
    return shares


def _resampled(shares: F64) -> F64:
    """Draw as many regions as there are, with replacement, again and again; shares (_RESAMPLINGS, P)."""
    even = np.full(len(shares), 1 / len(shares))
    drawn: F64 = np.random.default_rng(0).multinomial(len(shares), even, size=_RESAMPLINGS) * shares
    scaled: F64 = drawn / drawn.sum(axis=1, keepdims=True)
    return scaled


def _quiet(energies: F64) -> F64:
    return np.asarray(np.quantile(energies[:, 1:], 0.25, axis=1))


def _over_noise(energies: F64) -> F64:
    return np.asarray(np.maximum(energies[:, 1:] - _quiet(energies)[:, None], 0))


def _share_outside(over_noise: F64, repeats: int) -> F64:
    outside = np.arange(1, over_noise.shape[1] + 1) % repeats != 0
    return np.asarray(over_noise[:, outside].sum(axis=1) / np.maximum(over_noise.sum(axis=1), 1e-30))


def _evidence(whole: _Energies, repeats: int) -> Evidence:
    energies = whole.picture[0]
    orders = np.arange(1, len(energies))
    outside = orders % repeats != 0
    # |1 − exp(2πi·m/R)|² = 4 sin²(πm/R)
    difference = float(np.sum(energies[1:] * 4 * np.sin(np.pi * orders / repeats) ** 2))
    noise = float(whole.noise[0]) * int(outside.sum())
    return Evidence(
        repeats=repeats,
        outside_surface=float(_share_outside(whole.surface_over_noise, repeats)[0]),
        outside_picture=float(_share_outside(whole.picture_over_noise, repeats)[0]),
        over_noise=float(energies[1:][outside].sum() / max(noise, 1e-30)),
        rotation_rms=float(np.sqrt(difference)),
    )
