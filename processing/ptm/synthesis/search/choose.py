"""Strategies by name."""

from processing.ptm.synthesis.search.brute import BruteForce
from processing.ptm.synthesis.search.fourier import FourierSearch
from processing.ptm.synthesis.search.problem import Candidates, Search
from processing.ptm.synthesis.search.rejection import RejectionSearch
from processing.ptm.synthesis.settings import SearchKind


def make_search(kind: SearchKind, candidates: Candidates) -> Search:
    """Prepare a strategy for the sources."""
    if kind == "fft":
        return FourierSearch(candidates)
    if kind == "brute":
        return BruteForce(candidates)
    return RejectionSearch(candidates, kind)
