import numpy as np
import pytest

from litrig.base.errors import InputError
from processing.shape.diffuse.fit import DiffuseOptions, Method, fit_diffuse, spread_directions
from processing.shape.diffuse.hot_pixels import hot_pixels
from processing.shape.harmonics import evaluate
from tests.processing.shape.diffuse.shadings import surface, truth


@pytest.mark.parametrize("method", ["qp", "ls"])
def test_shading_without_occlusion_gives_its_harmonics_back(method: Method) -> None:
    normals, shading = surface(2)
    found = fit_diffuse(normals, shading, DiffuseOptions(method))
    np.testing.assert_allclose(found.coefficients, truth(2), atol=1e-5)
    assert found.remarks == ()


def test_occlusion_shows_as_negative_residuals_and_least_squares_has_both() -> None:
    normals, shading = surface(7)
    values = evaluate(normals)
    above = fit_diffuse(normals, shading)
    assert (shading - values @ above.coefficients.astype(np.float64)).max() <= 0
    np.testing.assert_allclose(above.coefficients, truth(7), atol=0.02)
    among = fit_diffuse(normals, shading, DiffuseOptions("ls"))
    assert (shading - values @ among.coefficients).max() > 0.05


def test_what_is_stored_in_single_precision_lies_under_no_pixel() -> None:
    for case in (1, 10, 15):
        normals, shading = surface(case)
        stored = fit_diffuse(normals, shading).coefficients
        assert stored.dtype == np.float32
        assert (shading - evaluate(normals) @ stored.astype(np.float64)).max() <= 1e-10


def test_a_ridge_keeps_what_no_normal_tells_small() -> None:
    normals, shading = surface(0)
    free, tamed = (fit_diffuse(normals, shading, DiffuseOptions(ridge=ridge)) for ridge in (0.0, 1e-3))
    everywhere = evaluate(spread_directions(500))
    assert np.abs(everywhere @ tamed.coefficients).max() < 5 < np.abs(everywhere @ free.coefficients).max()
    assert "ridge" in free.remarks[0]
    assert not any("ridge" in remark for remark in tamed.remarks)
    assert (shading - evaluate(normals) @ tamed.coefficients.astype(np.float64)).max() <= 1e-10


def test_negative_light_is_told_and_can_be_forbidden() -> None:
    """A cap as bright as its height: the harmonics go on below zero on the other side."""
    directions = spread_directions(20000)
    normals = directions[directions[:, 2] > 0.2].astype(np.float32)
    shading = np.repeat(normals[:, 2:], 3, axis=1)
    plain = fit_diffuse(normals, shading)
    assert "negative in" in plain.remarks[0]
    bounded = fit_diffuse(normals, shading, DiffuseOptions(never_negative=True, ridge=1e-9))
    everywhere = evaluate(spread_directions(2000))
    assert (everywhere @ plain.coefficients).min() < -0.1
    assert (everywhere @ bounded.coefficients).min() > -1e-6
    assert bounded.remarks == ()


def test_one_pixel_gives_its_own_light_there() -> None:
    normal = np.array([[0, 0.6, 0.8]], np.float32)
    found = fit_diffuse(normal, np.array([[1, 2, 3]], np.float32))
    np.testing.assert_allclose(evaluate(normal) @ found.coefficients, [[1, 2, 3]], rtol=1e-6)


@pytest.mark.parametrize(
    ("normals", "shading", "reason"),
    [
        (np.zeros((0, 3)), np.zeros((0, 3)), "no pixel"),
        (np.ones((4, 3)), np.full((4, 3), np.nan), "no finite numbers"),
        (np.full((4, 3), np.inf), np.ones((4, 3)), "no finite numbers"),
    ],
    ids=["none", "NaN", "infinite"],
)
def test_what_cannot_be_fitted_is_refused(normals: np.ndarray, shading: np.ndarray, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        fit_diffuse(normals.astype(np.float32), shading.astype(np.float32))


def test_options_that_mean_nothing_are_refused() -> None:
    with pytest.raises(InputError, match="ridge of nan"):
        DiffuseOptions(ridge=float("nan"))
    with pytest.raises(InputError, match="knows no bounds"):
        DiffuseOptions("ls", never_negative=True)


def test_single_hot_pixels_are_found_and_edges_are_not() -> None:
    rows, columns = np.indices((40, 50))
    shading = np.where(columns < 25, 0.2, 0.9)[..., None] * np.ones(3)
    shown = (rows - 20) ** 2 + (columns - 25) ** 2 < 300
    shading[10, 20, 1] = 1.5
    shading[20, 35:37] = 4.0
    shading[0, 0] = 50
    hot = hot_pixels(shading.astype(np.float32), shown, 1.5)
    assert set(zip(*np.nonzero(hot), strict=True)) == {(10, 20), (20, 35), (20, 36)}
