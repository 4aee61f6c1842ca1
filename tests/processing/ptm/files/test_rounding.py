import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps

from litrig.base.errors import InputError
from processing.ptm.basis import PTM
from processing.ptm.files.rounding import Rounding, choose_rounding, make_rounding
from tests.processing.ptm.relief import dome

GRAM = PTM.gram


def some_coefficients(count: int = 3000) -> np.typing.NDArray[np.float32]:
    random = np.random.default_rng(2)
    spread = np.array([0.3, 0.4, 0.2, 0.3, 0.3, 0.2])[:, None]
    values = random.standard_normal((6, count)) * spread + np.array([0, 0, 0, 0, 0, 0.5])[:, None]
    return np.asarray(values, np.float32)


def loss(rounding: Rounding, coefficients: np.typing.NDArray[np.float32]) -> float:
    lost = coefficients - rounding.decode(rounding.encode(coefficients))
    return float(np.sum(lost * (GRAM @ lost)))


def plainly_rounded(rounding: Rounding, coefficients: np.typing.NDArray[np.float32]) -> float:
    codes = np.stack([step.encode(term) for step, term in zip(rounding.steps, coefficients, strict=True)])
    lost = coefficients - rounding.decode(codes)
    return float(np.sum(lost * (GRAM @ lost)))


def bounds(coefficients: np.typing.NDArray[np.float32]) -> list[tuple[float, float]]:
    return [(float(term.min()), float(term.max())) for term in coefficients]


def test_terms_that_make_up_for_each_other_lose_less_than_each_rounded_by_itself() -> None:
    coefficients = some_coefficients()
    rounding = make_rounding(bounds(coefficients), GRAM)
    assert loss(rounding, coefficients) < 0.8 * plainly_rounded(rounding, coefficients)


def test_lights_close_together_gain_more() -> None:
    """Their terms are so much alike that nearly all of an error can be made up for."""
    near = PTM.evaluate(dome(40)[:12])
    gram = near.T @ near / 12
    coefficients = some_coefficients()
    rounding = make_rounding(bounds(coefficients), gram)
    lost = coefficients - rounding.decode(rounding.encode(coefficients))
    plain = coefficients - rounding.decode(
        np.stack([step.encode(term) for step, term in zip(rounding.steps, coefficients, strict=True)])
    )
    assert np.sum(lost * (gram @ lost)) < 0.5 * np.sum(plain * (gram @ plain))


def test_an_extreme_pixel_does_not_coarsen_all_others() -> None:
    coefficients = some_coefficients(4000)
    coefficients[:, 0] *= 1000
    chosen, all_held = choose_rounding(coefficients, GRAM), make_rounding(bounds(coefficients), GRAM)
    assert loss(chosen, coefficients[:, 1:]) < 0.01 * loss(all_held, coefficients[:, 1:])


@settings(max_examples=60)
@given(nps.arrays(np.float32, (6, 9), elements=st.floats(-1e4, 1e4, width=32)))
def test_codes_come_from_any_coefficients_and_biases_are_codes(coefficients: np.typing.NDArray[np.float32]) -> None:
    rounding = choose_rounding(coefficients, GRAM)
    assert all(0 <= step.bias <= 255 for step in rounding.steps)
    assert np.isfinite(rounding.decode(rounding.encode(coefficients))).all()


def test_zero_stays_zero() -> None:
    rounding = make_rounding([(-1.0, 3.0)] * 6, GRAM)
    assert not rounding.decode(rounding.encode(np.zeros((6, 5), np.float32))).any()


def test_coefficients_that_are_not_numbers_are_refused() -> None:
    coefficients = some_coefficients(50)
    coefficients[2, 7] = np.nan
    with pytest.raises(InputError, match="not a finite number"):
        choose_rounding(coefficients, GRAM)
