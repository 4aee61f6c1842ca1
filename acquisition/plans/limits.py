"""How large a plan may be, and the error that says which of its numbers is not."""

import math

from litrig.base.errors import InputError

MOST_STEPS = 100_000
MOST_LIGHTS = 2000
MOST_ALIKE = 1000
"""Frames of a kind: repeated turns, averages, references."""
FARTHEST_EV = 12.0
FARTHEST_DEG = 90_000.0
FEWEST_SLICES = 8
"""Fewer give no table of tangent angles."""
FEWEST_LIGHTS = 6
"""A PTM has six coefficients."""


def check_range(name: str, value: float, lowest: float, highest: float, advice: str = "") -> None:
    """Refuse a number outside its range; so written, NaN is refused too.

    Raises
    ------
    InputError
        The message has the name, the range, and the advice.
    """
    if not (math.isfinite(value) and lowest <= value <= highest):
        more = f"; {advice}" if advice else "; mend it"
        raise InputError(f"{name}: {value:.10g} is outside {lowest:g}..{highest:.10g}{more}")
