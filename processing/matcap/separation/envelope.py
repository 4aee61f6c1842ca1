"""All shadings by a single direction, m·n, that stay under given values: the corners of that polyhedron of m.

m·n_q ≤ v_q, divided by n_z, says that a linear function lies under the height v/n_z over the place n_xy/n_z. So the
corners are the planes through the facets of a convex hull, seen from below. There black pixels are points like all
others; among points n_q/v_q they would lie at infinity.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

F64 = NDArray[np.float64]
Integers = NDArray[np.int64]

_LEVEL = 1e-9
"""Facets that lean out more than this, as a slope's inverse, stand upright: no shading passes under them."""
_BELOW = 1e-12
_SECTORS = 512
_FEASIBLE = 1e-10


def outermost(normals: F64) -> Integers:
    """Return which of normals (N, 3), n_z > 0, lie at the end of all: no others have them between them."""
    if len(normals) < 4:
        return np.arange(len(normals))
    places = normals[:, :2] / normals[:, 2:]
    off = places - places.mean(axis=0)
    distances = np.hypot(off[:, 0], off[:, 1])
    sectors = ((np.arctan2(off[:, 1], off[:, 0]) / (2 * np.pi) + 0.5) * _SECTORS).astype(np.int64) % _SECTORS
    farthest = np.zeros(_SECTORS)
    np.maximum.at(farthest, sectors, distances)
    try:
        rough = ConvexHull(off[distances == farthest[sectors]])
        # What lies nearer to the middle than every side of some of the points' hull is within it.
        beyond = np.flatnonzero(distances >= max(-float(rough.equations[:, 2].max()), 0) * (1 - 1e-9))
        corners: Integers = beyond[ConvexHull(off[beyond]).vertices].astype(np.int64)
    except QhullError:  # all in one line
        return np.arange(len(normals))
    return corners


def shadings_under(normals: F64, values: F64) -> tuple[F64, Integers]:
    """Return the brightest shadings m with m·n_q ≤ v_q for all q, and m_z ≥ 0.

    Parameters
    ----------
    normals : (N, 3) unit, n_z > 0
    values : (N,) from 0 to about 1

    Returns
    -------
    shadings : (K, 3), among them for every normal between those given one that is brightest there
    tight : which of the values hold shadings down
    """
    places, heights = normals[:, :2] / normals[:, 2:], values / normals[:, 2]
    top = np.append(places.mean(axis=0), 2 * heights.max() + 1)
    hull = ConvexHull(np.vstack([np.column_stack([places, heights]), top]), qhull_options="Qt")
    below = hull.equations[:, 2] < -_LEVEL
    facets, planes = hull.simplices[below], hull.equations[below]
    below[below] = keep = (facets < len(normals)).all(axis=1)
    facets, planes = facets[keep], planes[keep]
    shadings = -planes[:, [0, 1, 3]] / planes[:, 2:3]
    tight = np.unique(facets).astype(np.int64)
    behind = shadings[:, 2] < -_BELOW
    if behind.any():
        level = _level_shadings(normals, values, facets, shadings)
        shadings = np.vstack([shadings[~behind], level])
    shadings[:, 2] = np.maximum(shadings[:, 2], 0)
    return np.unique(shadings, axis=0), tight


def _level_shadings(normals: F64, values: F64, facets: Integers, shadings: F64) -> F64:
    """Return the corners with m_z = 0: where edges between corners, and those that go on for ever, pass through it."""
    ends = np.sort(np.concatenate([facets[:, [0, 1]], facets[:, [1, 2]], facets[:, [2, 0]]]), axis=1)
    owner = np.tile(np.arange(len(facets)), 3)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    ends, owner = ends[order], owner[order]
    paired = np.append(np.all(ends[1:] == ends[:-1], axis=1), False)
    lone = ~paired & ~np.append(False, paired[:-1])
    one, other = shadings[owner[:-1][paired[:-1]]], shadings[owner[1:][paired[:-1]]]
    through = (one[:, 2] > 0) != (other[:, 2] > 0)
    one, other = one[through], other[through]
    share = one[:, 2:] / (one[:, 2:] - other[:, 2:])
    crossing = one + share * (other - one)
    start = shadings[owner[lone]]
    along = np.cross(normals[ends[lone, 0]], normals[ends[lone, 1]])
    falling = (start[:, 2] > 0) & (np.abs(along[:, 2]) > _BELOW)
    start, along = start[falling], along[falling]
    rays = start - along * (start[:, 2:] / along[:, 2:])
    found = np.vstack([crossing, rays, np.zeros((1, 3))])
    found[:, 2] = 0
    return found[(found @ normals.T <= values + _FEASIBLE).all(axis=1)]
