"""Numbers with derivatives: each operation against differences of its own values."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing.mesh import jets
from processing.mesh.jets import Jet

Formula = Callable[[Jet, Jet], Jet]
FORMULAS: dict[str, Formula] = {
    "sums": lambda u, v: 2.0 + u - v + 1.5 - (3.0 - u),
    "products": lambda u, v: 2.0 * u * v * u - -v * 0.5,
    "quotients": lambda u, v: u / (v + 3.0) / 2.0,
    "powers": lambda u, v: (u * u + 2.0) ** 1.5 + v**3.0,
    "waves": lambda u, v: jets.sin(u * v) * jets.cos(u - v),
    "roots and bends": lambda u, v: jets.sqrt(u * u + v * v + 1.0) + jets.tanh(u + v),
    "angles": lambda u, v: jets.angle(u + 3.0, v - 4.0),
    "a function with a slope": lambda u, v: jets.function(u * v, np.exp, np.exp),
}


@pytest.mark.parametrize("formula", FORMULAS.values(), ids=FORMULAS)
@given(u=st.floats(-1.5, 1.5), v=st.floats(-1.5, 1.5))
def test_derivatives_are_those_of_the_values(formula: Formula, u: float, v: float) -> None:
    step = 1e-5

    def value(at_u: float, at_v: float) -> float:
        return float(formula(*jets.parameters(np.array([at_u]), np.array([at_v]))).value[0])

    jet = formula(*jets.parameters(np.array([u]), np.array([v])))
    assert jet.du[0] == pytest.approx((value(u + step, v) - value(u - step, v)) / (2 * step), abs=1e-6)
    assert jet.dv[0] == pytest.approx((value(u, v + step) - value(u, v - step)) / (2 * step), abs=1e-6)
