"""Every strategy finds all good blocks and no other."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from processing.ptm.synthesis.layout import Edges, known_part
from processing.ptm.synthesis.search.choose import make_search
from processing.ptm.synthesis.search.correlate import Correlator
from processing.ptm.synthesis.search.kernels import KERNEL_KINDS, KernelKind, rejection_kernels
from processing.ptm.synthesis.search.problem import NO_IDS, Candidates, Rule, Source, Target
from processing.ptm.synthesis.search.rejection import RejectionSearch
from processing.ptm.synthesis.settings import SearchKind

F32 = NDArray[np.float32]
BLOCK = 8
EDGES = [Edges(left=3), Edges(top=3), Edges(3, 3), Edges(2, 3, 2, 3)]
STRATEGIES: tuple[SearchKind, ...] = ("brute", "fft", *KERNEL_KINDS)


def texture(random: np.random.Generator, height: int, width: int, planes: int = 3) -> F32:
    return random.standard_normal((height, width, planes)).astype(np.float32)


def source(values: F32, guide: F32 | None = None, allowed: NDArray[np.bool_] | None = None) -> Source:
    return Source(values, np.zeros((*values.shape[:2], 0), np.float32) if guide is None else guide, allowed)


def target(values: F32, edges: Edges, guide: F32 | None = None, banned: NDArray[np.int64] = NO_IDS) -> Target:
    no_guide = np.zeros((BLOCK, BLOCK, 0), np.float32)
    return Target(values, known_part(edges, BLOCK), no_guide if guide is None else guide, banned)


def all_distances(sources: list[Source], wanted: Target) -> NDArray[np.float64]:
    """Distances of every block, by NumPy alone."""
    parts = []
    for one in sources:
        windows = sliding_window_view(one.texture.astype(np.float64), (BLOCK, BLOCK), axis=(0, 1))
        difference = (np.moveaxis(windows, 2, -1) - wanted.values)[:, :, wanted.known]
        distances = np.square(difference).sum(axis=(2, 3))
        if one.guide.shape[2]:
            windows = sliding_window_view(one.guide.astype(np.float64), (BLOCK, BLOCK), axis=(0, 1))
            distances += np.square(np.moveaxis(windows, 2, -1) - wanted.guide).sum(axis=(2, 3, 4))
        if one.allowed is not None:
            distances[~one.allowed] = np.inf
        parts.append(distances.ravel())
    result = np.concatenate(parts)
    result[wanted.banned] = np.inf
    return result


def good(sources: list[Source], wanted: Target, tolerance: float, delta: float) -> NDArray[np.int64]:
    distances = all_distances(sources, wanted)
    return np.flatnonzero(distances <= max((1 + tolerance) * distances.min(), delta * wanted.known.sum()))


@pytest.mark.parametrize("edges", EDGES, ids=str)
@pytest.mark.parametrize("kind", STRATEGIES)
def test_a_strategy_finds_the_good_blocks_of_several_sources(kind: SearchKind, edges: Edges) -> None:
    random = np.random.default_rng(4)
    sources = [source(texture(random, 40, 31)), source(texture(random, 9, 60)), source(texture(random, 8, 8))]
    search = make_search(kind, Candidates(sources, BLOCK))
    for values in (texture(random, BLOCK, BLOCK), sources[0].texture[7:15, 11:19], sources[1].texture[1:9, 52:60]):
        for tolerance, delta in ((0.0, 0.0), (0.1, 0.0), (1.0, 0.0), (0.0, 4.0)):
            found = search.matches(target(values, edges), Rule(tolerance, delta))
            np.testing.assert_array_equal(found, good(sources, target(values, edges), tolerance, delta))


@pytest.mark.parametrize("kind", STRATEGIES)
def test_guides_bans_and_closed_blocks_count(kind: SearchKind) -> None:
    random = np.random.default_rng(5)
    allowed = random.random((23, 23)) < 0.7
    sources = [source(texture(random, 30, 30), texture(random, 30, 30, 1), allowed)]
    sources.append(source(texture(random, 20, 20), texture(random, 20, 20, 1)))
    search = make_search(kind, Candidates(sources, BLOCK))
    for edges in EDGES:
        free = target(texture(random, BLOCK, BLOCK), edges, texture(random, BLOCK, BLOCK, 1))
        first = good(sources, free, 0.2, 0.0)
        np.testing.assert_array_equal(search.matches(free, Rule(0.2, 0.0)), first)
        banned = target(free.values, edges, free.guide, first)
        second = search.matches(banned, Rule(0.2, 0.0))
        np.testing.assert_array_equal(second, good(sources, banned, 0.2, 0.0))
        assert not np.intersect1d(first, second).size


@pytest.mark.parametrize("kind", STRATEGIES)
def test_a_flat_source_ties_everywhere(kind: SearchKind) -> None:
    sources = [source(np.zeros((40, 40, 2), np.float32))]
    search = make_search(kind, Candidates(sources, BLOCK))
    wanted = target(np.zeros((BLOCK, BLOCK, 2), np.float32), Edges(3, 3))
    assert len(search.matches(wanted, Rule(0.0, 0.0))) == 33 * 33
    assert len(search.matches(wanted, Rule(0.1, 1e-6))) == 33 * 33


@pytest.mark.parametrize("kind", STRATEGIES)
def test_a_copy_is_found_with_no_tolerance_at_all(kind: SearchKind) -> None:
    """A threshold of zero must not reject what only rounding holds apart."""
    random = np.random.default_rng(6)
    sources = [source(texture(random, 50, 50, 6) + 30)]
    search = make_search(kind, Candidates(sources, BLOCK))
    found = search.matches(target(sources[0].texture[20:28, 30:38], Edges(3, 3)), Rule(0.0, 0.0))
    np.testing.assert_array_equal(found, [20 * 43 + 30])


@given(st.integers(0, 2**32 - 1), st.integers(1, 3), st.sampled_from(EDGES))
@settings(max_examples=20, deadline=None)
def test_near_ties_are_told_apart_exactly(seed: int, levels: int, edges: Edges) -> None:
    """Few levels give many blocks at the same distance, and a last bit moves some of them aside."""
    random = np.random.default_rng(seed)
    values = random.integers(0, levels + 1, (30, 34, 2)).astype(np.float32)
    values[:, 17:] = np.nextafter(values[:, 17:], np.float32(9))
    sources = [source(values)]
    wanted = target(random.integers(0, levels + 1, (BLOCK, BLOCK, 2)).astype(np.float32), edges)
    expected = BruteForceOf(sources).matches(wanted)
    for kind in ("fft", "svd", "walsh"):
        np.testing.assert_array_equal(
            make_search(kind, Candidates(sources, BLOCK)).matches(wanted, Rule(0, 0)), expected
        )


class BruteForceOf:
    def __init__(self, sources: list[Source]) -> None:
        self._search = make_search("brute", Candidates(sources, BLOCK))

    def matches(self, wanted: Target) -> NDArray[np.int64]:
        return self._search.matches(wanted, Rule(0, 0))


@pytest.mark.parametrize("shape", [(8, 8), (9, 200), (70, 65), (101, 33)], ids=str)
def test_correlation_in_pieces_is_within_its_bound(shape: tuple[int, int]) -> None:
    random = np.random.default_rng(7)
    values, pattern = texture(random, *shape, 4) + 5, texture(random, BLOCK, BLOCK, 4)
    correlator = Correlator(values, BLOCK)
    windows = sliding_window_view(values.astype(np.float64), (BLOCK, BLOCK), axis=(0, 1))
    truth = np.einsum("yxkij,ijk->yx", windows, pattern.astype(np.float64))
    error = np.abs(correlator.plane(pattern) - truth).max()
    assert error <= correlator.error(pattern) < 0.02 * np.abs(truth).max()


@pytest.mark.parametrize("kind", KERNEL_KINDS)
def test_kernels_are_orthonormal_within_the_neighbourhood(kind: KernelKind) -> None:
    known = known_part(Edges(3, 3), 15)
    sample = np.random.default_rng(8).standard_normal((200, int(known.sum()), 2))
    kernels = rejection_kernels(kind, sample, known, 12)
    assert kernels.shape == (12, 15, 15, 2)
    assert not kernels[:, ~known].any()
    flat = kernels.reshape(12, -1)
    np.testing.assert_allclose(flat @ flat.T, np.eye(12), atol=1e-9)


def test_rests_reject_more_than_projections_alone() -> None:
    random = np.random.default_rng(9)
    values = np.cumsum(texture(random, 60, 60), axis=1)
    candidates = Candidates([source(values)], BLOCK)
    plain, bounded = (RejectionSearch(candidates, "svd", 6, bound_rests=rests) for rests in (False, True))
    for y, x in random.integers(0, 52, (20, 2)):
        wanted = target(values[y : y + BLOCK, x : x + BLOCK] + 0.5 * texture(random, BLOCK, BLOCK), Edges(3, 3))
        np.testing.assert_array_equal(plain.matches(wanted, Rule(0.1, 0)), bounded.matches(wanted, Rule(0.1, 0)))
    assert bounded.tally.searches == 20
    assert bounded.tally.left[0] < plain.tally.left[0]
    assert bounded.tally.left[1] < plain.tally.left[1]
    assert 0 < plain.tally.rejected(1) <= plain.tally.rejected(2) <= plain.tally.rejected(6) < 1
