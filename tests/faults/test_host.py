"""The faults of the host, few times each."""

from collections.abc import Callable

import pytest

from tests.faults import doctor, host
from tests.faults.outcome import Outcome, Scale


@pytest.mark.parametrize(
    ("fault", "trials"),
    [
        (host.fault_19_permission_denied, 2),
        (host.fault_20_port_held, 3),
        (host.fault_21_second_litrig, 1),
        (host.fault_35_read_only_folder, 1),
        (host.fault_35_disk_too_small, 1),
        (doctor.fault_14_wrong_baud, 1),
        (doctor.fault_15_id_clash, 4),
        (doctor.fault_16_wrong_model, 1),
    ],
)
def test_the_fault_is_told_and_does_no_harm(fault: Callable[[Scale], Outcome], trials: int) -> None:
    outcome = fault(Scale(trials))
    if outcome.trials == 0:
        pytest.skip(outcome.detail)
    assert outcome.passed, outcome
    assert outcome.wrong == 0
