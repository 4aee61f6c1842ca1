"""Whether the material looks the same when its tangent turns by 360°/R (the AMC paper, section 5.2).

Something that repeats R times a turn has Fourier harmonics divisible by R only. So the energy in the others, over
noise, is the evidence against R; no slice is interpolated, and R = 3 is as exact as R = 2. It is asked twice:

- over the tangent's angle in the surface's own plane: there a material of symmetry R repeats exactly;
- over k, the angle of the tangent's picture, by which the table is stored. On a tilted surface the two differ, and
  except for R = 1 and 2 a symmetric material repeats only nearly. What lies outside here is what folding averages away.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from processing.amc.model import Invariance

F64 = NDArray[np.float64]
C64 = NDArray[np.complex64]

CANDIDATES = (1, 2, 3, 4)
THRESHOLD = 0.05
ISOTROPIC_VARIATION = 0.03


@dataclass(frozen=True)
class Evidence:
    """How one candidate R fares.

    Attributes
    ----------
    outside_plane : energy in harmonics not divisible by R, noise taken off, as a share of all variation; over the
        tangent's angle in the surface's plane
    outside_k : the same over k: the share that a table folded by R loses
    over_noise : energy outside over k, noise not taken off, in units of the noise in those harmonics; 1 is noise
    rotation_rms : RMS difference between slices and slices turned by 360°/R, in linear light
    """

    repeats: int
    outside_plane: float
    outside_k: float
    over_noise: float
    rotation_rms: float


@dataclass(frozen=True)
class InvarianceReport:
    """What was found, and on what evidence.

    Attributes
    ----------
    found : the largest R that one of the two shares speaks for, or "isotropic" when nothing but noise changes over k
    threshold : largest share of energy outside
    variation : RMS change over k beyond noise, relative to the RMS of the mean slice
    noise : RMS noise of a harmonic in linear light, estimated from the quietest harmonics
    evidence : one entry for each R that was tried
    energies : (M + 1,) mean square of each harmonic over k, in linear light
    """

    found: Invariance
    threshold: float
    variation: float
    noise: float
    evidence: tuple[Evidence, ...]
    energies: F64

    def rotation_difference(self, turns_deg: NDArray[np.floating]) -> F64:
        """RMS difference between the slices and the slices turned (the AMC paper's figure 4, as a curve).

        Parameters
        ----------
        turns_deg : (T,) degrees over k

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


def find_invariance(over_k: C64, over_plane: C64, threshold: float = THRESHOLD) -> InvarianceReport:
    """Test R = 1..4.

    Parameters
    ----------
    over_k : (M + 1, texels, 3) series over k, linear light; leave the rim's texels out
    over_plane : (M + 1, texels, 3) series over the tangent's angle in the surface's plane
    threshold : share of the variation's energy that may lie outside

    Notes
    -----
    The noise of one harmonic is the lower quartile of their energies: a material leaves at least a quarter of them
    empty, either those that its R forbids or the highest ones. With few slices it is an overestimate, and R an
    optimistic one.
    """
    energies, plane = _mean_energies(over_k), _mean_energies(over_plane)
    noise = _noise(energies)
    variation = float(np.sqrt(np.maximum(energies[1:] - noise, 0).sum() / max(float(energies[0]), 1e-30)))
    evidence = tuple(_weigh(energies, plane, repeats) for repeats in CANDIDATES)
    consistent = [entry.repeats for entry in evidence if min(entry.outside_plane, entry.outside_k) <= threshold]
    found: Invariance = "isotropic" if variation <= ISOTROPIC_VARIATION else max(consistent)
    return InvarianceReport(found, threshold, variation, float(np.sqrt(noise)), evidence, energies)


def _mean_energies(harmonics: C64) -> F64:
    """Mean square over texels, channels and angle of each harmonic; (M + 1,)."""
    energies: F64 = np.mean(np.abs(harmonics).astype(np.float64) ** 2, axis=(1, 2))
    energies[1:] /= 2
    return energies


def _noise(energies: F64) -> float:
    return float(np.quantile(energies[1:], 0.25))


def _weigh(over_k: F64, over_plane: F64, repeats: int) -> Evidence:
    orders = np.arange(1, len(over_k))
    outside = orders % repeats != 0
    # |1 − exp(2πi·m/R)|² = 4 sin²(πm/R)
    difference = float(np.sum(over_k[1:] * 4 * np.sin(np.pi * orders / repeats) ** 2))
    return Evidence(
        repeats=repeats,
        outside_plane=_share_outside(over_plane, outside),
        outside_k=_share_outside(over_k, outside),
        over_noise=float(over_k[1:][outside].sum() / max(_noise(over_k) * int(outside.sum()), 1e-30)),
        rotation_rms=float(np.sqrt(difference)),
    )


def _share_outside(energies: F64, outside: NDArray[np.bool_]) -> float:
    over_noise = np.maximum(energies[1:] - _noise(energies), 0)
    return float(over_noise[outside].sum() / max(float(over_noise.sum()), 1e-30))
