"""Beside the whole programme: every pixel a constraint at once."""

import numpy as np
import pytest
import quadprog
from numpy.typing import NDArray

from processing.shape.diffuse.quadratic import basis_of, fit_above
from processing.shape.harmonics import evaluate
from tests.processing.shape.diffuse.shadings import CASES, surface

F64 = NDArray[np.float64]


def all_at_once(values: F64, shading: NDArray[np.floating]) -> F64:
    """Fitted values; orthogonal columns instead of the normal equations, whose condition would cost the digits."""
    columns, _ = np.linalg.qr(values)
    columns *= np.sqrt(len(values))
    fitted = []
    for plane in shading.T.astype(np.float64):
        target = columns.T @ plane / len(values)
        fitted.append(columns @ quadprog.solve_qp(np.eye(9), target, columns.T.copy(), plane, 0, True)[0])
    return np.stack(fitted, axis=-1)


@pytest.mark.parametrize("case", CASES)
def test_few_constraints_give_what_all_at_once_give_and_no_pixel_is_violated(case: int) -> None:
    normals, shading = surface(case)
    found = evaluate(normals) @ fit_above(normals, shading, basis_of(normals, shading, 0))
    assert (shading - found).max() <= 1e-10
    np.testing.assert_allclose(found, all_at_once(evaluate(normals), shading), atol=1e-9, rtol=0)


@pytest.mark.parametrize("case", CASES[:8])
def test_least_squares_is_that_of_a_library(case: int) -> None:
    normals, shading = surface(case)
    values = evaluate(normals)
    expected = values @ np.linalg.lstsq(values, shading.astype(np.float64), rcond=None)[0]
    np.testing.assert_allclose(values @ basis_of(normals, shading, 0).least_squares, expected, atol=1e-9)


@pytest.mark.parametrize("scale", [1e-8, 1.0, 1e6])
def test_the_brightness_of_the_picture_does_not_matter(scale: float) -> None:
    normals, shading = surface(3)
    bright = (shading * np.float32(scale)).astype(np.float32)
    found = evaluate(normals) @ fit_above(normals, bright, basis_of(normals, bright, 0))
    assert (bright - found).max() <= 1e-10 * scale
    expected = evaluate(normals) @ fit_above(normals, shading, basis_of(normals, shading, 0))
    np.testing.assert_allclose(found / scale, expected, atol=1e-6)


def test_normals_that_leave_harmonics_untold_give_the_least_of_them() -> None:
    normals = np.array([[0, 0, 1]] * 5 + [[0, 0.6, 0.8]] * 5, np.float32)
    shading = np.arange(30, dtype=np.float32).reshape(10, 3)
    basis = basis_of(normals, shading, 0)
    assert basis.combined.shape == (9, 2)
    found = evaluate(normals) @ fit_above(normals, shading, basis)
    np.testing.assert_allclose(found[[0, 5]], [[12, 13, 14], [27, 28, 29]], rtol=1e-6)
