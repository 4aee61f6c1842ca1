"""Dividing an extended surface into regions that lie together in space."""

import numpy as np
from numpy.typing import NDArray
from scipy.cluster.vq import ClusterError, kmeans2

from litrig.base.errors import InputError

F32 = NDArray[np.float32]
_SAMPLE = 20_000
_OVERLAP = 0.5
_SEED = 0


def divide(positions: F32, count: int) -> tuple[F32, float]:
    """Find centres of regions by k-means, and how fast they go over into one another.

    Parameters
    ----------
    positions : (N, 3) of the surface's pixels

    Returns
    -------
    centres, falloff : (K, 3), and the standard deviation of the weights: half the way to the nearest other centre, on
        average

    Raises
    ------
    InputError
        The surface does not have so many places.
    """
    sample = positions[np.unique(np.linspace(0, len(positions) - 1, _SAMPLE).astype(np.int64))].astype(np.float64)
    scale = float(np.ptp(sample, axis=0).max())
    refusal = f"regions: the surface cannot be divided into {count} by its positions; ask for fewer"
    if not scale or len(np.unique(sample, axis=0)) < count:
        raise InputError(refusal)
    try:
        centres, _ = kmeans2((sample - sample[0]) / scale, count, minit="++", missing="raise", rng=_SEED)
    except ClusterError as error:
        raise InputError(refusal) from error
    apart = np.linalg.norm(centres[:, None] - centres, axis=-1) + np.diag(np.full(count, np.inf))
    falloff = _OVERLAP * float(apart.min(axis=1).mean()) * scale
    return (centres * scale + sample[0]).astype(np.float32), falloff
