"""The paper's search: neighbourhoods are rejected by what a few projections say of their distance (section VII).

For orthonormal vectors U the distance of two neighbourhoods is at least Σ (U·N₁ − U·N₂)² (equation 2). What lies
outside their span adds at least (‖r₁‖ − ‖r₂‖)², r the rests, whose norms are known from the neighbourhoods' own.
Projections come from Fourier transforms in float32; every bound is lowered by their rounding, so that no block is lost.
"""

import math
from collections import OrderedDict
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from litrig.base.kernels import kernel
from processing.ptm.synthesis.search.correlate import Correlator
from processing.ptm.synthesis.search.kernels import KernelKind, rejection_kernels
from processing.ptm.synthesis.search.problem import Candidates, Rule, Target

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

_SAMPLE = 400
_KEPT = 32
_FEW = 64
"""So few candidates are measured rather than projected on."""


@dataclass
class Tally:
    """How many neighbourhoods were left after each projection, over all searches.

    Attributes
    ----------
    searches, candidates : searches, and neighbourhoods at their starts
    left : after the first, the second … projection
    measured : whose distance was measured in the end
    """

    searches: int = 0
    candidates: int = 0
    left: list[int] = field(default_factory=list)
    measured: int = 0

    def rejected(self, projections: int) -> float:
        """Return the share rejected by so many projections."""
        if not self.candidates or not self.left:
            return 0.0
        return 1 - self.left[min(projections, len(self.left)) - 1] / self.candidates


@dataclass(frozen=True)
class _Prepared:
    """What a shape of neighbourhood needs.

    Attributes
    ----------
    kernels : (k, B, B, K)
    projections : (k, N) of all candidates
    norms : (N,) ‖N_W‖², float32
    error : largest error of a projection
    """

    kernels: F64
    projections: F32
    norms: F32
    error: float

    def rest_slack(self, projections: int) -> float:
        """Bound the error of ‖N‖² − Σ (U·N)² over so many projections."""
        largest = float(self.norms.max(initial=0))
        return 2 * self.error * math.sqrt(projections * largest) + projections * self.error**2 + 1e-5 * largest


