import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from click.testing import CliRunner

from litrig.commands import cli
from processing.shape.env_exr import read_environments
from processing.shape.reconstruct import ReconstructOptions, reconstruct
from processing.shape.reconstruction_sheet import CELL_PX, COLUMNS, reconstruction_sheet
from processing.shape.reflection.environment import ReflectionOptions
from tests.processing.shape.scene import buffers
from tests.processing.shape.stored import layers, write

SCENE = buffers()


@pytest.fixture
def stored(tmp_path: Path) -> Path:
    write(tmp_path / "two.exr", layers(SCENE))
    return tmp_path / "two.exr"


def run(*arguments: object) -> tuple[int, str, str]:
    result = CliRunner().invoke(cli, ["shape", "reconstruct", *map(str, arguments)])
    return result.exit_code, result.stdout, result.stderr or str(result.exception)


def test_the_file_holds_what_the_function_finds(stored: Path) -> None:
    output = stored.with_name("two.env.exr")
    status, told, noted = run(stored, "-o", output, "--size", 32, "--report", stored.with_name("two.png"))
    assert status == 0
    found = reconstruct(SCENE, options=ReconstructOptions(reflection=ReflectionOptions(32)))
    kept = read_environments(output)
    assert list(kept) == [2, 7]
    for number, environment in found.environments.items():
        np.testing.assert_allclose(kept[number].diffuse, environment.diffuse, atol=1e-5)
        np.testing.assert_allclose(kept[number].front, environment.front, atol=1e-4)
        assert f"surface {number} shows {found.coverage[number]:.0%}" in told
    assert "note: surface 2: it shows" in noted
    sheet = cv2.imread(str(stored.with_name("two.png")))
    assert sheet is not None
    assert sheet.shape[1] == COLUMNS * CELL_PX + 4 * (COLUMNS - 1)
    assert sheet.shape[0] == 2 * CELL_PX + 4


def test_one_surface_can_be_chosen_and_the_answer_read_by_a_program(stored: Path) -> None:
    output = stored.with_name("one.env.exr")
    status, told, _ = run(stored, "-o", output, "--size", 16, "--surface", 7, "--diffuse", "ls", "--json")
    assert status == 0
    answer = json.loads(told)
    assert answer["surfaces"] == [7]
    assert 0 < answer["coverage"]["7"] < 1
    assert list(read_environments(output)) == [7]


@pytest.mark.parametrize(
    ("arguments", "status", "reason"),
    [
        (("-o", "x.exr"), 1, "end it in .env.exr"),
        (("-o", "x.env.exr", "--surface", "5"), 1, "surface 5: is not seen; choose among 2, 7"),
        (("-o", "x.env.exr", "--diffuse", "ls", "--never-negative"), 1, "knows no bounds"),
        (("-o", "x.env.exr", "--report", "x.txt"), 1, "x.txt"),
        (("-o", "x.env.exr", "--size", "4096", "--regions", "64"), 1, "GiB of environments"),
        (("-o", "x.env.exr", "--ridge", "-1"), 2, ""),
    ],
)
def test_what_cannot_be_done_leaves_nothing(
    stored: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], status: int, reason: str
) -> None:
    monkeypatch.chdir(stored.parent)
    found, _, noted = run(stored, *arguments)
    assert found == status
    assert reason in noted
    assert [path.name for path in stored.parent.iterdir()] == ["two.exr"]


def test_residuals_of_occlusion_are_blue() -> None:
    found = reconstruct(SCENE, [2], ReconstructOptions(reflection=ReflectionOptions(16)))
    sheet = reconstruction_sheet(SCENE, found).astype(int)
    residuals = sheet[:, 2 * (CELL_PX + 4) : 2 * (CELL_PX + 4) + CELL_PX]
    assert np.any(residuals[..., 2] - residuals[..., 0] > 60)
    assert not np.any(residuals[..., 0] - residuals[..., 2] > 20)
    unseen = sheet[:, 3 * (CELL_PX + 4) : 3 * (CELL_PX + 4) + CELL_PX]
    assert 0.2 < np.mean((unseen[..., 0] > 150) & (unseen[..., 1] < 30)) < 0.7
