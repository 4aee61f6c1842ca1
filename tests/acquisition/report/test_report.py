"""The page that looks back at a session."""

import json
import shutil
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from acquisition.cli import capture
from acquisition.plans import Aim, Step, amc_plan, ptm_plan
from acquisition.report import report as report_module
from acquisition.report.cells import cells_of
from acquisition.report.hemisphere import SIZE_PX, hemisphere
from acquisition.report.record import read_record
from acquisition.report.report import write_report
from acquisition.report.sheets import PAGE_PX, look_for, sheets
from acquisition.report.times import step_times
from litrig.base.capture_folder import layout
from litrig.base.capture_folder.verify import verify_capture
from litrig.base.errors import InputError
from litrig.base.pictures import read_codes
from tests.acquisition.report.sessions import Written, turn
from tests.acquisition.test_session import Bench
from tests.system.browser import look_at, needs_browser

CAPTURES = Path(__file__).parents[3] / "examples/captures"


class Links(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.links += [value for name, value in attrs if name in ("src", "href") and value]


def links(page: str) -> list[str]:
    parser = Links()
    parser.feed(page)
    return parser.links


@pytest.fixture(scope="module")
def open_session(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a session on hold, with all that can be told of one."""
    folder = tmp_path_factory.mktemp("sessions") / "s"
    with Written(folder, turn(8)) as session:
        session.writer.add_note("<script>alert('wax')</script> & more")
        for step in session.steps[:5]:
            session.shoot(step, 100 + step.step)
        session.writer.record("retry", step=5, attempt=1, reason="is black; <b>check</b> lamp")
        session.shoot(session.steps[5])
        session.shoot(session.steps[1], 101)
        session.writer.record("hold", reason="turntable: no answer")
    return folder


@pytest.mark.parametrize("name", ["brushed", "relief"])
def test_a_session_of_an_earlier_version_has_a_page_whose_pictures_show_something(tmp_path: Path, name: str) -> None:
    shutil.copytree(CAPTURES / name, tmp_path / name)
    written = write_report(tmp_path / name)
    assert written.page == tmp_path / f"{name}.report/index.html"
    page = written.page.read_text(encoding="utf-8")
    assert "All 24 frames" in page
    assert "does not say how long move" in page
    assert "//" not in page
    assert len(links(page)) >= 6
    for link in links(page):
        assert read_codes(written.page.parent / link).std() > 3, f"{link} shows nothing"
    assert verify_capture(tmp_path / name).findings == ()


def test_a_page_tells_the_state_and_escapes_what_people_wrote(open_session: Path, tmp_path: Path) -> None:
    page = write_report(open_session, tmp_path / "r").page.read_text(encoding="utf-8")
    assert "6 of 8 frames, shot by A. Smith" in page
    assert "on hold: turntable: no answer" in page
    assert "<script>" not in page
    assert "<b>check" not in page
    assert "&lt;script&gt;alert" in page
    assert "serial number 17" in page
    assert "steps 6, 7" in page, "those that are missing"


def test_the_command_prints_the_page_or_what_it_says(open_session: Path, tmp_path: Path) -> None:
    arguments = ["report", str(open_session), "-o", str(tmp_path / "r")]
    result = CliRunner().invoke(capture, arguments)
    assert result.output.strip() == str(tmp_path / "r/index.html")
    told = json.loads(CliRunner().invoke(capture, [*arguments, "--json"]).stdout)
    assert (told["state"], told["frames"], told["wanted"], told["missing"]) == ("on hold", 6, 8, [6, 7])
    assert told["flags"] == {"1": ["taken again"], "5": ["several tries"], "6": ["missing"], "7": ["missing"]}
    assert told == json.loads((tmp_path / "r/report.json").read_text())


def test_an_earlier_report_is_replaced_and_nothing_else(open_session: Path, tmp_path: Path) -> None:
    place = tmp_path / "r"
    before = write_report(open_session, place).page.stat().st_ino
    after = write_report(open_session, place).page.stat().st_ino
    assert before != after
    (place / "thesis.png").write_text("mine")
    with pytest.raises(InputError, match="holds files already"):
        write_report(open_session, place)
    assert (place / "thesis.png").read_text() == "mine"
    assert [path.name for path in tmp_path.iterdir()] == ["r"]


def test_a_report_that_fails_leaves_the_earlier_one(
    open_session: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = write_report(open_session, tmp_path / "r").page.read_bytes()

    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(report_module, "write_page", fail)
    with pytest.raises(InputError, match="No space left"):
        write_report(open_session, tmp_path / "r")
    assert (tmp_path / "r/index.html").read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["r"]


@pytest.mark.parametrize("below", ["", "data/report", "../s/report"])
def test_a_report_never_lies_in_the_bag(open_session: Path, below: str) -> None:
    with pytest.raises(InputError, match="lies in the session's own folder"):
        write_report(open_session, open_session / below)


def test_a_session_without_a_frame_has_a_page(tmp_path: Path) -> None:
    with Written(tmp_path / "s", turn(8)):
        pass
    written = write_report(tmp_path / "s")
    assert written.summary["missing"] == list(range(8))
    assert "0 of 8 frames" in written.page.read_text(encoding="utf-8")


def test_frames_that_cannot_be_read_are_empty_cells(open_session: Path, tmp_path: Path) -> None:
    folder = tmp_path / "s"
    shutil.copytree(open_session, folder)
    shutil.rmtree(folder / layout.THUMBS)
    next((folder / layout.FRAMES).glob("000003*")).write_bytes(b"no JPEG")
    written = write_report(folder)
    assert any("changed since it was captured" in finding for finding in written.summary["findings"])


def test_a_missing_step_is_an_empty_cell_and_each_frame_shows_its_picture(tmp_path: Path) -> None:
    with Written(tmp_path / "s", turn(8)) as session:
        for step in session.steps[:7]:
            session.shoot(step, 60 + 20 * step.step)
    look = look_for(8)
    thumbs = {step: np.full((9, 12, 3), 60 + 20 * step, np.uint8) for step in range(7)}
    drawn = sheets(cells_of(read_record(tmp_path / "s"), []), lambda cell: thumbs.get(cell.step.step), look)
    assert len(drawn) == 1
    middles = [drawn[0][50, look.cell_px // 2 + column * (look.cell_px + 6), 0] for column in range(6)]
    assert [int(value) for value in middles] == [60 + 20 * step for step in range(6)]
    assert drawn[0][-80, look.cell_px + 6 + look.cell_px // 2].max() < 40, "step 7 is missing"


@pytest.mark.parametrize(("count", "expected"), [(1, 1), (48, 1), (49, 1), (240, 1), (481, 3)])
def test_many_frames_take_several_sheets_of_the_page_s_width(tmp_path: Path, count: int, expected: int) -> None:
    with Written(tmp_path / "s", turn(count)):
        pass
    drawn = sheets(cells_of(read_record(tmp_path / "s"), []), lambda _: None, look_for(count))
    assert len(drawn) == expected
    assert all(PAGE_PX - 16 <= sheet.shape[1] <= PAGE_PX for sheet in drawn)
    assert all(sheet.shape[0] <= 2400 for sheet in drawn)


def test_on_the_hemisphere_a_frame_lies_where_its_light_was(tmp_path: Path) -> None:
    aims = [Aim(0.0, 20.0), Aim(90.0, 20.0), Aim(180.0, 20.0), Aim(0.0, 90.0)]
    steps = [Step(index, aim=aim) for index, aim in enumerate(aims)]
    with Written(tmp_path / "s", steps) as session:
        session.shoot_all()
    picture = hemisphere(
        cells_of(read_record(tmp_path / "s"), []), lambda cell: np.full((9, 12, 3), 50 + 50 * cell.step.step, np.uint8)
    )
    middle, reach = SIZE_PX // 2, round((SIZE_PX / 2 - 48) * np.sqrt(1 - np.sin(np.radians(20))))
    places = [(middle, middle + reach), (middle - reach, middle), (middle, middle - reach), (middle, middle)]
    assert [int(picture[place][0]) for place in places] == [50, 100, 150, 200]


def test_a_run_says_how_long_saving_took(tmp_path: Path) -> None:
    bench = Bench(tmp_path / "s")
    bench.shoot(amc_plan(8))
    saving_s = step_times(read_record(tmp_path / "s")).parts_s[:, 3]
    assert len(saving_s) == 8
    assert (saving_s > 0).all()
    assert (saving_s < 60).all()


def test_a_ptm_session_shows_its_lights_also_those_that_are_missing(tmp_path: Path) -> None:
    with Written(tmp_path / "s", list(ptm_plan(12))) as session:
        session.shoot_all(4)
    written = write_report(tmp_path / "s")
    names = {path.name for path in written.page.parent.iterdir()}
    assert {"lights.png", "hemisphere.jpg", "pose_light.png"} <= names


@needs_browser
def test_a_browser_shows_the_report(tmp_path: Path) -> None:
    write_report(CAPTURES / "relief", tmp_path / "report")
    shown = look_at(tmp_path / "report" / "index.html", tmp_path)
    sheet = shown[600:2000]
    assert sheet.std() > 15, "the contact sheet stands there"
    assert len(np.unique(sheet.reshape(-1, 3), axis=0)) > 1000
