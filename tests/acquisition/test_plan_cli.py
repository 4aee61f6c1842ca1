import json
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from acquisition.plan_report import size_text, time_text
from acquisition.plans.plan_file import read_plan
from litrig.base.errors import InputError
from litrig.commands import cli
from rig.config import read_rig
from tests.system.command import error_line, litrig

EXAMPLES = Path(__file__).parents[2] / "examples"
RIG = EXAMPLES / "rig.toml"
KINDS = ("amc", "ptm", "product")


def ask(*arguments: str | Path) -> str:
    result = CliRunner().invoke(cli, ["capture", "plan", *map(str, arguments)], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.stdout


def ask_json(*arguments: str | Path) -> dict[str, Any]:
    answer: dict[str, Any] = json.loads(ask(*arguments, "--json"))
    return answer


@pytest.mark.parametrize("kind", KINDS)
def test_it_says_what_the_plan_says(kind: str) -> None:
    path = EXAMPLES / f"plan-{kind}.toml"
    plan = read_plan(path, read_rig(RIG))
    answer = ask_json(path, "--rig", RIG)
    assert answer["kind"] == kind
    assert answer["steps"] == len(plan) == sum(answer["by_role"].values())
    assert answer["by_role"] == Counter(step.role.value for step in plan)
    assert [entry["ask"] for entry in answer["asks"]] == [step.ask for step in plan if step.ask]
    assert answer["forecast"]["total_s"] > 60
    assert set(answer["coverage"]) == {"amc": {"turn"}, "ptm": {"lights"}, "product": {"turn", "lights"}}[kind]


@pytest.mark.parametrize("kind", KINDS)
def test_it_says_so_in_words_too(kind: str) -> None:
    path = EXAMPLES / f"plan-{kind}.toml"
    words, answer = ask(path, "--rig", RIG), ask_json(path, "--rig", RIG)
    for role, count in answer["by_role"].items():
        assert f"{count} {role}" in words
    assert time_text(answer["forecast"]["total_s"]) in words
    assert size_text(answer["forecast"]["disk_bytes"]) in words
    assert "--rig tells yours" not in words


def test_without_a_rig_it_says_whose_time_it_tells() -> None:
    assert "time and disk are those of a rig of RIG.toml's defaults" in ask(EXAMPLES / "plan-ptm.toml")


def test_nothing_is_written_unless_a_picture_is_asked_for(tmp_path: Path) -> None:
    plan = tmp_path / "plan.toml"
    plan.write_bytes((EXAMPLES / "plan-ptm.toml").read_bytes())
    ask(plan)
    assert list(tmp_path.iterdir()) == [plan]
    ask(plan, "--plot", tmp_path / "p.png")
    assert (tmp_path / "p.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(InputError, match=r"let its name end in \.png"):
        ask(plan, "--plot", tmp_path / "p.jpeg")


def test_few_slices_for_the_table_are_remarked(tmp_path: Path) -> None:
    plan = tmp_path / "plan.toml"
    plan.write_text('kind = "amc"\n[turn]\nslices = 128\n', encoding="utf-8")
    assert "fewer than the 256 to 512 that suit a table of size 128" in ask(plan)
    assert "suit a table" not in ask(plan, "--size", "64")
    assert "more than the 32 to 64 that suit a table of size 16" in ask(plan, "--size", "16")


def test_the_free_space_is_told_and_too_little_of_it_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    free = [10**12]
    monkeypatch.setattr("acquisition.plan_cli.free_space", lambda folder: free[0])
    plan, folder = EXAMPLES / "plan-amc.toml", tmp_path / "s"
    assert "1 TB free" in ask(plan, "-o", folder)
    free[0] = 10**6
    with pytest.raises(InputError, match=r"1 MB are free there, and .*plan-amc\.toml needs about 103 MB; free space"):
        ask(plan, "-o", folder)
    assert not folder.exists()


def test_a_folder_that_is_not_there_yet_has_the_space_of_the_disk_it_would_be_on(tmp_path: Path) -> None:
    answer = ask_json(EXAMPLES / "plan-amc.toml", "-o", tmp_path / "a" / "b")
    assert answer["free_bytes"] > 0


def test_a_plan_beyond_the_rigs_limits_is_refused_in_one_line(tmp_path: Path) -> None:
    rig = tmp_path / "rig.toml"
    rig.write_text(RIG.read_text(encoding="utf-8").replace("# max_deg = 720.0", "max_deg = 200.0"), encoding="utf-8")
    result = litrig("capture", "plan", EXAMPLES / "plan-amc.toml", "--rig", rig, "--plot", tmp_path / "p.png")
    assert result.returncode == 1
    assert "plan-amc.toml: step 153 (000153_tt201.09): turntable: 201.094° is outside" in error_line(result)
    assert result.stdout == ""
    assert list(tmp_path.iterdir()) == [rig]


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.4, "0 s"), (99, "99 s"), (100, "1 min 40 s"), (599.6, "10 min"), (3600, "60 min"), (7384, "2 h 03 min")],
)
def test_times_are_told_as_people_do(seconds: float, text: str) -> None:
    assert time_text(seconds) == text


@pytest.mark.parametrize(
    ("size", "text"),
    [(0, "0 kB"), (1500, "1.5 kB"), (2.5e6, "2.5 MB"), (999e6, "999 MB"), (3e12, "3 TB"), (5e15, "5e+03 TB")],
)
def test_sizes_are_told_as_people_do(size: float, text: str) -> None:
    assert size_text(size) == text
