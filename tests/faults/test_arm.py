"""Each mishap of arm, lamp and stepper table, on a small scale."""

from collections.abc import Callable

import pytest

from tests.faults import arm
from tests.faults.outcome import Outcome, Scale

CASES: list[tuple[Callable[[Scale], Outcome], int]] = [
    (arm.fault_01_arm_flipped_bits, 500),
    (arm.fault_02_arm_dropped_bytes, 1),
    (arm.fault_05_arm_late_answers, 20),
    (arm.fault_12_goals_out_of_range, 100),
    (arm.fault_13_keep_out_zones, 40),
    (arm.fault_17_arm_unplugged, 3),
    (arm.fault_18_arm_replugged_on_the_wire, 1),
    (arm.fault_22_arm_power_loss, 6),
    (arm.fault_40_arm_hard_limit, 3),
    (arm.fault_40_arm_stopped_by_signals, 2),
    (arm.fault_36_lamp_of_a_killed_host, 1),
]


@pytest.mark.parametrize(("fault", "trials"), CASES, ids=[fault.__name__ for fault, _ in CASES])
def test_a_mishap_is_survived_or_told(fault: Callable[[Scale], Outcome], trials: int) -> None:
    outcome = fault(Scale(trials))
    assert outcome.wrong == 0, outcome
    assert outcome.passed, outcome
