from pathlib import Path

import numpy as np

from litrig.base.contact_sheet import contact_sheet
from litrig.base.page import Figure, Section, Table, write_page
from litrig.base.pictures import read_codes
from litrig.base.plots import plot


def test_texts_are_escaped(tmp_path: Path) -> None:
    sections = [Section("<script>alert(1)</script>", "a & b", [Figure("a.png", '"quoted"')], Table(["x"], [["<i>"]]))]
    write_page(tmp_path / "index.html", "T", "lead", sections)
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert "<script>" not in page
    assert "<i>" not in page
    assert "a &amp; b" in page
    assert "&#34;quoted&#34;" in page


def test_videos_play_and_pictures_are_shown(tmp_path: Path) -> None:
    figures = [Figure("a.mp4", "moves", size=(4, 2)), Figure("b.png", "stands")]
    write_page(tmp_path / "index.html", "T", "lead", [Section("S", figures=figures)])
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert '<video src="a.mp4" autoplay loop muted playsinline controls width="4" height="2"></video>' in page
    assert '<img src="b.png" alt="stands">' in page


def test_a_sheet_keeps_order_and_fits_rows_of_different_heights() -> None:
    pictures = [np.full((10, 20, 3), 50 * (index + 1), np.uint8) for index in range(3)]
    pictures[2] = np.full((40, 20, 3), 150, np.uint8)
    sheet = contact_sheet(pictures, columns=2, cell_width=20, gap=4)
    assert sheet.shape == (10 + 4 + 40, 44, 3)
    assert [int(sheet[5, 5, 0]), int(sheet[5, 30, 0]), int(sheet[40, 5, 0])] == [50, 100, 150]


def test_a_plot_is_a_picture(tmp_path: Path) -> None:
    with plot(tmp_path / "a.png", (2, 1)) as axes:
        axes.plot([0, 1], [0, 1])
    assert read_codes(tmp_path / "a.png").shape == (150, 300, 3)


def test_a_long_table_can_be_folded_and_need_no_headings(tmp_path: Path) -> None:
    folded = Section("Long", table=Table((), [["a", 1]]), folded="two <cells>")
    sections = [folded, Section("Short", table=Table(["x"], []))]
    write_page(tmp_path / "index.html", "T", "lead", sections)
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert page.count("<details>") == page.count("</details>") == 1
    assert "<summary>two &lt;cells&gt;</summary>" in page
    assert page.count("<thead>") == 1
