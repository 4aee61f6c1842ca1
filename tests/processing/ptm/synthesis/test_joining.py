"""How blocks are joined: cuts of least error, and ramps."""

from collections.abc import Callable
from itertools import pairwise, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from processing.ptm.synthesis.graph_cut import graph_cut_weight
from processing.ptm.synthesis.joining import cut_weight, least_path, new_weight
from processing.ptm.synthesis.layout import Edges


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=30, deadline=None)
def test_no_path_through_an_overlap_costs_less(seed: int) -> None:
    error = np.random.default_rng(seed).random((5, 3))
    path = least_path(error)
    steps = [one for one in product(range(3), repeat=5) if all(abs(a - b) < 2 for a, b in pairwise(one))]
    assert error[range(5), path].sum() == pytest.approx(min(error[range(5), one].sum() for one in steps))
    assert tuple(path) in steps


Turn = Callable[[NDArray[np.floating]], NDArray[np.floating]]
TURNS: dict[str, Turn] = {
    "left": lambda values: values,
    "right": lambda values: values[:, ::-1],
    "top": lambda values: values.T,
    "bottom": lambda values: values.T[::-1],
}
BACK: dict[str, Turn] = {**TURNS, "bottom": lambda values: values[::-1].T}


@pytest.mark.parametrize("side", TURNS)
def test_a_cut_runs_where_old_and_new_are_alike(side: str) -> None:
    error = np.ones((9, 9))
    error[:, 2] = 0  # a lane in the overlap, when that is on the left
    weight = BACK[side](cut_weight(np.ascontiguousarray(TURNS[side](error)), Edges(**{side: 4})))
    assert not weight[:, :2].any()
    assert weight[:, 2:].all()


def test_a_block_without_neighbours_is_taken_whole() -> None:
    assert cut_weight(np.ones((6, 6)), Edges()).all()


def test_a_blend_rises_evenly_across_the_overlap() -> None:
    old, new = np.zeros((12, 12, 1), np.float32), np.ones((12, 12, 1), np.float32)
    weight = new_weight("blend", old, new, 1, Edges(left=3, bottom=2))
    np.testing.assert_allclose(weight[2], [0.25, 0.5, 0.75, *[1] * 9])
    np.testing.assert_allclose(weight[:, 6], [*[1] * 10, 2 / 3, 1 / 3])
    np.testing.assert_allclose(weight[-1, 0], 0.25)


def test_a_graph_is_cut_where_it_costs_least() -> None:
    y, x = np.mgrid[:11, :11] - 5
    distance = np.maximum(np.abs(y), np.abs(x))
    error = np.where((distance == 3) | (distance == 4), 0, 50.0)  # a lane, between whose halves it costs nothing
    weight = graph_cut_weight(error, np.ones((11, 11), bool), distance == 5, distance == 0)
    np.testing.assert_array_equal(weight, distance <= 3)


def test_what_is_unknown_costs_nothing_itself() -> None:
    known = np.ones((6, 6), bool)
    known[:, 4:] = False
    error = np.full((6, 6), 1e6)
    error[:, 2] = 1.0
    keeps_old = np.zeros((6, 6), bool)
    keeps_old[:, 0] = True
    weight = graph_cut_weight(np.where(known, error, 1e9), known, keeps_old, ~known)
    assert not weight[:, :2].any()
    assert weight[:, 3:].all()
