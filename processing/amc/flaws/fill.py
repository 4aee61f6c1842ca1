"""Marked texels get the light they would have shown, from the rest of the turn and from their neighbours on the sphere.

The AMC paper expands neighbours over the marks (section 5.1). A mark that turns with the sample hides a texel in a few
slices only, and the other slices say more than the neighbours do: they are of the same normal. So each texel's light is
taken for a periodic random function of the turntable's angle, whose covariance all texels share, and the marked values
for its conditional mean (kriging). A material that repeats R times a turn has its energy in every R-th harmonic; the
covariance then reaches from turn to turn, and a value hidden here is read there, without R being told. Where most of
the turn is hidden (beside the turntable's axis, on a dead pixel) the neighbours in the same slice speak.
"""

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from scipy.spatial import cKDTree

from processing.amc.geometry import texel_plane

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

_PASSES = 3  # the second knows the spectrum at the measured angles
_SAMPLED_TEXELS = 4096
_BATCH_VALUES = 2**22
# What neighbours are worth, as a share of a texel's variance over the turn; it grows with the square of the distance.
_NEIGHBOURS_VARIANCE, _NEIGHBOURS_REACH_PX = 0.1, 2.0
_CERTAIN = 0.03  # more so than any neighbour makes it
_MOST_HIDDEN = 0.75
_NEIGHBOURS = 48
_LEAST_NOISE = 1e-5


def fill(slices: F32, marked: Mask, angles_rad: F64, valid: Mask) -> F32:
    """Replace marked values by estimates.

    Parameters
    ----------
    slices : (N, S, S, 3) float32, linear light
    marked : (N, S, S) bool, values that are not the material's
    angles_rad : (N,) turntable angle of each slice
    valid : (S, S) bool, the disc that was seen

    Returns
    -------
    filled : (N, S, S, 3) float32; what is not marked comes back bit for bit
    """
    filled = slices.copy()
    hidden = marked & valid
    if not hidden.any():
        return filled
    depths = _depths(hidden | ~valid)
    energies = _energies_of_the_seen(slices, hidden, angles_rad, valid)
    for _ in range(_PASSES):
        variances = _fill_over_turn(filled, hidden, *_precision(energies, angles_rad))
        _fill_over_sphere(filled, variances, depths, valid)
        energies = _energies(filled, angles_rad, valid)
    return filled


