"""What a texel's colour does while the tangent turns: a Fourier series over the tangent angle τ.

colour(τ) = Re Σ_m c_m exp(i·m·τ), m = 0..M. Slices shot at any angles are fitted by least squares; even ones give the
discrete Fourier transform. All that moves, folds or counts slices anew is a matrix made of such series.
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
    if _largest_noise_gain(angles_rad, most) <= _LARGEST_NOISE_GAIN:
        return most
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
    solver = fitting(angles_rad, highest).astype(np.float32)
    parts = (solver @ slices.reshape(len(slices), -1)).reshape(2 * highest + 1, *slices.shape[1:])
    harmonics = parts[: highest + 1].astype(np.complex64)
    harmonics[1:] -= 1j * parts[highest + 1 :]
    return harmonics


def fitting(angles_rad: F64, highest: int) -> F64:
    """Return the matrix (2M + 1, N) that fits the series to slices at measured angles by least squares."""
    design = _design(angles_rad, highest)
    return np.asarray(np.linalg.solve(design.T @ design, design.T))


def reading(fit: F64, wanted_rad: F64) -> F32:
    """Return the matrix (J, N) that fits a series and reads it at wanted angles."""
    return (_design(wanted_rad, len(fit) // 2) @ fit).astype(np.float32)


def folding(count: int, depth: int, repeats: int) -> F32:
    """Return the matrix (D, count) that takes a whole turn of even slices to D over one period 360°/R.

    Slice j stands at 360·j/(R·D) degrees. Harmonics not divisible by R are left out, which is the mean over the R
    turned copies (the AMC paper, section 5.2); so are those that D slices cannot hold.
    """
    highest = min(repeats * ((depth - 1) // 2), (count - 1) // 2)
    orders = np.arange(repeats, highest + 1, repeats)
    waves = _waves(2 * np.pi * np.arange(depth) / (repeats * depth), 2 * np.pi * np.arange(count) / count, orders)
    matrix: F32 = ((1 + 2 * waves) / count).astype(np.float32)
    return matrix


def unfolding(angles_rad: F64, depth: int, repeats: int) -> F32:
    """Return the matrix (J, D) that reads D stored slices of one period at any angles."""
    orders = repeats * np.arange(1, (depth - 1) // 2 + 1)
    waves = _waves(angles_rad, 2 * np.pi * np.arange(depth) / (repeats * depth), orders)
    matrix: F32 = ((1 + 2 * waves) / depth).astype(np.float32)
    return matrix


def _waves(to_rad: F64, from_rad: F64, orders: NDArray[np.integer]) -> F64:
    """Sum cos m(a − b) over the orders m, for every a (rows) and b (columns)."""
    after, before = np.outer(to_rad, orders), np.outer(from_rad, orders)
    waves: F64 = np.cos(after) @ np.cos(before).T + np.sin(after) @ np.sin(before).T
    return waves


def _design(angles_rad: F64, highest: int) -> F64:
    orders = np.arange(1, highest + 1) * angles_rad[:, None]
    return np.hstack([np.ones((len(angles_rad), 1)), np.cos(orders), np.sin(orders)])


def _noise_gain(angles_rad: F64, highest: int) -> float:
    """By how much least squares raises noise at worst, against even angles."""
    design = _design(angles_rad, highest)
    design[:, 1:] *= np.sqrt(2)
    smallest = np.linalg.eigvalsh(design.T @ design)[0]  # of the squared singular values
    return float(np.sqrt(len(angles_rad) / max(float(smallest), 1e-12)))


def _largest_noise_gain(angles_rad: F64, highest: int) -> float:
    """Bound `_noise_gain` from above; close where the angles are nearly even, and at hardly any cost.

    Over the functions exp(i·m·τ) the matrix of the least squares is N times a Toeplitz matrix of ones on the diagonal
    and means of exp(i·k·τ) beside it. None of its eigenvalues is further from 1 than the norm of what stands beside.
    """
    orders = np.arange(1, 2 * highest + 1)
    means = np.abs(np.exp(1j * np.outer(orders, angles_rad)).mean(axis=1))
    beside = float(np.sqrt(2 * np.sum((2 * highest + 1 - orders) * means**2)))
    return 1 / np.sqrt(1 - beside) if beside < 1 else np.inf


def _widest_gap_deg(distinct_rad: F64) -> tuple[float, float]:
    after = np.append(distinct_rad[1:], distinct_rad[0] + 2 * np.pi)
    place = int(np.argmax(after - distinct_rad))
    return float(np.degrees(distinct_rad[place])), float(np.degrees(after[place]))
