"""The search that looks at everything: the truth for the others, and what the paper calls brute force."""

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from processing.ptm.synthesis.search.problem import Candidates, Rule, Target

I64 = NDArray[np.int64]


class BruteForce:
    """Measures the distance to every block."""

    def __init__(self, candidates: Candidates) -> None:
        self._candidates = candidates
        self._workers = ThreadPoolExecutor(os.cpu_count())

    def matches(self, target: Target, rule: Rule) -> I64:
        """See `Search`."""
        ids = np.setdiff1d(self._candidates.allowed_ids, target.banned, assume_unique=True)
        parts = np.array_split(ids, os.cpu_count() or 1)
        distances = np.concatenate(
            list(self._workers.map(lambda part: self._candidates.distances(part, target), parts))
        )
        limit = rule.threshold(float(distances.min()), target.known)
        return np.asarray(ids[distances <= limit], np.int64)
