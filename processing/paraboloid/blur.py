"""Blur over all directions: what a rougher material does to light.

The kernel is that of heat on the sphere: blurring by one variance and then by another is blurring by their sum. Maps
shrink as what they hold grows smoother, so that a large blur costs no more than a small one.
"""

from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline

from litrig.base.errors import InputError
from litrig.base.kernels import kernel
from processing.paraboloid.charts import joined, plane, widened
from processing.paraboloid.maps import texel_directions

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

_STEP_TEXELS = 2.0
"""A map is halved when it is blurred by a standard deviation of this many of its largest texels."""
_REACH = 3.5
_KEPT = 1 - 0.5 * _REACH**2 * np.exp(-0.5 * _REACH**2) / (1 - np.exp(-0.5 * _REACH**2))
"""The share of a Gaussian's variance that is left when it is cut off at `_REACH` standard deviations."""
_BEYOND_TEXELS = 10
"""So many texels beyond the unit circle are blurred too, for the splines that are laid through those within."""
_ALL_AT_ONCE = 32
_SMALLEST_GATHERED = 16
"""Maps of fewer texels a side than the second are summed whole, of at most the first if the blur covers texels."""
_LEAST_TEXELS = 0.05
"""A blur by less is none."""
_WHOLE = 1.25
_COARSE = 250.0
"""Maps are halved as they are where the variance of the blur is so many times that of their largest texel's square."""
_MEAN_OF_FOUR = 0.15
"""What that blurs by, in the same measure, on the whole of the sphere: ¼ in a map's middle, 1/16 at the seam."""
_ENTRIES = 2048


def blurred(front: F32, back: F32, variance: float, size: int | None = None) -> tuple[F32, F32]:
    """Blur a dual paraboloid map (S, S, 3) each.

    Parameters
    ----------
    variance : that is added, radians squared, along any great circle
    size : of the result; None is S. A smaller one loses nothing if the blur covers its texels

    Returns
    -------
    front, back : (size, size, 3) float32

    Raises
    ------
    InputError
        The variance is negative or no number.
    """
    wanted = size or front.shape[0]
    front, back = blurred_small(front, back, variance)
    return (front, back) if front.shape[0] == wanted else resized(front, back, wanted)


