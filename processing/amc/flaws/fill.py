"""Marked texels get the light they would have shown, from the rest of the turn and from their neighbours on the sphere.

The AMC paper expands neighbours over the marks (section 5.1). A mark that turns with the sample hides a texel in a few
slices only, and the other slices say more than the neighbours do: they are of the same normal. So each marked value is
the mean that the turn's model expects of it (`turn_model`). Where most of the turn is hidden (beside the turntable's
axis, on a dead pixel) the neighbours in the same slice speak.
"""

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from scipy.spatial import cKDTree

from processing.amc.flaws.turn_model import MOST_HIDDEN, TurnModel, fill_texels, learn
from processing.amc.geometry import texel_plane

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

_LEAST_MISFIT = 0.1
_NEIGHBOURS = 48
_LAG_PX = 2
_LEAST_SHARE = 0.5  # of a value that neighbours say; below, they are not asked


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
    fill_in_place(filled, marked, angles_rad, valid)
    return filled


def fill_in_place(slices: F32, marked: Mask, angles_rad: F64, valid: Mask) -> None:
    """Replace marked values by estimates, as `fill`, in the slices themselves."""
    hidden = marked & valid
    if not hidden.any() or hidden[:, valid].all():
        return
    model = learn(slices, hidden, angles_rad, valid)
    texels, variances = _fill_over_turn(slices, hidden, model)
    noises = model.noises[model.ring].astype(np.float32)
    n_x, n_y = texel_plane(len(valid))
    normals = np.stack([n_x, n_y, np.sqrt(np.maximum(1 - n_x**2 - n_y**2, 0))], axis=-1)
    variance = np.zeros(valid.shape, np.float32)
    for slice_, holes, of_texels in zip(slices, hidden, variances.T, strict=True):
        if of_texels.any():
            variance.ravel()[texels] = of_texels
            theirs = _roughness(slice_, valid & ~holes, noises)
            theirs *= (_depths(holes | ~valid) / np.float32(_LAG_PX)) ** 2
            _fill_over_sphere(slice_, variance, theirs, normals, valid)


def _depths(unknown: Mask) -> F32:
    """Give the distance of every texel to the nearest known one, (S, S) in texels."""
    depths = cv2.distanceTransform(unknown.astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    return np.asarray(depths, np.float32)


def _fill_over_turn(filled: F32, hidden: Mask, model: TurnModel) -> tuple[NDArray[np.intp], F32]:
    """Fill in place from the other slices.

    Returns
    -------
    texels : (T,) which texels have anything hidden
    beyond : (T, N) variance of what was filled beyond the noise, in light squared; 0 where nothing was
    """
    count = len(filled)
    light, marks = filled.reshape(count, -1, 3), hidden.reshape(count, -1)
    texels = np.flatnonzero(marks.any(axis=0))
    ring = model.ring.ravel()[texels]
    some, places = np.ascontiguousarray(light[:, texels].swapaxes(0, 1)), np.ascontiguousarray(marks[:, texels].T)
    variances = fill_texels(some, places, model.precisions, ring, int(MOST_HIDDEN * count))
    light[:, texels] = some.swapaxes(0, 1)
    # Where the model fits badly (a sharp highlight), its estimates are as much worse than it thinks.
    variances *= np.maximum(model.misfit(some, places, ring), _LEAST_MISFIT)[:, None]
    return texels, np.where(places, np.maximum(variances - model.noises[ring, None], 0), 0).astype(np.float32)


def _roughness(slice_: F32, known: Mask, noises: F32) -> F32:
    """Give by how much (mean square, beyond the noise) values around differ from their neighbours; (S, S)."""
    size, lag = len(known), _LAG_PX
    inner = slice(lag, size - lag)
    sides = [(slice(0, size - 2 * lag), inner), (slice(2 * lag, size), inner)]
    sides += [(columns, rows) for rows, columns in sides]
    window = 2 * (size // 16) + 5
    squares, asked = np.zeros((2, size, size), np.float32)
    asked[inner, inner] = known[inner, inner] & np.logical_and.reduce([known[side] for side in sides])
    off = slice_[inner, inner] - sum(slice_[side] for side in sides) / 4
    squares[inner, inner] = np.mean(off**2, axis=-1)
    near = cv2.boxFilter(squares * asked, -1, (window, window), borderType=cv2.BORDER_CONSTANT)
    counts = cv2.boxFilter(asked, -1, (window, window), borderType=cv2.BORDER_CONSTANT)
    rough = np.where(counts > 0, near / np.maximum(counts, 1e-6), (squares * asked).sum() / max(asked.sum(), 1))
    return np.asarray(np.maximum(rough - np.float32(1.25) * noises, noises / 8), np.float32)


def _fill_over_sphere(slice_: F32, variance: F32, theirs: F32, normals: F64, valid: Mask) -> None:
    """Mix in place with what neighbours on the sphere say, by inverse variances (S, S)."""
    holes = (variance > 0) & (theirs * _LEAST_SHARE < variance * (1 - _LEAST_SHARE))
    if holes.any() and not np.array_equal(holes, valid):
        share = 1 / (1 + theirs[holes] / variance[holes])[:, None]
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
