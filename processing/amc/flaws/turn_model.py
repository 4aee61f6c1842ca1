"""What a texel's values over the turn have in common, so that some of them tell the others (kriging).

Each texel's light is taken for a periodic random function of the turntable's angle. Its covariance is shared by the
texels of a ring about the axis, for highlights sweep faster over steep normals. A material that repeats R times a turn
has its energy in every R-th harmonic; the covariance then reaches from turn to turn, and a value hidden here is read
there, without R being told.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel
from processing.amc.geometry import texel_plane

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

_RING_EDGES = (0.3, 0.5, 0.7, 0.85)
_PASSES = 6
_MOST_IN_RING = 400
_LEAST_NOISE = 1e-5  # in units of the variance over the turn: what cannot be seen may not be believed
MOST_HIDDEN = 0.75
"""Share of the turn beyond which the rest of it says nothing of a texel."""


@dataclass(frozen=True)
class TurnModel:
    """How values over the turn hang together.

    Attributes
    ----------
    precisions : (rings, N, N) inverse covariances of a texel's values, in linear light to the power of −2
    variances : (rings,) of a value over the turn
    noises : (rings,) of a value's noise
    ring : (S, S) to which ring each texel belongs
    """

    precisions: F64
    variances: F64
    noises: F64
    ring: NDArray[np.intp]

    def misfit(self, light: F32, hidden: Mask, ring: NDArray[np.intp]) -> F32:
        """Tell how much larger the variance of texels (T, N, 3) filled by this model is than it expects; (T,)."""
        squares = np.zeros(len(light))
        for index, precision in enumerate(self.precisions):
            some = light[ring == index].astype(np.float64)
            squares[ring == index] = np.einsum("tnc,nm,tmc->t", some, precision, some, optimize=True)
        return np.asarray(squares / (3 * np.maximum(np.sum(~hidden, axis=1), 1)), np.float32)


def learn(slices: F32, hidden: Mask, angles_rad: F64, valid: Mask) -> TurnModel:
    """Learn the covariances from what is not hidden, by filling and measuring in turns.

    Parameters
    ----------
    slices : (N, S, S, 3) float32, linear light
    hidden : (N, S, S) bool, values not to learn from
    angles_rad : (N,)
    valid : (S, S) bool
    """
    ring = np.digitize(np.hypot(*texel_plane(len(valid))), _RING_EDGES)
    counts = hidden.sum(axis=0)
    everywhere = _learn(*_texels(slices, hidden, _least_hidden(valid, counts)), angles_rad, None)
    learnt = []
    for index in range(len(_RING_EDGES) + 1):
        chosen = _least_hidden(valid & (ring == index), counts)
        learnt.append(_learn(*_texels(slices, hidden, chosen), angles_rad, everywhere) if len(chosen) else everywhere)
    precisions, variances, noises = zip(*(_precision(energies, angles_rad) for energies in learnt), strict=True)
    return TurnModel(np.stack(precisions), np.array(variances), np.array(noises), ring)


def _least_hidden(where: Mask, counts: NDArray[np.intp]) -> NDArray[np.intp]:
    """Choose texels, by their number in the flat table, of which most is known."""
    texels = np.flatnonzero(where)
    return texels[np.argsort(counts.ravel()[texels], kind="stable")[:_MOST_IN_RING]]


def _texels(slices: F32, hidden: Mask, chosen: NDArray[np.intp]) -> tuple[F32, Mask]:
    """Take out texels (T, N, 3), and what is hidden of them (T, N)."""
    count = len(slices)
    light = slices.reshape(count, -1, 3)[:, chosen].swapaxes(0, 1)
    return np.ascontiguousarray(light), np.ascontiguousarray(hidden.reshape(count, -1)[:, chosen].T)


def _learn(light: F32, hidden: Mask, angles_rad: F64, energies: F64 | None) -> F64:
    """Return energies (M + 1,) of the harmonics over the turn in texels (T, N, 3)."""
    if energies is None:
        energies = _energies_of_the_seen(light, hidden, angles_rad)
    for _ in range(_PASSES):
        precision, _variance, _noise = _precision(energies, angles_rad)
        filled = light.copy()
        fill_texels(filled, hidden, precision[None], np.zeros(len(light), np.intp), len(angles_rad))
        energies = _energies(filled, angles_rad)
    return energies


def _energies_of_the_seen(light: F32, hidden: Mask, angles_rad: F64) -> F64:
    """Measure them from pairs of values that are both seen, with the angles rounded to even ones.

    The mean product of two values a lag apart is the covariance at that lag, and its cosine transform the energies.
    """
    count = len(angles_rad)
    seen = ~hidden.T[..., None]
    slots = np.rint(angles_rad / (2 * np.pi) * count).astype(int) % count
    sums, pairs = np.zeros((count, len(light), 3), np.float32), np.zeros(seen.shape, np.float32)
    np.add.at(sums, slots, light.swapaxes(0, 1) * seen)
    np.add.at(pairs, slots, seen)
    products, numbers = (
        np.fft.irfft(np.mean(np.abs(np.fft.rfft(part, axis=0)) ** 2, axis=(1, 2)), count) for part in (sums, pairs)
    )
    energies: F64 = np.fft.rfft(products / np.maximum(numbers, 1e-3)).real[: (count - 1) // 2 + 1] / count
    energies[1:] *= 2
    # The ratio of two estimates may fall below zero; by how much, tells how good it is.
    return np.asarray(np.maximum(energies, np.quantile(np.abs(energies[1:]), 0.5)))


def _energies(light: F32, angles_rad: F64) -> F64:
    """Measure the mean variance that each harmonic over the turn brings to texels (T, N, 3); (M + 1,)."""
    count = len(angles_rad)
    highest = (count - 1) // 2
    orders = np.arange(1, highest + 1) * angles_rad[:, None]
    design = np.hstack([np.ones((count, 1)), np.cos(orders), np.sin(orders)])
    # A breath of ridge: uneven angles can leave the highest harmonics nearly untold.
    solver = np.linalg.solve(design.T @ design + 1e-3 * count * np.eye(design.shape[1]), design.T)
    series = solver.astype(np.float32) @ light.swapaxes(0, 1).reshape(count, -1)
    squares = np.mean(series.astype(np.float64) ** 2, axis=1)
    energies: F64 = squares[: highest + 1].copy()
    energies[1:] = (energies[1:] + squares[highest + 1 :]) / 2
    return energies


def _precision(energies: F64, angles_rad: F64) -> tuple[F64, float, float]:
    """Give inverse covariance (N, N) of a texel's values, their variance over the turn, and their noise's.

    The quietest quarter of the harmonics tells the noise, which all of them carry alike.
    """
    share = float(np.quantile(energies[1:], 0.25))
    signal = np.maximum(energies - share, 0)
    variance = max(float(signal[1:].sum()), 1e-12)
    noise = share * len(angles_rad) / 2 + _LEAST_NOISE * variance
    lags = angles_rad[:, None] - angles_rad
    covariance = signal[0] + sum(
        energy * np.cos(order * lags) for order, energy in enumerate(signal[1:], 1) if energy > 0
    )
    return np.linalg.inv(covariance + noise * np.eye(len(lags))), variance, noise


@kernel
def fill_texels(light: F32, hidden: Mask, precisions: F64, ring: NDArray[np.intp], most_hidden: int) -> F32:
    """Replace hidden values by their conditional means, in place.

    With Q the inverse covariance, hidden values h given the seen ones o have mean −Q_hh⁻¹ Q_ho x_o and variance Q_hh⁻¹.

    Parameters
    ----------
    light : (T, N, 3) float32, overwritten where hidden
    hidden : (T, N) bool
    precisions : (rings, N, N)
    ring : (T,) which of them is each texel's
    most_hidden : values of a texel beyond which it stays as it is

    Returns
    -------
    variances : (T, N) float32 of what was replaced; infinite where it stayed, 0 where nothing was hidden
    """
    texels, count, channels = light.shape
    variances = np.zeros((texels, count), np.float32)
    pull = np.zeros((count, channels))
    for texel in range(texels):
        places = np.flatnonzero(hidden[texel])
        if not len(places):
            continue
        if len(places) > most_hidden:
            for place in places:
                variances[texel, place] = np.inf
            continue
        precision = precisions[ring[texel]]
        inside = np.zeros((len(places), len(places)))
        for row in range(len(places)):
            for channel in range(channels):
                pull[row, channel] = 0.0
            for other in range(count):
                if not hidden[texel, other]:
                    for channel in range(channels):
                        pull[row, channel] -= precision[places[row], other] * light[texel, other, channel]
            for column in range(len(places)):
                inside[row, column] = precision[places[row], places[column]]
        inverse = np.linalg.inv(inside)
        means = inverse @ pull[: len(places)]
        for row in range(len(places)):
            variances[texel, places[row]] = inverse[row, row]
            for channel in range(channels):
                light[texel, places[row], channel] = means[row, channel]
    return variances