def blurred_small(front: F32, back: F32, variance: float) -> tuple[F32, F32]:
    """Blur as `blurred` does, and leave the result at the size that it was done at: no more texels than it needs."""
    if not 0 <= variance < np.inf:
        raise InputError(f"blur: a variance of {variance:g} is none; give 0 or more, in radians squared")
    front, back = (np.ascontiguousarray(side, np.float32) for side in (front, back))
    left = variance
    while front.shape[0] % 2 == 0 and left >= _COARSE * largest_texel(front.shape[0]) ** 2:
        left -= _MEAN_OF_FOUR * largest_texel(front.shape[0]) ** 2
        front, back = _halved(front), _halved(back)
    while front.shape[0] > _ALL_AT_ONCE and left >= (step := (_STEP_TEXELS * largest_texel(front.shape[0])) ** 2):
        # What would be left over may not be too little for the texels that come.
        step = left if left < _WHOLE * step else step
        front, back = _gathered(front, back, step, front.shape[0] // 2)
        left -= step
    now = front.shape[0]
    if left < (_LEAST_TEXELS * largest_texel(now)) ** 2:
        return front, back
    if left > 0 and (now < _SMALLEST_GATHERED or (now <= _ALL_AT_ONCE and left >= largest_texel(now) ** 2)):
        return _summed(front, back, left)
    return _gathered(front, back, left, now)


def largest_texel(size: int) -> float:
    """Return the angle, in radians, across a texel in a map's middle; at the seam it is half of that."""
    return 4.0 / size


def resized(front: F32, back: F32, size: int) -> tuple[F32, F32]:
    """Read maps at another number of texels, by cubic splines; smaller ones are averaged first."""
    if size == front.shape[0]:
        return front, back
    while front.shape[0] % 2 == 0 and front.shape[0] // 2 >= 2 * size:
        front, back = _halved(front), _halved(back)
    if size < front.shape[0]:
        # As wide as the new texels are, in the old ones' measure.
        variance = largest_texel(size) ** 2 / 12 * (1 - (size / front.shape[0]) ** 2)
        front, back = _gathered(front, back, variance, front.shape[0])
    return _resampled(front, back, size), _resampled(back, front, size)


def _halved(side: F32) -> F32:
    return np.asarray(cv2.resize(side, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA), np.float32)


def _resampled(this: F32, other: F32, size: int) -> F32:
    """Read one map at the texel centres of another size; beyond the unit circle, the other map."""
    pad = 4
    texels = widened(this, other, pad)
    given = (2 * np.arange(-pad, this.shape[0] + pad) + 1) / this.shape[0]
    wanted = (2 * np.arange(size) + 1) / size
    for axis in (0, 1):
        texels = make_interp_spline(given, texels, k=3, axis=axis)(wanted).astype(np.float32)
    return texels


def _gathered(front: F32, back: F32, variance: float, size: int) -> tuple[F32, F32]:
    """Blur by a kernel that is small on the maps, each texel from the widened map that it lies in."""
    reach = _REACH * np.sqrt(variance / _KEPT)
    source = front.shape[0]
    rim = min(1 + 2 * _BEYOND_TEXELS / size, np.sqrt(2))
    # The kernel of the outermost texel ends here.
    pad = int(np.ceil((np.tan(np.arctan(rim) + reach / 2) - 1) * source / 2)) + 2
    u, v = plane(source, pad)
    scale = 2 / (1 + u * u + v * v)
    directions = np.stack([u * scale, v * scale, scale - 1, scale * scale], axis=-1)
    kernel_by_chord, entries = _by_chord(variance / _KEPT, reach)

    def side(pair: tuple[F32, F32]) -> F32:
        texels = np.concatenate([directions, widened(*pair, pad)], axis=-1, dtype=np.float32)
        return _gather(texels, kernel_by_chord, entries, pad, source, size, rim, reach)

    with ThreadPoolExecutor(2) as threads:
        gathered = list(threads.map(side, ((front, back), (back, front))))
    return joined(gathered[0], gathered[1])


def _by_chord(variance: float, reach: float) -> tuple[F32, float]:
    """Tabulate the kernel, a Gaussian in the angle d times √(d/sin d), over 2 − 2 cos d; and entries for each unit."""
    longest = 2 - 2 * np.cos(reach) * 0.99
    angles = np.arccos(np.clip(1 - np.linspace(0, longest, _ENTRIES) / 2, -1, 1))
    sharp = np.exp(-0.5 * angles**2 / variance) * np.sqrt(angles / np.maximum(np.sin(angles), 1e-9))
    sharp[0] = 1
    return np.append(sharp, [sharp[-1]] * 2).astype(np.float32), (_ENTRIES - 1) / longest


@kernel
def _gather(
    texels: F32, by_chord: F32, entries: float, pad: int, source: int, size: int, rim: float, reach: float
) -> F32:
    """Sum the surroundings of each texel of a map of `size` within a circle.

    Parameters
    ----------
    texels : (P, P, 7) widened by `pad`: x, y, z of texel centres, how much of the sphere each covers, and its colour
    """
    result = np.zeros((size, size, 3), np.float32)
    last = texels.shape[0] - 1
    for row in range(size):
        for column in range(size):
            u = (2 * column + 1) / size - 1
            v = 1 - (2 * row + 1) / size
            q = u * u + v * v
            if q > rim * rim:
                continue
            scale = np.float32(2 / (1 + q))
            x, y, z = np.float32(u) * scale, np.float32(v) * scale, scale - np.float32(1)
            # A circle on the sphere is a circle in the map.
            radius = np.sqrt(q)
            angle = 2 * np.arctan(radius)
            outer, inner = np.tan(0.5 * (angle + reach)), np.tan(0.5 * (angle - reach))
            middle = 0.5 * (outer + inner) / radius if radius > 1e-9 else 0.0
            across = 0.5 * (outer - inner) * source / 2
            centre_column = (1 + u * middle) * source / 2 - 0.5 + pad
            centre_row = (1 - v * middle) * source / 2 - 0.5 + pad
            red = green = blue = weights = np.float32(0)
            for r in range(max(int(np.ceil(centre_row - across)), 0), min(int(centre_row + across), last) + 1):
                half = np.sqrt(max(across * across - (r - centre_row) ** 2, 0.0))
                for c in range(max(int(np.ceil(centre_column - half)), 0), min(int(centre_column + half), last) + 1):
                    cosine = x * texels[r, c, 0] + y * texels[r, c, 1] + z * texels[r, c, 2]
                    place = max(np.float32(2) - np.float32(2) * cosine, np.float32(0)) * np.float32(entries)
                    entry = min(np.int32(place), np.int32(by_chord.size - 2))
                    share = place - np.float32(entry)
                    weight = by_chord[entry] + share * (by_chord[entry + 1] - by_chord[entry])
                    weight *= texels[r, c, 3]
                    weights += weight
                    red += weight * texels[r, c, 4]
                    green += weight * texels[r, c, 5]
                    blue += weight * texels[r, c, 6]
            result[row, column, 0] = red / weights
            result[row, column, 1] = green / weights
            result[row, column, 2] = blue / weights
    return result


def _summed(front: F32, back: F32, variance: float) -> tuple[F32, F32]:
    """Blur small maps by summing all directions for each."""
    size = front.shape[0]
    held, weights = _weights(size, variance)
    colours = np.concatenate([side.reshape(-1, side.shape[2])[held] for side in (front, back)])
    whole = (weights @ colours).reshape(2, size, size, colours.shape[1])
    return whole[0], whole[1]


@lru_cache(maxsize=2)
def _weights(size: int, variance: float) -> tuple[NDArray[np.bool_], F32]:
    """Return which texels of each map hold anything, and what each gives to each texel of the result.

    Deconvolution asks for the same many times.
    """
    u, v = plane(size)
    q = u * u + v * v
    # Texels that the unit circle cuts count by what is in it.
    cover = (np.clip((1 - np.sqrt(q)) * size / 2 + 0.5, 0, 1) * (2 / (1 + q)) ** 2).ravel()
    held = cover > 0
    directions = np.concatenate([side.reshape(-1, 3)[held] for side in texel_directions(size)])
    wanted = np.concatenate([side.reshape(-1, 3) for side in texel_directions(size)])
    table = np.linspace(-1, 1, 8193)
    weights = np.interp(wanted @ directions.T, table, heat(table, variance)) * np.tile(cover[held], 2)
    return held, (weights / weights.sum(axis=1, keepdims=True)).astype(np.float32)


def heat(cosines: F64, variance: float) -> F64:
    """Return the kernel of heat on the sphere, up to a factor, at angles of given cosines.

    It is the Legendre series Σ (2l + 1) exp(−variance·l(l + 1)/2) P_l.
    """
    last = int(np.ceil(np.sqrt(2 * 25 / variance))) + 1
    orders = np.arange(last + 1)
    series = (2 * orders + 1) * np.exp(-0.5 * variance * orders * (orders + 1))
    return np.asarray(np.maximum(np.polynomial.legendre.legval(cosines, series), 0))
