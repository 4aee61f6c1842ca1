"""The change to a basis in which distances of vectors are distances of functions."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.ptm.basis import PTM, Basis
from processing.ptm.synthesis.orthonormal import check_domain, orthonormal

ROOT = np.sqrt(45)
PAPER = np.array(
    [
        [2 / 3, 2 / 3, 0, 0, 0, 2],
        [0, 0, 0, 2 / np.sqrt(3), 0, 0],
        [0, 0, 0, 0, 2 / np.sqrt(3), 0],
        [0, 0, 2 / 3, 0, 0, 0],
        [4 / ROOT, 0, 0, 0, 0, 0],
        [0, 4 / ROOT, 0, 0, 0, 0],
    ]
)
"""b = M·a, worked out by hand from the paper's B and A (section VI)."""


def test_over_the_square_it_is_the_papers_matrix() -> None:
    np.testing.assert_allclose(orthonormal(PTM, "square").matrix, PAPER, atol=1e-12)


@given(st.lists(st.floats(-2, 2), min_size=12, max_size=12), st.sampled_from(["square", "disc"]))
@settings(max_examples=25, deadline=None)
def test_distances_of_vectors_are_distances_of_functions(numbers: list[float], domain: str) -> None:
    first, second = np.reshape(numbers, (2, 6))
    change = orthonormal(PTM, domain)  # type: ignore[arg-type]
    vectors = float(np.sum(np.square(change.matrix @ first - change.matrix @ second)))
    lights, weights = square_rule() if domain == "square" else disc_rule()
    functions = float(weights @ np.square(PTM.evaluate(lights) @ (first - second)))
    assert vectors == pytest.approx(functions, rel=1e-9, abs=1e-9)


def square_rule() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    nodes, weights = np.polynomial.legendre.leggauss(8)
    return np.stack(np.meshgrid(nodes, nodes), -1).reshape(-1, 2), np.outer(weights, weights).ravel()


def disc_rule() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The mean over the disc: nodes in the square of the radius, and even angles."""
    nodes, weights = np.polynomial.legendre.leggauss(8)
    radius, angle = np.sqrt((nodes + 1) / 2)[:, None], 2 * np.pi * np.arange(16) / 16
    lights = np.stack([radius * np.cos(angle), radius * np.sin(angle)], -1).reshape(-1, 2)
    return lights, np.repeat(weights / 2 / 16, 16)


@pytest.mark.parametrize(
    ("basis", "domain"),
    [
        (PTM, "square"),
        (PTM, "disc"),
        (Basis("ptm", 3), "square"),
        (Basis("hsh", 9), "disc"),
        (Basis("hsh", 4), "hemisphere"),
    ],
    ids=str,
)
def test_back_is_the_way_back(basis: Basis, domain: str) -> None:
    change = orthonormal(basis, domain)  # type: ignore[arg-type]
    coefficients = np.random.default_rng(3).standard_normal((basis.terms, 5, 7)).astype(np.float32)
    np.testing.assert_allclose(change.back(change.forward(coefficients)), coefficients, atol=2e-5)


def test_harmonics_are_not_compared_over_a_square() -> None:
    with pytest.raises(InputError, match=r"x\.rti: a HSH of 4 terms is compared over hemisphere or disc, not square"):
        check_domain(Basis("hsh", 4), "square", "x.rti")
