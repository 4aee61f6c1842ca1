import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import linprog

from litrig.base.errors import InputError
from processing.matcap.disc import disc_normals
from processing.matcap.separation.known import Ignored
from processing.matcap.separation.separate import separate
from tests.processing.matcap.discs import glossy, hard_edged, lambert, noise

F64 = NDArray[np.float64]
ALL = Ignored(rim_px=0)


def opened_by_definition(values: F64, normals: F64) -> F64:
    """The paper's erosion and dilation, every pixel against every other."""
    cosines = normals @ normals.T
    near = cosines > 0
    with np.errstate(divide="ignore", invalid="ignore"):
        eroded = np.where(near, values / cosines, np.inf).min(axis=1)
    opened: F64 = np.where(near, eroded * cosines, 0).max(axis=1)
    return opened


@pytest.mark.parametrize("seed", range(20))
def test_the_discrete_form_is_erosion_and_dilation_over_all_pixels(seed: int) -> None:
    picture = noise(14 + seed, seed)
    normals, inside = disc_normals(len(picture))
    found = separate(picture, form="discrete", ignored=ALL)
    for channel in range(3):
        values = picture[inside][:, channel]
        wanted = opened_by_definition(values, normals[inside])
        np.testing.assert_allclose(found.low[inside][:, channel], wanted, rtol=1e-12, atol=0)


@pytest.mark.parametrize(
    ("light", "colour"),
    [
        pytest.param((0, 0.3, 1), (0.8, 0.8, 0.8), id="from above, with a black edge"),
        pytest.param((0, 0, 1), (0.9, 0.5, 0.2), id="from the front"),
        pytest.param((1, 0, 0), (0.2, 0.5, 0.9), id="half lit"),
        pytest.param((-0.9, 0.1, 0.01), (30.0, 5.0, 0.01), id="raking, brighter than white"),
    ],
)
@pytest.mark.parametrize("tolerance", [0, 1e-4])
def test_a_matt_ball_has_no_high_frequencies(
    light: tuple[float, float, float], colour: tuple[float, float, float], tolerance: float
) -> None:
    picture = lambert(100, light, colour)
    found = separate(picture, tolerance=tolerance)
    np.testing.assert_allclose(found.low, picture, rtol=0, atol=1e-9 * picture.max())


def test_a_matt_ball_keeps_its_brightness_next_to_160_black_pixels() -> None:
    light = np.array([0, 0.3, 1]) * 0.8 / np.linalg.norm([0, 0.3, 1])
    picture = lambert(100, (light[0], light[1], light[2]), (1, 1, 1))
    _, inside = disc_normals(100)
    assert np.count_nonzero(picture[inside][:, 0] == 0) >= 160
    assert separate(picture).low.max() == pytest.approx(picture.max(), abs=1e-12)
    assert separate(picture, form="discrete").low.max() < 0.9 * picture.max()


@pytest.mark.parametrize("seed", [0, 1, 2, 3, None])
def test_the_continuous_form_solves_the_linear_program_of_each_pixel(seed: int | None) -> None:
    picture = hard_edged(40).astype(np.float64) if seed is None else noise(40, seed)
    normals, inside = disc_normals(40)
    found = separate(picture, ignored=ALL, tolerance=0).low[inside][:, 0]
    values, n = picture[inside][:, 0], normals[inside]
    for pixel in np.random.default_rng(0).integers(0, len(values), 6):
        bounds = [(None, None), (None, None), (0, None)]
        wanted = -linprog(-n[pixel], A_ub=n, b_ub=values, bounds=bounds, method="highs").fun
        assert found[pixel] == pytest.approx(wanted, abs=2e-7)


def test_light_from_behind_is_not_taken_for_matt_shading() -> None:
    picture = lambert(48, (1, 0.3, -0.5))
    normals, inside = disc_normals(48)
    low = separate(picture, tolerance=0, ignored=ALL).low[inside][:, 0]
    values, n = picture[inside][:, 0], normals[inside]
    assert low.max() < 0.5 * values.max()
    for pixel in np.argsort(-low)[:3]:
        bounds = [(None, None), (None, None), (0, None)]
        wanted = -linprog(-n[pixel], A_ub=n, b_ub=values, bounds=bounds, method="highs").fun
        assert low[pixel] == pytest.approx(wanted, abs=2e-7)


