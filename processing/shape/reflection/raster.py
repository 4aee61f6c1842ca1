"""Drawing spherical polygons into one half of a dual paraboloid map (the Shape paper, section 3.2, equation 2).

The paper spans its polygons between rectified normals n′ = (r + z)/|r + z|. That of a texel of the front half is
(u, v, 1)/√(1 + q), so that the map's own plane is the gnomonic picture of n′: great circles are straight in it, and a
spherical triangle is drawn as a plane one. n′ has no value at r = −z; the back half's plane is that of
(r − z)/|r − z|, the same about the other pole, and has none at z instead, which is not in it.
"""

import math

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Indices = NDArray[np.int32]
SUMS = 7
"""Red, green, blue, column, row, texels that a pixel is narrow (inverted), weight: each times the weight."""
EXPONENT = 200
"""η"""
_FAR_Q = 1.5
"""A polygon whose corners all lie further out has nothing within the circle."""
_FURTHEST_Q = 1e6
_ON_EDGE = 1e-9
"""Of a triangle: what rounding could make lie outside both triangles that share an edge."""
_BESIDE = 1e-6
"""Texels that a row reaches further than rounding has it."""
_LEAST_COSINE = 0.5
"""Between the corners of a polygon; larger ones are no picture of a smooth surface."""


def chart(mirrored: NDArray[np.floating], *, front: bool) -> F64:
    """Bring directions (N, 3) into the plane of one half, (N, 2) as (u, v); the other pole is far away."""
    r = np.asarray(mirrored, np.float64)
    height = 1 + (r[:, 2] if front else -r[:, 2])
    return r[:, :2] / np.maximum(height, 1e-12)[:, None]


@kernel
def _squared(u: float, v: float, x: float, y: float) -> float:
    """Square of the cross product of (u, v, 1) and (x, y, 1), which is |·||·| sin θ."""
    return (v - y) ** 2 + (x - u) ** 2 + (u * y - v * x) ** 2


@kernel
def _per_area(u: F64, v: F64, second: int) -> float:
    """Return 1 / (twice the area) of the triangle of corner 0 and two others; 0 of one that has none."""
    third = second + 1
    area = (u[second] - u[0]) * (v[third] - v[0]) - (v[second] - v[0]) * (u[third] - u[0])
    return 1 / area if area != 0 else 0.0


@kernel
def _triangle(u: F64, v: F64, s: F64, per_area: float, second: int, x: float, y: float, share: F64) -> bool:
    """Find the normalised spherical coordinates in the triangle of corner 0 and two others, if it is inside."""
    third = second + 1
    px, py = x - u[0], y - v[0]
    b = (px * (v[third] - v[0]) - py * (u[third] - u[0])) * per_area
    if b < -_ON_EDGE or per_area == 0:
        return False
    c = ((u[second] - u[0]) * py - (v[second] - v[0]) * px) * per_area
    if c < -_ON_EDGE or b + c > 1 + _ON_EDGE:
        return False
    share[1] = share[2] = share[3] = 0.0
    share[0], share[second], share[third] = (1 - b - c) * s[0], b * s[second], c * s[third]
    per_total = 1 / (share[0] + share[second] + share[third])
    share[0], share[second], share[third] = share[0] * per_total, share[second] * per_total, share[third] * per_total
    return True


@kernel
def _mean_value(u: F64, v: F64, s: F64, t: F64, x: float, y: float, share: F64) -> bool:
    """Find the spherical mean value coordinates in a quad, normalised, if they are all positive.

    λₖ ∝ (tan(αₖ₋₁/2) + tan(αₖ/2))/sin θₖ, with θₖ the arc from the place to corner k, and αₖ the angle at the place
    between corners k and k + 1 (Langer, Belyaev, Seidel 2006, equation 8).
    """
    within = False
    for k in range(4):
        after = (k + 1) % 4
        if (v[k] > y) != (v[after] > y) and x < u[k] + (y - v[k]) / (v[after] - v[k]) * (u[after] - u[k]):
            within = not within
    if not within:
        return False
    place = math.sqrt(1 + x * x + y * y)
    total, sign = 0.0, 0.0
    for k in range(4):
        after = (k + 1) % 4
        # Corners less the place, in its tangent plane; products of these are left by those along the place.
        along = (1 + x * u[k] + y * v[k]) / (place * s[k])
        along_after = (1 + x * u[after] + y * v[after]) / (place * s[after])
        between = (1 + u[k] * u[after] + v[k] * v[after]) / (s[k] * s[after])
        length = math.sqrt(_squared(u[k], v[k], x, y)) / (place * s[k])
        length_after = math.sqrt(_squared(u[after], v[after], x, y)) / (place * s[after])
        turned = ((u[k] - x) * (v[after] - y) - (v[k] - y) * (u[after] - x)) / (place * s[k] * s[after])
        denominator = length * length_after + between - along * along_after
        t[k] = turned / denominator if denominator > 1e-15 else 0.0
    for k in range(4):
        length = math.sqrt(_squared(u[k], v[k], x, y)) / (place * s[k])
        if length < 1e-9:
            share[0] = share[1] = share[2] = share[3] = 0.0
            share[k] = 1.0
            return True
        share[k] = (t[k] + t[(k + 3) % 4]) / length
        total += share[k]
    if total == 0:
        return False
    for k in range(4):
        share[k] /= total
        sign = min(sign, share[k])
    return sign >= 0


