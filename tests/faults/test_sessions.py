"""What befalls whole sessions, few times each; what takes long and has a like is left to `make faults`."""

from collections.abc import Callable, Iterator

import pytest

from tests.faults import cameras, clocks, disks, kills, plugs, resuming, slips
from tests.faults.outcome import Outcome, Scale
from tests.faults.real_sessions import sharing_sims

CASES: list[tuple[Callable[[Scale], Outcome], int]] = [
    (slips.fault_11_slips_seen, 6),
    (slips.fault_11_no_slip, 6),
    (slips.fault_11_slip_in_a_session, 1),
    (plugs.fault_17_unplugged_in_a_session, 1),
    (disks.fault_21_two_writers, 1),
    (resuming.fault_21_second_resume, 3),
    (cameras.fault_23_black_frames, 8),
    (cameras.fault_24_dead_lamps, 1),
    (cameras.fault_25_frozen_camera, 1),
    (cameras.fault_29_drifting_settings, 1),
    (cameras.fault_30_camera_lost_for_a_moment, 1),
    (cameras.fault_30_camera_lost_for_good, 1),
    (cameras.fault_32_cut_pictures, 10),
    (disks.fault_34_disk_full_at_every_operation, 2),
    (disks.fault_34_command_on_a_full_disk, 1),
    (disks.fault_35_disk_gone_in_a_session, 2),
    (kills.fault_36_killed_sessions, 5),
    (disks.fault_38_journal_cut_at_every_byte, 3),
    (clocks.fault_39_clock_jumps, 1),
    (kills.fault_40_terminal_closed, 1),
    (resuming.fault_42_exactly_the_missing, 8),
    (resuming.fault_43_changed_configuration, 1),
    (disks.fault_44_bit_rot, 1),
]


@pytest.fixture(scope="module", autouse=True)
def _sims() -> Iterator[None]:
    with sharing_sims():
        yield


@pytest.mark.parametrize(("fault", "trials"), CASES, ids=[fault.__name__ for fault, _ in CASES])
def test_a_session_survives_it_or_says_so(fault: Callable[[Scale], Outcome], trials: int) -> None:
    outcome = fault(Scale(trials))
    if outcome.trials == 0:
        pytest.skip(outcome.detail)
    assert outcome.wrong == 0, outcome
    assert outcome.passed, outcome