@pytest.mark.parametrize("form", ["continuous", "discrete"])
@pytest.mark.parametrize("seed", range(4))
def test_the_layers_are_not_negative_and_add_up(form: str, seed: int) -> None:
    picture = noise(40, seed).astype(np.float32)
    _, inside = disc_normals(40)
    found = separate(picture, form="discrete" if form == "discrete" else "continuous")
    assert found.low.min() >= 0 and found.high.min() >= 0
    np.testing.assert_array_equal((found.low + found.high).astype(np.float32)[inside], picture[inside])
    assert not found.low[~inside].any() and not found.high[~inside].any()


def test_what_a_tolerance_allows_is_not_passed() -> None:
    picture = np.sqrt(np.maximum(glossy(120), 0))
    exact, loose = (separate(picture, tolerance=tolerance, ignored=ALL).low for tolerance in (0, 1e-3))
    assert (loose >= exact - 1e-12).all()
    assert 1e-6 < (loose - exact).max() <= 1e-3 * picture.max()


def test_what_lies_outside_the_disc_or_is_masked_holds_nothing_down() -> None:
    picture = lambert(60, (0.2, 0.1, 1))
    _, inside = disc_normals(60)
    scribbled = picture.copy()
    scribbled[~inside] = 0
    scribbled[25:28, 30:34] = 0
    covered = np.ones((60, 60), bool)
    covered[25:28, 30:34] = False
    low = separate(scribbled, covered=covered).low
    np.testing.assert_allclose(low[covered & inside], picture[covered & inside], atol=1e-12)
    assert separate(scribbled).low.max() < 0.7 * picture.max()


@pytest.mark.parametrize("ignored", [Ignored(floor=0.0), Ignored(percent=1.0)], ids=["floor", "percentile"])
def test_black_ink_is_let_pass_if_so_wished(ignored: Ignored) -> None:
    picture = lambert(60, (0.2, 0.1, 2)) + 0.01
    inked = picture.copy()
    inked[20, 20:30] = 0
    low = separate(inked, ignored=ignored, tolerance=0).low
    away = np.ones((60, 60), bool)
    away[20, 20:30] = False
    assert np.abs(low - separate(picture, tolerance=0).low)[away].max() < 0.02
    assert not low[20, 20:30].any()


def test_a_smoothed_edge_before_a_background_is_no_data() -> None:
    fine = np.where(disc_normals(480)[1][..., None], np.full(3, 0.3), 0)
    picture = fine.reshape(60, 8, 60, 8, 3).mean(axis=(1, 3))
    found = separate(picture)
    _, inside = disc_normals(60)
    assert 0 < np.count_nonzero(inside & ~found.known) < 400
    assert separate(lambert(60, (0.1, 0.2, 1))).known.sum() == inside.sum()
    np.testing.assert_allclose(found.low[found.known], 0.3, atol=1e-4)
    assert separate(picture, ignored=ALL).low[found.known].min() < 0.29


@pytest.mark.parametrize("form", ["continuous", "discrete"])
@pytest.mark.parametrize("value", [0.0, 0.3])
@pytest.mark.parametrize("size", [4, 8, 33])
def test_flat_and_tiny_pictures_come_apart(form: str, value: float, size: int) -> None:
    found = separate(np.full((size, size, 3), value), form="discrete" if form == "discrete" else "continuous")
    _, inside = disc_normals(size)
    assert np.isfinite(found.low).all()
    np.testing.assert_allclose((found.low + found.high)[inside], value, rtol=1e-12)


@pytest.mark.parametrize(
    ("picture", "reason"),
    [
        pytest.param(np.ones((8, 9, 3)), "9 × 8 is no MatCap", id="not square"),
        pytest.param(np.ones((2, 2, 3)), "2 pixels on a side", id="too small"),
        pytest.param(np.full((8, 8, 3), np.nan), "no number", id="NaN"),
        pytest.param(np.full((8, 8, 3), -1.0), "below 0", id="negative"),
    ],
)
def test_what_is_no_matcap_is_refused(picture: F64, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        separate(picture, source="x.png")


def test_a_mask_that_leaves_nothing_is_refused() -> None:
    with pytest.raises(InputError, match=r"x\.png: no pixel"):
        separate(np.ones((8, 8, 3)), covered=np.zeros((8, 8), bool), source="x.png")


def test_one_black_channel_stays_black() -> None:
    picture = glossy(40)
    picture[..., 1] = 0
    found = separate(picture)
    assert not found.low[..., 1].any() and not found.high[..., 1].any()
    assert found.low[..., 0].any()