class RejectionSearch:
    """Projects neighbourhoods on vectors that hold most of their energy, one after the other, and rejects."""

    def __init__(
        self, candidates: Candidates, kind: KernelKind = "svd", count: int = 32, *, bound_rests: bool = True
    ) -> None:
        """Transform the sources.

        Parameters
        ----------
        count : of vectors
        bound_rests : add the bound of what lies outside their span; the paper does not
        """
        self._candidates, self._kind, self._count, self._bound_rests = candidates, kind, count, bound_rests
        self._correlators = [Correlator(source.texture, candidates.block_px) for source in candidates.sources]
        self._squares = [
            Correlator(np.square(source.texture, dtype=np.float64).sum(2)[..., None], candidates.block_px)
            for source in candidates.sources
        ]
        self._kept: OrderedDict[bytes, _Prepared] = OrderedDict()
        self.tally = Tally()

    def matches(self, target: Target, rule: Rule) -> I64:
        """See `Search`."""
        prepared = self._prepare(target.known)
        values = np.where(target.known[..., None], target.values, 0).astype(np.float64)
        wanted = np.einsum("kijl,ijl->k", prepared.kernels, values)
        rest = float(np.square(values).sum())
        ids = np.setdiff1d(self._candidates.allowed_ids, target.banned, assume_unique=True)
        left = _Left(ids, np.zeros(len(ids)), prepared.norms[ids].astype(np.float64), np.zeros(len(ids)))
        self._count_search(len(ids), len(wanted))
        best, found = np.inf, len(ids)
        for index, projections in enumerate(prepared.projections):
            if found > _FEW:
                rest -= float(wanted[index]) ** 2
                slack = prepared.rest_slack(index + 1) if self._bound_rests else np.inf
                likeliest = _project(*left, found, projections, float(wanted[index]), prepared.error, rest, slack)
                nearest = left.ids[likeliest : likeliest + 1]
                best = min(best, float(self._candidates.distances(nearest, target, best)[0]))
                found = _keep(*left, found, rule.threshold(best, target.known))
            self.tally.left[index] += found
        self.tally.measured += found
        kept = left.ids[:found]
        distances = self._candidates.distances(kept, target, rule.threshold(best, target.known))
        return np.asarray(kept[distances <= rule.threshold(float(distances.min()), target.known)], np.int64)

    def _count_search(self, candidates: int, projections: int) -> None:
        self.tally.searches += 1
        self.tally.candidates += candidates
        while len(self.tally.left) < projections:
            self.tally.left.append(0)

    def _prepare(self, known: NDArray[np.bool_]) -> _Prepared:
        key = known.tobytes()
        if key not in self._kept:
            # Matrices are small, and threads that wait for each other cost more than they save.
            with threadpool_limits(1, user_api="blas"):
                kernels = rejection_kernels(self._kind, self._sample(known), known, self._count).astype(np.float32)
            projections = [
                np.concatenate([np.ravel(correlator.plane(one)) for correlator in self._correlators]) for one in kernels
            ]
            norms = [np.ravel(squares.plane(known[..., None].astype(np.float64))) for squares in self._squares]
            errors = [correlator.error(one) for one in kernels for correlator in self._correlators]
            self._kept[key] = _Prepared(
                kernels.astype(np.float64),
                np.asarray(projections, np.float32).reshape(len(kernels), len(self._candidates.allowed)),
                np.concatenate(norms).astype(np.float32),
                max(errors, default=0.0),
            )
            if len(self._kept) > _KEPT:
                self._kept.popitem(last=False)
        return self._kept[key]

    def _sample(self, known: NDArray[np.bool_]) -> F64:
        """Take neighbourhoods from all over."""
        ids = self._candidates.allowed_ids
        chosen = ids[np.random.default_rng(0).permutation(len(ids))[:_SAMPLE]]
        rows, columns = np.nonzero(known)
        sample = []
        for number in chosen:
            source, y, x = self._candidates.place(int(number))
            sample.append(self._candidates.sources[source].texture[y + rows, x + columns])
        return np.asarray(sample, np.float64)


class _Left(NamedTuple):
    """What is not rejected, at the start of arrays (N,).

    Attributes
    ----------
    ids : candidates
    sums : Σ (U·N₁ − U·N₂)² so far
    rests : ‖r‖², the norm outside the span so far
    bounds : the lower bound of the distance
    """

    ids: I64
    sums: F64
    rests: F64
    bounds: F64


@kernel
def _project(
    ids: I64,
    sums: F64,
    rests: F64,
    bounds: F64,
    found: int,
    projections: F32,
    wanted: float,
    error: float,
    rest: float,
    slack: float,
) -> int:
    """Raise the bounds by one projection, and return where the lowest is."""
    likeliest = 0
    most, least = np.sqrt(max(rest + slack, 0.0)), np.sqrt(max(rest - slack, 0.0))
    for n in range(found):
        projection = np.float64(projections[ids[n]])
        apart = max(abs(projection - wanted) - error, 0.0)
        sums[n] += apart * apart
        bound = sums[n]
        if slack < np.inf:
            rests[n] -= projection * projection
            outside = max(np.sqrt(max(rests[n] - slack, 0.0)) - most, least - np.sqrt(max(rests[n] + slack, 0.0)), 0.0)
            bound += outside * outside
        # The kernels are orthonormal but for the rounding of float32.
        bounds[n] = bound * (1 - 1e-5)
        if bounds[n] < bounds[likeliest]:
            likeliest = n
    return likeliest


@kernel
def _keep(ids: I64, sums: F64, rests: F64, bounds: F64, found: int, limit: float) -> int:
    """Move those whose bound is within the limit to the front, in their order, and count them."""
    kept = 0
    for n in range(found):
        if bounds[n] <= limit:
            ids[kept], sums[kept], rests[kept], bounds[kept] = ids[n], sums[n], rests[n], bounds[n]
            kept += 1
    return kept
