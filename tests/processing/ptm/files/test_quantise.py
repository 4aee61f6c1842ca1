import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from litrig.base.errors import InputError
from processing.ptm.files.quantise import ScaleBias, scale_bias

BOUNDS = st.floats(-1e6, 1e6)


@given(BOUNDS, BOUNDS)
@example(1.0, 2.0)
@example(-2.0, -1.0)
@example(0.0, 1e-300)
def test_the_bias_is_a_code(a: float, b: float) -> None:
    step = scale_bias(min(a, b), max(a, b))
    assert 0 <= step.bias <= 255
    assert step.scale > 0


@given(BOUNDS, BOUNDS, st.floats(0, 1))
def test_what_lies_between_the_bounds_comes_back_to_half_a_step(a: float, b: float, share: float) -> None:
    step = scale_bias(min(a, b), max(a, b))
    value = a + share * (b - a)
    decoded = float(step.decode(step.encode(np.array([value])))[0])
    assert decoded == pytest.approx(value, abs=0.501 * step.scale + 1e-6 * abs(value))


@given(BOUNDS, BOUNDS)
def test_the_scale_has_the_digits_that_are_printed(a: float, b: float) -> None:
    scale = scale_bias(min(a, b), max(a, b)).scale
    assert float(f"{scale:.8g}") == scale


@given(BOUNDS, BOUNDS)
def test_zero_is_a_code(a: float, b: float) -> None:
    step = scale_bias(min(a, b), max(a, b))
    assert step.decode(step.encode(np.zeros(1)))[0] == 0


def test_a_plane_of_zeros_has_scale_one_and_bias_zero() -> None:
    assert scale_bias(0.0, 0.0) == ScaleBias(1.0, 0)


@pytest.mark.parametrize("value", [300.0, -1.0, np.nan])
def test_what_the_codes_cannot_hold_is_refused(value: float) -> None:
    with pytest.raises(InputError, match="exceed"):
        ScaleBias(1.0, 0).encode(np.array([value]))
