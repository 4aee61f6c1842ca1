"""Power cuts on a small scale; and that the harness finds what is lost where an order of writes is careless."""

from pathlib import Path

import pytest

from tests.faults.disk_states import EXTREMES, ForgetfulStore, ModelDisk, Operation, RecordingStore, paths
from tests.faults.fake_sessions import quick_folder
from tests.faults.outcome import Scale
from tests.faults.power_cut import fault_37_power_cut, lost_in, recorded_session, states

ROOT = Path("/root-of-the-model")


def test_no_power_cut_loses_an_acknowledged_frame() -> None:
    outcome = fault_37_power_cut(Scale(2))
    assert outcome.passed, outcome


@pytest.mark.parametrize(("left_out", "harm"), [("sync_folder", "frames lost"), ("sync", "acknowledged and")])
def test_a_store_that_does_not_sync_is_found_out(left_out: str, harm: str) -> None:
    with quick_folder() as root:
        tried = list(states(recorded_session(root, ForgetfulStore(left_out)), EXTREMES))
        with_frames = [state for state in tried if any(entry["ev"] == "frame" for entry in state[1])]
        _, found = lost_in(with_frames[:20])
    assert any(harm in what or "frames lost" in what for what in found), found


def left_by(*operations: Operation) -> set[tuple[tuple[str, bytes | None], ...]]:
    disk = ModelDisk(ROOT)
    for operation in operations:
        disk.apply(operation)
    return {tuple(paths(disk.survivors(fate))) for fate in EXTREMES}


def test_what_is_not_synced_may_be_lost_torn_zeroed_or_whole() -> None:
    write = Operation("write", ROOT / "a", b"abcd")
    assert left_by(write) == {(), *((("a", content),) for content in (b"", b"ab", bytes(4), b"abcd"))}


def test_what_is_synced_stays() -> None:
    operations = (
        Operation("write", ROOT / "a", b"abcd"),
        Operation("sync", ROOT / "a"),
        Operation("sync_folder", ROOT),
    )
    assert left_by(*operations) == {(("a", b"abcd"),)}


def test_an_unsynced_line_leaves_the_lines_before_alone() -> None:
    operations = (
        Operation("append", ROOT / "a", b"one\n"),
        Operation("sync", ROOT / "a"),
        Operation("sync_folder", ROOT),
        Operation("append", ROOT / "a", b"two\n"),
    )
    ends = (b"", b"tw", bytes(4), b"two\n")
    assert left_by(*operations) == {(("a", b"one\n" + end),) for end in ends}


def test_a_rename_is_never_half_done() -> None:
    operations = (
        Operation("write", ROOT / "a", b"x"),
        Operation("sync", ROOT / "a"),
        Operation("sync_folder", ROOT),
        Operation("rename", ROOT / "a", target=ROOT / "b"),
    )
    assert left_by(*operations) == {(("a", b"x"),), (("b", b"x"),)}


def test_the_operations_are_noted_as_they_were_done(tmp_path: Path) -> None:
    store = RecordingStore()
    store.write(tmp_path / "a", b"1", b"2")
    store.append(tmp_path / "a", b"3")
    store.cut(tmp_path / "a", 2)
    store.rename(tmp_path / "a", tmp_path / "b")
    assert [operation.kind for operation in store.operations] == ["write", "append", "cut", "rename"]
    assert (tmp_path / "b").read_bytes() == b"12"
