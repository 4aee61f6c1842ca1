"""How a place of the sample lights up and darkens over the turn, and by how much more than its neighbours'.

In the sample's frame the light goes round a sample at rest. The logarithm of what a place shows over the turn is its
light curve: albedo (a thread, a stain) shifts it as a whole, into harmonic 0; a tangent that points elsewhere shifts
it in time, into the others. Neighbouring places of a good sample have neighbouring normals, and so similar curves.
"""

from collections.abc import Callable

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from processing.amc.flaws.sample_frame import turn
from processing.amc.geometry import texel_plane

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

MOST_HARMONICS = 8
LEVELS = 3  # maps of harmonic 0: lightness, and two differences of channels
_DARK_SHARE = 0.1
_FINEST_WINDOW = 2.5
_CELLS, _CELL_SHARE, _FEWEST_IN_CELL, _MOST_IN_CELL = 6, 0.31, 30, 400
_MEDIAN_GRID, _MEDIAN_SHARE, _RINGS = 64, 0.25, 12
_FAR_ASTRAY, _PLAINLY_ASTRAY = 5.0, 0.1
_LEVELS_LENIENCE = 1.5  # texture is in the levels, and even texture strays


def light_curves(
    slices: F32, turns_rad: F64, valid: Mask, still: Mask, release: Callable[[], None] = lambda: None
) -> F32:
    """Give the harmonics of every place's light curve.

    Parameters
    ----------
    slices : (N, S, S, 3) float32, linear light
    turns_rad : (N,) turntable angle of each slice less that of the first
    valid : (S, S) bool, the disc that was seen
    still : (S, S) bool, texels to replace by a neighbour before the slices are turned
    release : called after each slice, to give back what it took of memory

    Returns
    -------
    curves : (3 + 2·M, S, S) float32 in the frame of slice 0: levels, then cosine and sine parts of lightness for
        harmonics 1..M; natural logarithms, so that 0.01 is one per cent
    """
    highest = min(MOST_HARMONICS, len(slices) // 4)
    dark = _DARK_SHARE * np.median(slices[:: max(1, len(slices) // 32)][:, valid], axis=(0, 1)) + 1e-6
    replace = _nearest(valid & ~still)
    phases = np.arange(1, highest + 1)[:, None] * turns_rad
    waves = np.sqrt(2) * np.concatenate([np.cos(phases), np.sin(phases)]).astype(np.float32)
    curves = np.zeros((LEVELS + len(waves), *valid.shape), np.float32)
    for slice_, turn_rad, wave in zip(slices, turns_rad, waves.T, strict=True):
        logarithm = np.log(np.maximum(slice_[replace], 0) + dark).astype(np.float32)
        red, green, blue = cv2.split(turn(logarithm, -float(turn_rad)))
        lightness = (red + green + blue) / 3
        for level, light in zip(curves, (lightness, red - green, blue - green), strict=False):
            level += light
        for harmonic, share in zip(curves[LEVELS:], wave, strict=True):
            cv2.scaleAdd(lightness, float(share), harmonic, harmonic)
        release()
    curves /= np.float32(len(slices))
    return curves


def local_fit(curves: F32, weights: F32, sigma: float) -> F32:
    """Predict each place's curve from its neighbours': a weighted quadratic in the place, Gaussian window.

    Parameters
    ----------
    curves : (K, S, S) float32
    weights : (S, S) float32, how much each place is believed
    sigma : of the window, in texels

    Returns
    -------
    predicted : (K, S, S) float32
    """
    size = curves.shape[-1]
    line = ((np.arange(size) - (size - 1) / 2) * 4 / size).astype(np.float32)
    x, y = np.meshgrid(line, line)
    terms = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y])
    count = len(terms)
    # Sums over so wide a window change little from texel to texel: they are taken on a grid that is as fine as needed.
    grid = max(1, round(size / max(1.0, sigma / _FINEST_WINDOW)))

    def windowed(maps: F32) -> F64:
        coarse = [cv2.resize(one, (grid, grid), interpolation=cv2.INTER_AREA) for one in maps]
        blur = (cv2.GaussianBlur(one, (0, 0), sigma * grid / size, borderType=cv2.BORDER_CONSTANT) for one in coarse)
        return np.stack(list(blur), axis=-1).astype(np.float64)

    weighted = weights * terms
    rows, columns = np.triu_indices(count)
    moments = np.zeros((grid, grid, count, count))
    moments[..., rows, columns] = windowed(weighted[rows] * terms[columns])
    moments[..., columns, rows] = moments[..., rows, columns]
    sums = windowed((weighted[:, None] * curves).reshape(-1, size, size)).reshape(grid, grid, count, -1)
    ridge = 1e-7 * np.trace(moments, axis1=-2, axis2=-1)[..., None, None] + 1e-12
    coefficients = np.linalg.solve(moments + ridge * np.eye(count), sums).astype(np.float32)
    predicted = np.zeros_like(curves)
    for term, theirs in zip(terms, np.moveaxis(coefficients, (2, 3), (0, 1)), strict=True):
        for out, one in zip(predicted, theirs, strict=True):
            out += term * cv2.resize(one, (size, size), interpolation=cv2.INTER_LINEAR)
    return predicted


def usual_stray(strays: F32, believed: Mask, floor: F32) -> F32:
    """Give the usual size of each map of strays around each place: medians in overlapping cells, interpolated.

    Parameters
    ----------
    strays : (K, S, S) float32
    believed : (S, S) bool, places to ask
    floor : (K,) float32, the least to return

    Returns
    -------
    usual : (K, S, S) float32, in standard deviations of a normal distribution
    """
    size = strays.shape[-1]
    half = _CELL_SHARE * size / 2
    usual = np.zeros((len(strays), _CELLS, _CELLS), np.float32)
    asked = np.zeros((_CELLS, _CELLS), bool)
    windows = [slice(max(0, int(c - half)), int(c + half) + 1) for c in (np.arange(_CELLS) + 0.5) * size / _CELLS]
    for row, rows in enumerate(windows):
        for column, columns in enumerate(windows):
            inside = np.flatnonzero(believed[rows, columns])
            if len(inside) >= _FEWEST_IN_CELL:
                asked[row, column] = True
                some = strays[:, rows, columns].reshape(len(strays), -1)[:, inside[:: -(-len(inside) // _MOST_IN_CELL)]]
                usual[:, row, column] = 1.4826 * np.median(np.abs(some), axis=1)
    if asked.any():
        usual = usual[:, *_nearest(asked)]
    spread = np.stack([cv2.resize(one, (size, size), interpolation=cv2.INTER_LINEAR) for one in usual])
    return np.maximum(spread, floor[:, None, None])


def rms_of_groups(strays: F32) -> tuple[F32, F32]:
    """Join maps of strays: the root mean square over the levels, and over the other harmonics; (S, S) each."""
    squares = strays**2
    return np.sqrt(squares[:LEVELS].mean(axis=0)), np.sqrt(squares[LEVELS:].mean(axis=0))


def first_weights(curves: F32, valid: Mask) -> F32:
    """Believe, to begin with, the places whose level is near the median around: least squares starts badly on a gash.

    Parameters
    ----------
    curves : (K, S, S) float32
    valid : (S, S) bool

    Returns
    -------
    weights : (S, S) float32, 0 or 1
    """
    size = curves.shape[-1]
    step = -(-size // _MEDIAN_GRID)
    window = int(_MEDIAN_SHARE * size / step) | 1
    weights = valid.astype(np.float32)
    for level in (_less_rings(one, valid) for one in curves[:LEVELS]):
        coarse = ndimage.median_filter(level[::step, ::step], window, mode="constant")
        stray = np.abs(level - cv2.resize(coarse, (size, size), interpolation=cv2.INTER_LINEAR))
        weights[stray > max(_FAR_ASTRAY * float(np.median(stray[valid])), _PLAINLY_ASTRAY)] = 0
    return weights


def _less_rings(level: F32, valid: Mask) -> F32:
    """Take off each place the median of its ring about the axis; 0 off the disc, so that the rim has neighbours."""
    rings = (np.hypot(*texel_plane(len(valid))) * _RINGS).astype(int)
    less = np.zeros_like(level)
    for ring in range(_RINGS):
        inside = valid & (rings == ring)
        if inside.any():
            less[inside] = level[inside] - np.median(level[inside])
    return less


def strays_from_neighbours(
    curves: F32, weights: F32, valid: Mask, sigma: float, knees: tuple[float, ...], floor: F32
) -> tuple[F32, F32]:
    """Compare each curve with its neighbours', believing ever less in those that stray.

    Parameters
    ----------
    curves : (K, S, S) float32
    weights : (S, S) float32, how much each place is believed at first
    valid : (S, S) bool
    sigma : of the neighbourhood, in texels
    knees : for each pass, the stray at which a place is half believed
    floor : (K,) float32, the least usual stray of each map

    Returns
    -------
    strays : (K, S, S) float32, in units of what is usual
    weights : (S, S) float32
    """
    strays = np.zeros_like(curves)
    for knee in knees:
        strays = curves - local_fit(curves, weights, sigma)
        strays /= usual_stray(strays, valid & (weights > 0), floor)
        levels, waves = rms_of_groups(strays)
        astray = np.maximum(levels / _LEVELS_LENIENCE, waves) / knee
        weights = (valid / (1 + astray**4)).astype(np.float32)
        weights[weights < 0.05] = 0
    return strays, weights


def _nearest(known: Mask) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Index that gives every texel the value of its nearest known one."""
    rows, columns = ndimage.distance_transform_edt(~known, return_distances=False, return_indices=True)
    return rows, columns
