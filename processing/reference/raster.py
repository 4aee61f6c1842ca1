"""Which triangle is seen at which pixel, by the rules of OpenGL, in plain NumPy and double precision."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]


@dataclass(frozen=True)
class Fragments:
    """The nearest surface point of every covered pixel.

    Attributes
    ----------
    rows, columns : (N,) pixel, row 0 on top
    triangles : (N,) which triangle
    weights : (N, 3) shares of its corners, perspective-correct, so that attributes are plain weighted sums
    front : (N,) bool, seen from the side on which the corners run counter-clockwise
    """

    rows: I64
    columns: I64
    triangles: I64
    weights: F64
    front: NDArray[np.bool_]

    def interpolate(self, attributes: F64, corners: NDArray[np.integer]) -> F64:
        """Return an attribute (V, C) of the vertices at the fragments, (N, C); `corners` are the mesh's triangles."""
        values: F64 = np.einsum("nc,ncd->nd", self.weights, attributes[corners[self.triangles]])
        return values


def rasterise(points: F64, corners: NDArray[np.integer], clip_from_view: F64, size: tuple[int, int]) -> Fragments:
    """Find what is seen at every pixel's centre.

    A centre on a shared edge belongs to one triangle alone, the one below or to the right of the edge (the top-left
    rule). Of several surfaces the nearest is seen; nothing is culled.

    Parameters
    ----------
    points : (V, 3) view frame
    corners : (T, 3) indices of points
    size : width and height in pixels

    Raises
    ------
    InputError
        A point is beside or behind the eye: this rasteriser does not clip.
    """
    clip = np.concatenate([points, np.ones((len(points), 1))], axis=1) @ clip_from_view.T
    w = clip[:, 3]
    if not np.all(w > 0):
        raise InputError("mesh: reaches behind the eye; move it away or narrow the field of view")
    width, height = size
    screen = np.stack([(clip[:, 0] / w + 1) / 2 * width, (1 - clip[:, 1] / w) / 2 * height, clip[:, 2] / w], axis=1)[
        corners
    ]
    triangles, columns, rows = _candidates(screen, width, height)
    shares, inside = _edge_shares(screen[triangles], columns + 0.5, rows + 0.5)
    triangles, columns, rows, shares = triangles[inside], columns[inside], rows[inside], shares[inside]
    depths = np.sum(shares * screen[triangles, :, 2], axis=1)
    seen = _nearest(rows * width + columns, depths, triangles)
    triangles = triangles[seen]
    corrected = shares[seen] / w[corners[triangles]]
    return Fragments(
        rows=rows[seen],
        columns=columns[seen],
        triangles=triangles,
        weights=corrected / corrected.sum(axis=1, keepdims=True),
        # Rows count downwards, which turns the sense of rotation round.
        front=_doubled_areas(screen)[triangles] < 0,
    )


def _candidates(screen: F64, width: int, height: int) -> tuple[I64, I64, I64]:
    """List every pixel whose centre lies in a triangle's bounding box: triangle, column, row."""
    low = np.ceil(screen[:, :, :2].min(axis=1) - 0.5).astype(np.int64)
    high = np.floor(screen[:, :, :2].max(axis=1) - 0.5).astype(np.int64)
    low = np.maximum(low, 0)
    high = np.minimum(high, np.array([width - 1, height - 1]))
    spans = np.maximum(high - low + 1, 0)
    counts = spans[:, 0] * spans[:, 1]
    triangles = np.repeat(np.arange(len(screen)), counts)
    number = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    rows, columns = np.divmod(number, np.maximum(spans[triangles, 0], 1))
    return triangles, low[triangles, 0] + columns, low[triangles, 1] + rows


def _doubled_areas(screen: F64) -> F64:
    first, second = screen[:, 1, :2] - screen[:, 0, :2], screen[:, 2, :2] - screen[:, 0, :2]
    areas: F64 = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    return areas


def _edge_shares(screen: F64, x: NDArray[np.floating], y: NDArray[np.floating]) -> tuple[F64, NDArray[np.bool_]]:
    """Return the corners' shares (N, 3), linear on the screen, and whether the pixel is the triangle's."""
    areas = _doubled_areas(screen)
    sense = np.sign(areas)
    inside = sense != 0
    shares = np.zeros((len(screen), 3))
    for corner in range(3):
        start, end = screen[:, (corner + 1) % 3, :2], screen[:, (corner + 2) % 3, :2]
        along_x, along_y = sense * (end[:, 0] - start[:, 0]), sense * (end[:, 1] - start[:, 1])
        side = along_x * (y - start[:, 1]) - along_y * (x - start[:, 0])
        is_top_or_left = (along_y < 0) | ((along_y == 0) & (along_x > 0))
        inside &= (side > 0) | ((side == 0) & is_top_or_left)
        shares[:, corner] = side / np.where(areas == 0, 1, np.abs(areas))
    return shares, inside


def _nearest(pixels: I64, depths: F64, triangles: I64) -> I64:
    """Return the index of the nearest candidate of every pixel; of equals the triangle drawn first."""
    order = np.lexsort((triangles, depths, pixels))
    first = np.ones(len(order), bool)
    first[1:] = pixels[order][1:] != pixels[order][:-1]
    return order[first]
