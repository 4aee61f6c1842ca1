"""What a texel's colour does while the tangent turns: a Fourier series over the tangent angle τ.

colour(τ) = Re Σ_m c_m exp(i·m·τ), m = 0..M. Slices shot at any angles are fitted by least squares; even ones give the
discrete Fourier transform. The series is the one place where slices are moved, turned, folded and counted anew.
"""

from bisect import bisect_left

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
C64 = NDArray[np.complex64]

FEWEST_SLICES = 8
_LARGEST_NOISE_GAIN = 2.0


def check_angles(angles_rad: F64, source: str) -> int:
    """Return M, the highest harmonic that slices at these angles can tell.

    It is (N − 1)/2 for even angles. Uneven ones carry less: M is the most for which least squares raises no noise by
    more than a factor 2.

    Parameters
    ----------
    angles_rad : (N,) tangent angles of the slices
    source : named in errors

    Raises
    ------
    InputError
        Fewer than eight slices, or a gap that leaves less than half of what even angles would carry.
    """
    distinct: F64 = np.unique(np.round(np.mod(angles_rad, 2 * np.pi), 6))
    if len(distinct) < FEWEST_SLICES:
        raise InputError(
            f"{source}: has {len(distinct)} turntable angles, an AMC wants at least {FEWEST_SLICES}; capture more"
        )
    most = (len(distinct) - 1) // 2
    # The gain rises with m, so that the calm harmonics come first.
    highest = bisect_left(range(1, most + 1), x=True, key=lambda m: _noise_gain(angles_rad, m) > _LARGEST_NOISE_GAIN)
    if highest <= most // 2:
        low_deg, high_deg = _widest_gap_deg(distinct)
        raise InputError(
            f"{source}: no frame between {low_deg:.1f} and {high_deg:.1f} deg, where {len(distinct)} frames should "
            f"stand {360 / len(distinct):.1f} deg apart; shoot the missing angles"
        )
    return highest


def fit_harmonics(slices: F32, angles_rad: F64, highest: int) -> C64:
    """Fit the series to slices at measured angles.

    Parameters
    ----------
    slices : (N, ...) float32
    angles_rad : (N,)
    highest : M, as `check_angles` gives it

    Returns
    -------
    harmonics : (M + 1, ...) complex64
    """
    solver = np.linalg.pinv(_design(angles_rad, highest)).astype(np.float32)
    parts = (solver @ slices.reshape(len(slices), -1)).reshape(2 * highest + 1, *slices.shape[1:])
    harmonics = parts[: highest + 1].astype(np.complex64)
    harmonics[1:] -= 1j * parts[highest + 1 :]
    return harmonics


def even_slices(harmonics: C64, depth: int, repeats: int) -> F32:
    """Give D even slices over one period 360°/R: slice j at 360·j/(R·D) degrees.

    Harmonics not divisible by R are left out, which is the mean over the R turned copies (the AMC paper, section 5.2);
    so are those that D slices cannot hold.

    Returns
    -------
    slices : (D, ...) float32; below zero where the series undershoots beside a highlight
    """
    kept = harmonics[::repeats][: (depth - 1) // 2 + 1]
    spectrum = kept * np.complex64(depth / 2)
    spectrum[0] *= 2
    slices: F32 = np.fft.irfft(spectrum, n=depth, axis=0).astype(np.float32)
    return slices


def warp_harmonics(harmonics: C64, normal_z: F64, table_normal_z: F64, azimuth_rad: F64) -> C64:
    """Follow the tangent's turn from normal n to table normal n′, texel by texel.

    n, n′ and z lie in one plane of azimuth φ, so that the turn is about the horizontal direction across it. A tangent
    seen at τ then shows at τ′, with tan(τ − φ)·n_z = tan(τ′ − φ)·n′_z. The series over τ is read where τ′ is even, and
    analysed again; with n = n′ it comes back as it was.

    Parameters
    ----------
    harmonics : (M + 1, S, S, 3) over the picture's tangent angle τ
    normal_z, table_normal_z, azimuth_rad : (S, S) of each texel

    Returns
    -------
    harmonics : (M + 1, S, S, 3) over the table's tangent angle τ′
    """
    highest = len(harmonics) - 1
    count = 2 * (2 * highest + 1)
    turned = 2 * np.pi * np.arange(count) / count
    warped = np.zeros_like(harmonics)
    for row in range(harmonics.shape[1]):
        relative = turned - azimuth_rad[row, :, None]
        cosine, sine = np.cos(relative) * normal_z[row, :, None], np.sin(relative) * table_normal_z[row, :, None]
        seen_rad = np.arctan2(sine, cosine) + azimuth_rad[row, :, None]
        colours = _evaluate(harmonics[:, row], seen_rad)
        spectrum = np.fft.rfft(colours, axis=1)[:, : highest + 1] * (2 / count)
        spectrum[:, 0] /= 2
        warped[:, row] = spectrum.swapaxes(0, 1)
    return warped


def _evaluate(harmonics: C64, angles_rad: F64) -> F32:
    """Read series (M + 1, S, 3) at angles (S, J) each; (S, J, 3)."""
    turns = np.ones((*angles_rad.shape, len(harmonics)), np.complex64)
    turns[..., 1:] = np.exp(1j * angles_rad)[..., None]
    np.cumprod(turns, axis=-1, out=turns)
    values: F32 = (turns @ harmonics.swapaxes(0, 1)).real
    return values


def _design(angles_rad: F64, highest: int) -> F64:
    orders = np.arange(1, highest + 1) * angles_rad[:, None]
    return np.hstack([np.ones((len(angles_rad), 1)), np.cos(orders), np.sin(orders)])


def _noise_gain(angles_rad: F64, highest: int) -> float:
    """By how much least squares raises noise at worst, against even angles."""
    design = _design(angles_rad, highest)
    design[:, 1:] *= np.sqrt(2)
    smallest = np.linalg.svd(design, compute_uv=False)[-1]
    return float(np.sqrt(len(angles_rad)) / max(float(smallest), 1e-12))


def _widest_gap_deg(distinct_rad: F64) -> tuple[float, float]:
    after = np.append(distinct_rad[1:], distinct_rad[0] + 2 * np.pi)
    place = int(np.argmax(after - distinct_rad))
    return float(np.degrees(distinct_rad[place])), float(np.degrees(after[place]))
