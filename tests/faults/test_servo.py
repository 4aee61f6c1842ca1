"""Each mishap of the servo, on a small scale."""

from collections.abc import Callable

import pytest

from tests.faults import servo
from tests.faults.outcome import Outcome, Scale

CASES: list[tuple[Callable[[Scale], Outcome], int]] = [
    (servo.fault_01_flipped_bits, 500),
    (servo.fault_02_dropped_bytes, 1),
    (servo.fault_03_no_reply, 1),
    (servo.fault_04_duplicates, 100),
    (servo.fault_05_late_replies, 10_000),
    (servo.fault_05_late_replies_on_the_wire, 100),
    (servo.fault_06_echo, 30),
    (servo.fault_07_wrong_id, 100),
    (servo.fault_08_alert, 1),
    (servo.fault_09_goal_not_reached, 1),
    (servo.fault_10_still_moving, 1),
    (servo.fault_11_backlash, 1),
    (servo.fault_14_wrong_baud, 1),
    (servo.fault_15_two_servos_with_one_id, 1),
    (servo.fault_16_wrong_model, 1),
    (servo.fault_17_unplugged, 1),
    (servo.fault_22_power_sag, 1),
]


@pytest.mark.parametrize(("fault", "trials"), CASES, ids=[fault.__name__ for fault, _ in CASES])
def test_a_mishap_is_survived_or_told(fault: Callable[[Scale], Outcome], trials: int) -> None:
    outcome = fault(Scale(trials))
    assert outcome.wrong == 0, outcome
    assert outcome.passed, outcome