@kernel
def _span(u: F64, v: F64, count: int, y: float) -> tuple[float, float]:
    """Return from where to where a polygon reaches along a row."""
    least, most = np.inf, -np.inf
    for k in range(count):
        after = (k + 1) % count
        if v[k] == y:
            least, most = min(least, u[k]), max(most, u[k])
        elif (v[k] < y) != (v[after] < y):
            x = u[k] + (y - v[k]) / (v[after] - v[k]) * (u[after] - u[k])
            least, most = min(least, x), max(most, x)
    return least, most


@kernel
def draw(corners: Indices, places: F64, colours: F32, columns: int, quads: bool, sums: F64) -> None:
    """Add polygons to the sums of equation 2, each with its weight (1 − arc/π)^η.

    Parameters
    ----------
    corners : (P, 4) as `polygons` gives them
    places : (N, 2) of every pixel in the plane of this half
    colours : (N, 3)
    columns : of the picture, to tell where a pixel stands
    quads : by spherical mean value coordinates; or as two triangles
    sums : (S, S, 7) is added to
    """
    size = sums.shape[0]
    u, v, s, t = np.zeros(4), np.zeros(4), np.zeros(4), np.zeros(4)
    share, at_column, at_row = np.zeros(4), np.zeros(4), np.zeros(4)
    for polygon in range(corners.shape[0]):
        count = 4 if corners[polygon, 3] >= 0 else 3
        nearest, furthest = np.inf, 0.0
        u_least, u_most, v_least, v_most = np.inf, -np.inf, np.inf, -np.inf
        for k in range(count):
            u[k], v[k] = places[corners[polygon, k], 0], places[corners[polygon, k], 1]
            q = u[k] * u[k] + v[k] * v[k]
            nearest, furthest = min(nearest, q), max(furthest, q)
            u_least, u_most = min(u_least, u[k]), max(u_most, u[k])
            v_least, v_most = min(v_least, v[k]), max(v_most, v[k])
        if not (nearest < _FAR_Q and furthest < _FURTHEST_Q):
            continue
        left = max(0, math.ceil((u_least + 1) / 2 * size - 0.5))
        right = min(size - 1, math.floor((u_most + 1) / 2 * size - 0.5))
        top = max(0, math.ceil((1 - v_most) / 2 * size - 0.5))
        bottom = min(size - 1, math.floor((1 - v_least) / 2 * size - 0.5))
        if right < left or bottom < top:
            continue
        cosine, longest, twice = 1.0, 0.0, 0.0
        for k in range(count):
            s[k] = math.sqrt(1 + u[k] * u[k] + v[k] * v[k])
            for other in range(k):
                cosine = min(cosine, (1 + u[k] * u[other] + v[k] * v[other]) / (s[k] * s[other]))
                longest = max(longest, (u[k] - u[other]) ** 2 + (v[k] - v[other]) ** 2)
            at_row[k] = corners[polygon, k] // columns
            at_column[k] = corners[polygon, k] - at_row[k] * columns
            after = (k + 1) % count
            twice += u[k] * v[after] - u[after] * v[k]
        if cosine < _LEAST_COSINE:
            continue
        weight = (1 - math.acos(cosine) / math.pi) ** EXPONENT
        per_one, per_other = _per_area(u, v, 1), _per_area(u, v, 2) if count == 4 else 0.0
        width = max(abs(twice) / 2 / max(math.sqrt(longest), 1e-12) * size / 2, 1e-3)
        for row in range(top, bottom + 1):
            y = 1 - (2 * row + 1) / size
            least, most = _span(u, v, count, y)
            if not least <= most:
                continue
            first = max(left, math.ceil((least + 1) / 2 * size - 0.5 - _BESIDE))
            last = min(right, math.floor((most + 1) / 2 * size - 0.5 + _BESIDE))
            for column in range(first, last + 1):
                x = (2 * column + 1) / size - 1
                if quads and count == 4:
                    inside = _mean_value(u, v, s, t, x, y, share)
                else:
                    inside = _triangle(u, v, s, per_one, 1, x, y, share)
                    if not inside and count == 4:
                        inside = _triangle(u, v, s, per_other, 2, x, y, share)
                if inside:
                    red, green, blue, from_column, from_row = 0.0, 0.0, 0.0, 0.0, 0.0
                    for k in range(count):
                        pixel = corners[polygon, k]
                        red += share[k] * colours[pixel, 0]
                        green += share[k] * colours[pixel, 1]
                        blue += share[k] * colours[pixel, 2]
                        from_column += share[k] * at_column[k]
                        from_row += share[k] * at_row[k]
                    sums[row, column, 0] += weight * red
                    sums[row, column, 1] += weight * green
                    sums[row, column, 2] += weight * blue
                    sums[row, column, 3] += weight * from_column
                    sums[row, column, 4] += weight * from_row
                    sums[row, column, 5] += weight / width
                    sums[row, column, 6] += weight
