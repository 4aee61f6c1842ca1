"""The sum of squared differences at all places at once: Σ m·S² − 2·corr(S, m·T) + Σ m·T², by Fourier transforms.

What the transforms give is off by their rounding, which is bounded. Whatever the bound leaves open is measured exactly,
so that the blocks found are those of brute force.
"""

import os
from collections import OrderedDict
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel
from processing.ptm.synthesis.search.correlate import Correlator, Pieces
from processing.ptm.synthesis.search.problem import Candidates, Rule, Source, Target

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
_KEPT_NORMS = 32
_CHUNK = 256


class _Norms(NamedTuple):
    """Σ m·S² of every block, in pieces (N, valid, valid), inf where none is allowed; and the largest of them."""

    pieces: F32
    largest: float


class _Correlated:
    """A source with its spectra, and the norms of its blocks' neighbourhoods."""

    def __init__(self, source: Source, block_px: int, allowed: NDArray[np.bool_], first_id: int) -> None:
        both = np.concatenate([source.texture, source.guide], axis=2)
        self.correlator = Correlator(both, block_px)
        self.first_id = first_id
        # Norms are differences of large numbers in float32, and are made once a neighbourhood: so in float64.
        self._texture_squares = Correlator(np.square(source.texture, dtype=np.float64).sum(2)[..., None], block_px)
        self._guide_norms: F64 | float = 0.0
        if source.guide.shape[2]:
            squares = Correlator(np.square(source.guide, dtype=np.float64).sum(2)[..., None], block_px)
            self._guide_norms = np.asarray(squares.plane(np.ones((block_px, block_px, 1))))
        pieces = self.correlator.pieces
        self.room = self.correlator.room()
        self.distances = np.zeros((len(self.room), pieces.valid, pieces.valid), np.float32)
        self._closed = ~allowed.reshape(self.correlator.pieces.shape)
        self._kept: OrderedDict[bytes, _Norms] = OrderedDict()

    def norms(self, known: NDArray[np.bool_]) -> _Norms:
        """Return the norms for a neighbourhood, and those of the guide all over the block, summed."""
        key = known.tobytes()
        if key not in self._kept:
            norms = np.asarray(self._texture_squares.plane(known[..., None].astype(np.float64))) + self._guide_norms
            largest = float(norms.max())
            norms[self._closed] = np.inf
            pieces = self.correlator.pieces
            whole = np.full([part * pieces.valid for part in pieces.grid], np.inf, np.float32)
            whole[: norms.shape[0], : norms.shape[1]] = norms
            self._kept[key] = _Norms(pieces.cut(whole, pieces.valid).astype(np.float32), largest)
            if len(self._kept) > _KEPT_NORMS:
                self._kept.popitem(last=False)
        return self._kept[key]


class FourierSearch:
    """Finds all distances by the fast Fourier transform; one search at a time, for its memory is used again."""

    def __init__(self, candidates: Candidates) -> None:
        self._candidates = candidates
        allowed, starts = candidates.allowed, candidates.starts
        self._sources = [
            _Correlated(source, candidates.block_px, allowed[start:end], int(start))
            for source, start, end in zip(candidates.sources, starts[:-1], starts[1:], strict=True)
        ]
        self._workers = ThreadPoolExecutor(os.cpu_count())

    def matches(self, target: Target, rule: Rule) -> I64:
        """See `Search`."""
        pattern = np.concatenate([np.where(target.known[..., None], target.values, 0), target.guide], axis=2)
        found = [self._distances(source, target, pattern) for source in self._sources]
        # Distances lack the pattern's own norm, which is the same for all.
        own = float(np.square(pattern, dtype=np.float64).sum())
        error = max(one.error for one in found) + 4 * float(np.finfo(np.float32).eps) * own
        lowest = min(one.lowest() for one in found)
        nearest = np.concatenate([one.below(lowest + 2 * error)[0] for one in found])
        best = self._best(nearest, target)
        limit = rule.threshold(best, target.known)
        maybe, distances = (
            np.concatenate(parts) for parts in zip(*(one.below(limit - own + error) for one in found), strict=True)
        )
        order = np.argsort(maybe)
        maybe, good = maybe[order], distances[order] <= limit - own - error
        good[~good] = self._candidates.distances(maybe[~good], target, limit) <= limit
        return maybe[good]

    def _best(self, ids: I64, target: Target) -> float:
        """Measure the smallest distance exactly. Nothing is nearer than a copy, of which there may be very many."""
        ids, best = np.sort(ids), np.inf
        for start in range(0, len(ids), _CHUNK):
            best = min(best, float(self._candidates.distances(ids[start : start + _CHUNK], target, best).min()))
            if best == 0:
                break
        return best

    def _distances(self, source: _Correlated, target: Target, pattern: F32) -> "_Distances":
        norms = source.norms(target.known)
        spectrum = source.correlator.spectrum(pattern)
        distances, room = source.distances, source.room
        share = -(-len(distances) // (os.cpu_count() or 1))

        def work(start: int) -> None:
            pieces = slice(start, start + share)
            _subtract_twice(
                norms.pieces[pieces], source.correlator.correlate(spectrum, pieces, room), distances[pieces]
            )

        first, *others = range(0, len(distances), share)
        elsewhere = [self._workers.submit(work, start) for start in others]
        work(first)
        for one in elsewhere:
            one.result()
        error = 2 * source.correlator.error(pattern) + 4 * float(np.finfo(np.float32).eps) * norms.largest
        found = _Distances(source.correlator.pieces, source.first_id, distances, error)
        found.close(target.banned)
        return found


class _Distances(NamedTuple):
    """Distances in pieces, asked by the candidates' numbers.

    Attributes
    ----------
    pieces : how they are cut
    first_id : number of the source's first candidate
    values : (N, valid, valid)
    error : bound of their error
    """

    pieces: Pieces
    first_id: int
    values: F32
    error: float

    def close(self, banned: I64) -> None:
        """Put candidates out of reach."""
        height, width = self.pieces.shape
        mine = banned[(banned >= self.first_id) & (banned < self.first_id + height * width)] - self.first_id
        rows, columns = np.divmod(mine, width)
        (piece_row, y), (piece_column, x) = np.divmod(rows, self.pieces.valid), np.divmod(columns, self.pieces.valid)
        self.values[piece_row * self.pieces.grid[1] + piece_column, y, x] = np.inf

    def lowest(self) -> float:
        return float(self.values.min())

    def below(self, limit: float) -> tuple[I64, F32]:
        """Return numbers and distances of those within a limit."""
        flat = np.flatnonzero(self.values <= limit)
        return self.pieces.locate(flat) + self.first_id, self.values.ravel()[flat]


@kernel
def _subtract_twice(norms: F32, correlation: F32, distances: F32) -> None:
    """Make Σ m·S² − 2·corr(S, m·T)."""
    for n in range(norms.shape[0]):
        for y in range(norms.shape[1]):
            for x in range(norms.shape[2]):
                distances[n, y, x] = norms[n, y, x] - np.float32(2) * correlation[n, y, x]
