"""Who puts what before the camera, when steps are shot out of their order."""

from pathlib import Path

import pytest

from acquisition.arrangement import AS_AT_FIRST, arranged, done_by_now
from acquisition.plans import Step
from acquisition.runner import SoFar, run
from litrig.base.capture_folder.capture import Role
from litrig.base.capture_folder.journal import read_journal
from litrig.base.capture_folder.layout import JOURNAL
from litrig.base.capture_folder.writer import CaptureFolderWriter
from litrig.base.errors import HoldError
from tests.acquisition.test_session import Bench

CARD, BACK = "Put the white card there", "Put the sample back"
PLAN = [
    Step(0, Role.DARK, lit=False),
    Step(1, Role.WHITE, 0.0, ask=CARD),
    Step(2, Role.WHITE, 10.0),
    Step(3, angle_deg=0.0, ask=BACK),
    Step(4, angle_deg=10.0),
]


def shot(*steps: int) -> list[dict[str, object]]:
    return [{"ev": "frame", "step": step} for step in steps]


@pytest.mark.parametrize(
    ("last", "todo", "asks"),
    [
        pytest.param((), [0, 1, 2, 3, 4], ["", CARD, "", BACK, ""], id="from the start"),
        pytest.param((0, 1), [2, 3, 4], ["", BACK, ""], id="within the white frames"),
        pytest.param((0, 1, 2, 3), [4], [""], id="within the frames"),
        pytest.param((0, 1, 2, 3, 4), [2], [CARD], id="a white frame again"),
        pytest.param((0, 1, 2, 3, 4), [2, 4], [CARD, BACK], id="a white frame again, then a frame"),
        pytest.param((0, 1, 2), [0], [AS_AT_FIRST], id="back to the start"),
    ],
)
def test_a_person_is_asked_where_the_arrangement_changes(
    last: tuple[int, ...], todo: list[int], asks: list[str]
) -> None:
    steps = arranged(PLAN, [PLAN[number] for number in todo], shot(*last))
    assert [step.step for step in steps] == todo
    assert [step.ask for step in steps] == asks


def test_what_a_session_waited_for_is_taken_for_done_once(tmp_path: Path) -> None:
    bench = Bench(tmp_path / "s")
    asked = [Step(0, angle_deg=0.0), Step(1, Role.WHITE, 10.0, ask=CARD), Step(2, angle_deg=20.0, ask=BACK)]
    with CaptureFolderWriter.create(bench.folder, "coin", {}, []) as writer:
        for expected in (1, 2):
            entries = read_journal(bench.folder / JOURNAL)
            done = {entry["step"] for entry in entries if entry["ev"] == "frame"}
            todo = arranged(asked, [step for step in asked if step.step not in done], entries)
            with pytest.raises(HoldError, match=f"step {expected} needs a person"):
                list(run(todo, bench.rig, writer, lambda: False, so_far=SoFar(confirmed=done_by_now(entries, todo))))
        assert done_by_now([*entries, *shot(1)], todo) == frozenset(), "only right after the hold"
