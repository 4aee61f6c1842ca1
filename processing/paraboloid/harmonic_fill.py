"""Fill what a dual paraboloid map does not know as smoothly as can be: by Laplace's equation on the sphere.

The map is conformal, so that the equation is the plain one on each half: a texel is the mean of its four neighbours,
those beyond the unit circle being read on the other half (`seam`). The Shape paper (section 3.2) solves the same
equation by finite elements on a tessellated sphere.
"""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from litrig.base.errors import InputError
from processing.paraboloid.direct import MOST_DIRECTLY, solve_directly
from processing.paraboloid.multigrid import Level, levels, solve
from processing.paraboloid.seam import F64, MARGIN, Floats, Grid, Mask, across, bordered, ghosts, map_grid

F32 = NDArray[np.float32]
TOLERANCE = 1e-6
"""Of the range of what is known; discretisation errs by more."""


def fill(
    front: Floats,
    back: Floats,
    known_front: Mask,
    known_back: Mask,
    source: tuple[Floats, Floats] | None = None,
    tolerance: float = TOLERANCE,
) -> tuple[F32, F32]:
    """Fill the unknown texels of a dual paraboloid map; the known ones within the unit circle keep their bits.

    Parameters
    ----------
    front, back : (S, S, C), as `maps`; whatever stands in unknown texels and beyond the circle is not looked at
    known_front, known_back : (S, S)
    source : (S, S, C) for front and back, the Laplacian on the unit sphere that the filled part shall have (Poisson's
        equation); none is Laplace's
    tolerance : change at which to stop, as a share of the range of what is known

    Returns
    -------
    front, back : (S, S, C) float32, with corners that go on across the seam

    Raises
    ------
    InputError
        Shapes contradict each other, nothing is known, what is known is no finite number, or a hole is so large and
        ragged that neither multigrid nor factors of its matrix fill it.
    """
    size, channels = _checked(front, back, known_front, known_back, source)
    grid = map_grid(size)
    within = grid.q() <= 1
    known = (bordered(known_front, known_back) > 0) & within
    if not known.any():
        raise InputError("environment map: nothing is known within the unit circle, and so nothing can be filled in")
    values = [np.where(known, bordered(front[..., c], back[..., c]), 0) for c in range(channels)]
    if not all(np.isfinite(plane).all() for plane in values):
        raise InputError("environment map: known texels hold no finite numbers; mark them unknown, or mend them")
    known = _with_rim(grid, known, values)
    grids = list(levels(grid, known))
    areas = (2 * grid.step / (1 + grid.q())) ** 2
    sources = [np.zeros(plane.shape) for plane in values]
    if source is not None:
        sources = [np.where(grids[0].free, bordered(*(s[..., c] for s in source)) * areas, 0) for c in range(channels)]
    # The loops let go of the interpreter's lock.
    with ThreadPoolExecutor(max_workers=2) as pool:
        jobs = [pool.submit(solve, grids, v, s, tolerance) for v, s in zip(values, sources, strict=True)]
        solved, changes = zip(*(job.result() for job in jobs), strict=True)
    if not max(changes) <= tolerance:
        solved = _otherwise(grids[0], solved, sources, max(changes))
    table, inner = ghosts(grid), slice(MARGIN, -MARGIN)
    for plane in solved:
        table.refresh(plane)
    whole = np.stack(solved, axis=-1)[:, inner, inner]
    filled = [
        np.where((mask & within[inner, inner])[..., None], given, one).astype(np.float32)
        for mask, given, one in zip((known_front, known_back), (front, back), whole, strict=True)
    ]
    return filled[0], filled[1]


def _otherwise(level: Level, values: Sequence[F64], sources: list[F64], change: float) -> list[F64]:
    """Solve what multigrid did not."""
    unknown = int(np.count_nonzero(level.free))
    if unknown > MOST_DIRECTLY:
        raise InputError(
            f"environment map: filling {unknown} texels still changes by {change:.1g} of what is known after many "
            "steps; take a smaller map"
        )
    return solve_directly(level, values, sources)


def _checked(
    front: Floats, back: Floats, known_front: Mask, known_back: Mask, source: tuple[Floats, Floats] | None
) -> tuple[int, int]:
    size, channels = front.shape[0], front.shape[-1]
    shapes = {plane.shape for plane in (front, back, *(source or ()))}
    if front.ndim != 3 or shapes != {(size, size, channels)} or {known_front.shape, known_back.shape} != {(size, size)}:
        raise InputError(
            f"environment map: halves of {front.shape} and {back.shape}, known by {known_front.shape} and "
            f"{known_back.shape}, do not fit; give squares of one size"
        )
    if known_front.dtype != np.bool_ or known_back.dtype != np.bool_:
        raise InputError("environment map: what is known is said by true and false; give boolean masks")
    return size, channels


def _with_rim(grid: Grid, known: Mask, values: list[F64]) -> Mask:
    """Read, in place, texels of the rim that the other half knows while they border on a hole in their own.

    Left free, they would let the hole reach beyond the circle, into what is known there.
    """
    within = np.broadcast_to(grid.q() <= 1, known.shape)
    unknown = within & ~known
    beside = np.zeros_like(unknown)
    beside[:, 1:-1, 1:-1] = unknown[:, :-2, 1:-1] | unknown[:, 2:, 1:-1] | unknown[:, 1:-1, :-2] | unknown[:, 1:-1, 2:]
    reads = across(grid, grid.own() & ~within[0])
    shares = np.sum(reads.weights * known.reshape(-1)[reads.sources], axis=1)
    # Where the hole itself crosses the seam, Laplace's equation across it is the better guess.
    doubtful = ndimage.binary_dilation(unknown, np.ones((1, 3, 3)), iterations=3)
    in_doubt = np.any(doubtful.reshape(-1)[reads.sources], axis=1)
    told = beside.reshape(-1)[reads.targets] & (shares > 0) & ~in_doubt
    targets, sources, weights = reads.targets[told], reads.sources[told], reads.weights[told] / shares[told, None]
    for plane in values:
        flat = plane.reshape(-1)
        flat[targets] = np.sum(weights * flat[sources], axis=1)
    whole = known.copy()
    whole.reshape(-1)[targets] = True
    return whole