def _depths(unknown: Mask) -> F32:
    """Give the distance of every value to the nearest known one in its slice, in texels."""
    depths = np.zeros(unknown.shape, np.float32)
    for slice_depths, holes in zip(depths, unknown, strict=True):
        slice_depths[:] = cv2.distanceTransform(holes.astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    return depths


def _energies_of_the_seen(slices: F32, hidden: Mask, angles_rad: F64, valid: Mask) -> F64:
    """Measure the same from pairs of values that are both seen, with the angles rounded to even ones; (M + 1,).

    The mean product of two values a lag apart is the covariance at that lag, and its cosine transform the energies.
    """
    count = len(slices)
    texels = np.flatnonzero(valid)
    chosen = texels[:: -(-len(texels) // _SAMPLED_TEXELS)]
    seen = ~hidden.reshape(count, -1)[:, chosen, None]
    light = slices.reshape(count, -1, 3)[:, chosen] * seen
    slots = np.rint(angles_rad / (2 * np.pi) * count).astype(int) % count
    sums, pairs = np.zeros(light.shape, np.float32), np.zeros(seen.shape, np.float32)
    np.add.at(sums, slots, light)
    np.add.at(pairs, slots, seen)
    products, numbers = (
        np.fft.irfft(np.mean(np.abs(np.fft.rfft(part, axis=0)) ** 2, axis=(1, 2)), count) for part in (sums, pairs)
    )
    energies: F64 = np.fft.rfft(products / np.maximum(numbers, 1e-3)).real[: (count - 1) // 2 + 1] / count
    energies[1:] *= 2
    # The ratio of two estimates may fall below zero; by how much, tells how good it is.
    return np.asarray(np.maximum(energies, np.quantile(np.abs(energies[1:]), 0.5)))


def _energies(slices: F32, angles_rad: F64, valid: Mask) -> F64:
    """Measure the mean variance that each harmonic over the turn brings to a texel, (M + 1,)."""
    texels = np.flatnonzero(valid)
    chosen = texels[:: -(-len(texels) // _SAMPLED_TEXELS)]
    light = slices.reshape(len(slices), -1, 3)[:, chosen].reshape(len(slices), -1)
    highest = (len(slices) - 1) // 2
    orders = np.arange(1, highest + 1) * angles_rad[:, None]
    design = np.hstack([np.ones((len(slices), 1)), np.cos(orders), np.sin(orders)])
    # A breath of ridge: uneven angles can leave the highest harmonics nearly untold.
    solver = np.linalg.solve(design.T @ design + 1e-3 * len(slices) * np.eye(design.shape[1]), design.T)
    squares = np.mean((solver.astype(np.float32) @ light).astype(np.float64) ** 2, axis=1)
    energies: F64 = squares[: highest + 1].copy()
    energies[1:] = (energies[1:] + squares[highest + 1 :]) / 2
    return energies


def _precision(energies: F64, angles_rad: F64) -> tuple[F64, float]:
    """Give inverse covariance (N, N) of a texel's values, and their noise's variance, in units of that over the turn.

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
    return variance * np.linalg.inv(covariance + noise * np.eye(len(lags))), noise / variance


def _fill_over_turn(filled: F32, hidden: Mask, precision: F64, noise: float) -> F32:
    """Fill in place from the other slices; return the variance beyond the noise, (N, S, S), in those of the turn.

    With Q the inverse covariance, hidden values h given the seen ones o have mean −Q_hh⁻¹ Q_ho x_o and variance Q_hh⁻¹.
    """
    count = len(filled)
    light, marks = filled.reshape(count, -1, 3), hidden.reshape(count, -1)
    beyond = np.zeros(marks.shape, np.float32)
    hidden_counts = marks.sum(axis=0)
    lost = hidden_counts > _MOST_HIDDEN * count
    beyond[:, lost] = np.where(marks[:, lost], np.float32(np.inf), 0)
    some = np.flatnonzero((hidden_counts > 0) & ~lost)
    some = some[np.argsort(hidden_counts[some], kind="stable")]
    start = 0
    while start < len(some):
        deepest = hidden_counts[some[min(start + 512, len(some)) - 1]]
        texels = some[start : start + max(1, min(512, _BATCH_VALUES // int(deepest) ** 2))]
        values, variances = _conditional(light[:, texels], marks[:, texels], precision)
        places, members = np.nonzero(marks[:, texels])
        light[places, texels[members]] = values[places, members]
        beyond[places, texels[members]] = variances[places, members] - max(noise, 2 * noise - _NEIGHBOURS_VARIANCE)
        start += len(texels)
    return beyond.reshape(hidden.shape)


def _conditional(light: F32, marks: Mask, precision: F64) -> tuple[F64, F64]:
    """Give mean (N, T, 3) and variance (N, T) of the marked values given the others; zero elsewhere."""
    count, texels = marks.shape
    known = np.where(marks[..., None], 0, light).astype(np.float64)
    pull = (precision @ known.reshape(count, -1)).reshape(count, texels, 3)
    deepest = int(marks.sum(axis=0).max())
    # Each texel's marked slices first, in order; the rest of a row pads with independent ones.
    first = np.argsort(~marks, axis=0, kind="stable")[:deepest].T
    real = np.take_along_axis(marks.T, first, axis=1)
    matrices = precision[first[:, :, None], first[:, None, :]] * (real[:, :, None] & real[:, None, :])
    matrices[:, np.arange(deepest), np.arange(deepest)] += ~real
    members = np.arange(texels)[:, None]
    inverse = np.linalg.inv(matrices)
    values = -inverse @ (pull[first, members] * real[..., None])
    mean, variance = np.zeros((count, texels, 3)), np.zeros((count, texels))
    mean[first, members] = values
    variance[first, members] = np.diagonal(inverse, axis1=1, axis2=2) * real
    return mean, variance


def _fill_over_sphere(filled: F32, variances: F32, depths: F32, valid: Mask) -> None:
    """Mix in place with what neighbours on the sphere say, by inverse variances, slice by slice."""
    n_x, n_y = texel_plane(len(valid))
    normals = np.stack([n_x, n_y, np.sqrt(np.maximum(1 - n_x**2 - n_y**2, 0))], axis=-1)
    for slice_, variance, depth in zip(filled, variances, depths, strict=True):
        holes = variance > _CERTAIN
        if holes.any() and not np.array_equal(holes, valid):
            neighbours = _NEIGHBOURS_VARIANCE * (1 + (depth[holes] / _NEIGHBOURS_REACH_PX) ** 2)
            share = 1 / (1 + neighbours / variance[holes])[:, None]
            slice_[holes] += share * (_fit_around(slice_, holes, valid & ~holes, normals) - slice_[holes])


def _fit_around(slice_: F32, holes: Mask, known: Mask, normals: F64) -> F32:
    """Fit a plane to the nearest known texels around each hole, weighted by the inverse fourth power of distance.

    Returns
    -------
    estimates : (holes, 3) float32
    """
    near = known & (ndimage.distance_transform_edt(~holes) <= 1.5 + _NEIGHBOURS**0.5)
    sources = near if near.sum() >= _NEIGHBOURS else known
    count = min(_NEIGHBOURS, int(sources.sum()))
    distances, nearest = cKDTree(normals[sources]).query(normals[holes], k=np.arange(1, count + 1))
    weights = distances**-4.0
    weights /= weights.sum(axis=1, keepdims=True)
    offsets = normals[sources][nearest] - normals[holes][:, None]
    design = np.concatenate([np.ones((*distances.shape, 1)), offsets], axis=2)
    weighted = design * weights[..., None]
    moments = weighted.swapaxes(1, 2) @ design
    spread = np.sum(weights * distances**2, axis=1)
    # The sphere is curved little within a hole, so that its normals nearly lie in a plane.
    moments[:, [1, 2, 3], [1, 2, 3]] += 0.05 * spread[:, None]
    planes = np.linalg.solve(moments, weighted.swapaxes(1, 2) @ slice_[sources][nearest])
    return np.asarray(planes[:, 0], np.float32)
