"""What is read from a session in any state."""

from pathlib import Path

import numpy as np
import pytest

from acquisition.consistency import Suspect
from acquisition.plans import Aim, Step
from acquisition.report.cells import Flag, as_grid, cells_of, in_order_of_pose
from acquisition.report.record import Fate, read_record
from acquisition.report.story import State, segments, standing, story
from acquisition.report.times import step_times
from litrig.base.capture_folder import layout
from litrig.base.capture_folder.capture import Role
from litrig.base.errors import InputError
from tests.acquisition.report.sessions import Written, turn

EIGHT = turn(8)


@pytest.mark.parametrize(
    ("event", "fields", "state", "reason"),
    [
        ("pause", {"frames": 5}, State.PAUSED, "by the operator, after 5 of 8 frames"),
        ("hold", {"reason": "camera: no picture"}, State.HOLD, "camera: no picture"),
        ("stop", {}, State.STOPPED, "by the operator, after 5 of 8 frames"),
        ("close", {"frames": 5}, State.BROKEN_OFF, "the bag was not made complete"),
        (None, {}, State.BROKEN_OFF, "died or was killed after 5 of 8 frames"),
    ],
)
def test_an_open_session_says_how_it_was_left(
    tmp_path: Path, event: str | None, fields: dict[str, object], state: State, reason: str
) -> None:
    with Written(tmp_path / "s", EIGHT) as session:
        session.shoot_all(5, 6, 7)
        if event is not None:
            session.writer.record(event, **fields)
    record = read_record(tmp_path / "s")
    assert standing(record).state is state
    assert reason in standing(record).reason
    assert [step.step for step in record.missing] == [5, 6, 7]
    assert record.findings == ()


def test_a_session_that_is_being_written_says_by_whom(tmp_path: Path) -> None:
    with Written(tmp_path / "s", EIGHT) as session:
        session.shoot_all()
        assert standing(read_record(tmp_path / "s")).state is State.WRITING
    assert standing(read_record(tmp_path / "s")).state is State.OPEN
    with Written(tmp_path / "t", EIGHT) as session:
        session.shoot_all()
        session.close()
    assert standing(read_record(tmp_path / "t")).state is State.CLOSED


def test_frames_are_replaced_called_back_and_taken_again(tmp_path: Path) -> None:
    with Written(tmp_path / "s", EIGHT) as session:
        for step in EIGHT[:4]:
            session.shoot(step)
        session.shoot(EIGHT[1], remarks=["7.1 % clipped"])
        session.writer.record("recall", steps=[2, 3], reason="step 3 shows the sample elsewhere")
        session.writer.record("retry", step=3, attempt=1, reason="is black")
        session.shoot(EIGHT[3])
    record = read_record(tmp_path / "s")
    fates = [(frame.line.step, frame.fate) for frame in record.frames]
    counts, replaced, recalled = Fate.COUNTS, Fate.REPLACED, Fate.RECALLED
    assert fates == [(0, counts), (1, replaced), (2, recalled), (3, recalled), (1, counts), (3, counts)]
    cells = cells_of(record, [])
    assert [cell.flags for cell in cells[:5]] == [
        (),
        (Flag.REMARK, Flag.RETAKEN),
        (Flag.RECALLED,),
        (Flag.RETAKEN, Flag.TRIES),
        (Flag.MISSING,),
    ]
    assert cells[1].words == "7.1 % clipped"
    assert cells[3].words.startswith("taken again, was called")


def test_a_suspect_is_marked(tmp_path: Path) -> None:
    with Written(tmp_path / "s", EIGHT) as session:
        session.shoot_all()
    suspect = Suspect(2, "data/frames/2.jpg", (0.0, 45.0), (90.0, 45.0), 60.0)
    cells = cells_of(read_record(tmp_path / "s"), [suspect])
    assert [cell.step.step for cell in cells if Flag.SUSPECT in cell.flags] == [2]


def test_pose_errors_are_those_of_both_readings(tmp_path: Path) -> None:
    with Written(tmp_path / "s", EIGHT) as session:
        session.shoot(EIGHT[3])
    frame = read_record(tmp_path / "s").frames[0]
    assert frame.error_deg("turntable", "before") == 0
    assert frame.error_deg("turntable", "after") == pytest.approx(0.1)
    assert frame.error_deg("light", "after") is None


