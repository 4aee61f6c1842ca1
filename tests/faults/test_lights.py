from collections.abc import Callable

import pytest

from tests.faults.lights import fault_24_lamps_refused, fault_24_lamps_through_drop_outs, fault_24_lamps_through_stalls
from tests.faults.outcome import Outcome, Scale


@pytest.mark.parametrize(
    "fault",
    [fault_24_lamps_through_drop_outs, fault_24_lamps_through_stalls, fault_24_lamps_refused],
    ids=lambda fault: fault.__name__,
)
def test_exactly_the_lamp_that_was_asked_for_is_lit(fault: Callable[[Scale], Outcome]) -> None:
    outcome = fault(Scale(6))
    assert outcome.passed, outcome.detail
    assert (outcome.trials, outcome.wrong) == (6, 0)
