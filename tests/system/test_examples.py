"""What lies in examples/ works: the simulated rigs move, and the sample captures become materials."""

from pathlib import Path

import pytest

from firmware_sim.config import SimConfig, read_sim
from litrig.base.pictures import read_codes
from tests.system.command import litrig

EXAMPLES = Path(__file__).parents[2] / "examples"
CAPTURES = EXAMPLES / "captures"


@pytest.mark.parametrize("name", ["sim-amc.toml", "sim-ptm.toml"])
def test_a_command_moves_the_simulated_rig(name: str) -> None:
    result = litrig("sim", "run", EXAMPLES / name, "--", "sh", "-c", 'litrig rig move "$LITRIG_RIG" --angle -30.5')
    assert result.returncode == 0, result.stderr
    assert result.stdout.strip() in ("turntable at -30.50°", "turntable at -30.49°", "turntable at -30.51°")


def test_the_sphere_example_spells_out_the_defaults() -> None:
    assert read_sim(EXAMPLES / "sim-amc.toml") == SimConfig()


def test_a_picture_is_taken_and_a_light_is_lit(tmp_path: Path) -> None:
    script = (
        'litrig rig snap "$LITRIG_RIG" -o dark.jpg && litrig rig light "$LITRIG_RIG" --azimuth 60 --elevation 55 && '
        'litrig rig snap "$LITRIG_RIG" -o lit.png && litrig rig park "$LITRIG_RIG" && '
        'litrig rig snap "$LITRIG_RIG" -o parked.png'
    )
    result = litrig("sim", "run", EXAMPLES / "sim-ptm.toml", "--", "sh", "-c", f"cd {tmp_path} && {script}")
    assert result.returncode == 0, result.stderr
    assert "lamp 0 lit at azimuth 60.00°, elevation 55.00°" in result.stdout
    dark, lit, parked = (read_codes(tmp_path / name).mean() for name in ("dark.jpg", "lit.png", "parked.png"))
    assert lit > 5 * max(dark, parked)


@pytest.mark.parametrize("name", ["brushed", "relief"])
def test_the_samples_are_valid(name: str) -> None:
    result = litrig("capture", "verify", CAPTURES / name)
    assert result.returncode == 0, result.stderr


def test_the_samples_become_materials_and_pictures(tmp_path: Path) -> None:
    amc, ptm = tmp_path / "brushed.amc.ktx2", tmp_path / "relief.ptm"
    commands: list[list[str | Path]] = [
        ["amc", "build", CAPTURES / "brushed", "-o", amc, "--size", "48"],
        ["amc", "info", amc],
        ["ptm", "fit", CAPTURES / "relief", "-o", ptm],
        ["ptm", "info", ptm],
        ["ptm", "relight", ptm, "--light", "-0.5", "0.3", "-o", tmp_path / "lit.png"],
        ["render", amc, "-o", tmp_path / "torus.png", "--size", "200", "150"],
        ["render", amc, "-o", tmp_path / "cloth.png", "--mesh", "cloth", "--size", "200", "150"],
        ["render", ptm, "-o", tmp_path / "flat.png", "--light", "-0.5", "0.3"],
    ]
    for command in commands:
        result = litrig(*command)
        assert result.returncode == 0, f"{command}: {result.stderr}"
    for picture in tmp_path.glob("*.png"):
        assert read_codes(picture).std() > 5
    assert abs(read_codes(tmp_path / "lit.png").astype(int) - read_codes(tmp_path / "flat.png")).max() <= 1