def test_a_closure_frame_at_a_full_turn_is_the_last_of_its_pose_order(tmp_path: Path) -> None:
    half, whole, none = Step(0, angle_deg=180.0), Step(1, Role.CLOSURE, angle_deg=360.0), Step(2, angle_deg=0.0)
    steps = [half, whole, none, Step(3, Role.DARK)]
    with Written(tmp_path / "s", steps) as session:
        session.shoot_all()
    cells = cells_of(read_record(tmp_path / "s"), [])
    assert [cell.step.step for cell in in_order_of_pose(cells)] == [3, 2, 0, 1]


def test_slices_times_lights_are_a_grid_and_a_turn_is_none(tmp_path: Path) -> None:
    lights = [Aim(30.0 * index, 45.0) for index in range(3)]
    steps = [Step(3 * i + j, angle_deg=90.0 * i, aim=aim) for i in range(4) for j, aim in enumerate(lights)]
    with Written(tmp_path / "s", steps) as session:
        session.shoot_all(7)
    grid = as_grid(cells_of(read_record(tmp_path / "s"), []))
    assert grid is not None
    assert [[cell.step.step for cell in row if cell] for row in grid] == [[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]]
    with Written(tmp_path / "t", EIGHT) as session:
        session.shoot_all()
    assert as_grid(cells_of(read_record(tmp_path / "t"), [])) is None


def test_what_happened_is_told_in_order(tmp_path: Path) -> None:
    with Written(tmp_path / "s", EIGHT) as session:
        session.writer.record("reconnect", step=0, reason="camera lost")
        session.shoot(EIGHT[0])
        session.writer.record("pause", frames=1)
        session.writer.record("segment", number=2, litrig="0.1.0", torn_bytes=31, changed=["camera.gain (0 → 3)"])
        session.writer.add_note("put back")
    record = read_record(tmp_path / "s")
    told = story(record)
    assert [one.what for one in told] == ["begun", "reconnect", "pause", "resumed", "note"]
    assert all(one.since_start_s is not None and one.since_start_s >= 0 for one in told)
    assert "camera.gain (0 → 3)" in segments(record)[1][1]
    assert "31 bytes" in segments(record)[1][1]


def test_time_between_a_pause_and_the_next_segment_is_not_work(tmp_path: Path) -> None:
    with Written(tmp_path / "s", EIGHT) as session:
        journal = session.writer._journal
        clock_ns = iter(int(1e9 * second) for second in (1.0, 3.0, 4.0, 100.0, 102.5))
        journal._monotonic_ns = lambda: next(clock_ns)
        session.shoot(EIGHT[0], times_s={"move": 0.5, "settle": 0.1, "expose": 0.2}, handed_over_s=0.75)
        session.shoot(EIGHT[1], times_s={"move": 0.7, "settle": 0.1, "expose": 0.2}, handed_over_s=2.5)
        session.writer.record("pause", frames=2)
        session.writer.record("segment", number=2)
        session.shoot(EIGHT[2])
    record = read_record(tmp_path / "s")
    times = step_times(record)
    begun_s = record.entries[0]["mono_ns"] / 1e9
    assert times.shooting_s == pytest.approx(max(0.0, 1 - begun_s) + 2 + 1 + 2.5)
    np.testing.assert_allclose(times.parts_s[:2, 3], [0.25, 0.5])
    assert np.isnan(times.parts_s[2]).all()
    assert times.medians_s == pytest.approx({"move": 0.6, "settle": 0.1, "expose": 0.2, "save": 0.375})


def test_a_session_whose_plan_is_gone_is_still_read_and_says_so(tmp_path: Path) -> None:
    with Written(tmp_path / "s", EIGHT) as session:
        session.shoot_all(7)
    (tmp_path / "s" / layout.PLAN).unlink()
    (tmp_path / "s" / layout.SESSION).write_text("= no TOML")
    record = read_record(tmp_path / "s")
    assert [step.angle_deg for step in record.wanted] == [45.0 * index for index in range(7)]
    assert any("plan.jsonl" in finding for finding in record.findings)
    assert any("session.toml" in finding for finding in record.findings)


def test_a_folder_that_is_no_session_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="not a capture folder"):
        read_record(tmp_path)
