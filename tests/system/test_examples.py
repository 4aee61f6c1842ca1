"""What lies in examples/ works: the simulated rigs move, and the sample captures become materials."""

from pathlib import Path

import pytest

from firmware_sim.config import SimConfig, read_sim
from litrig.base.pictures import read_codes
from tests.system.command import error_line, litrig

EXAMPLES = Path(__file__).parents[2] / "examples"
CAPTURES = EXAMPLES / "captures"
ARM_DB = 32.0
"""How well a PTM fits the sample that was shot with the light arm."""


@pytest.mark.parametrize("name", ["sim-amc.toml", "sim-ptm.toml", "sim-dome.toml"])
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


def test_a_dome_lights_its_nearest_lamp_and_its_ptm_fits_as_well_as_the_arms(tmp_path: Path) -> None:
    text = (EXAMPLES / "sim-dome.toml").read_text(encoding="utf-8")
    small = text.replace("lamps = 24", "lamps = 12") + "\n[camera]\nwidth = 320\nheight = 240\n"
    (tmp_path / "sim.toml").write_text(small, encoding="utf-8")
    script = (
        'litrig rig light "$LITRIG_RIG" --azimuth 305 --elevation 28 && litrig rig light "$LITRIG_RIG" --lamp 5 && '
        'litrig rig park "$LITRIG_RIG" && litrig capture ptm "$LITRIG_RIG" -o coin --lights 12 && '
        'litrig rig light "$LITRIG_RIG" --lamp 12'
    )
    result = litrig("sim", "run", tmp_path / "sim.toml", "--", "sh", "-c", f"cd {tmp_path} && {script}")
    assert result.returncode == 1, result.stderr
    assert error_line(result) == "litrig: lights: lamp 12 does not exist; this rig has lamps 0..11"
    nearest, fifth, *_ = result.stdout.splitlines()
    assert nearest == "lamp 3 lit at azimuth 307.48°, elevation 27.71°, 2.2° from what was asked for"
    assert fifth.startswith("lamp 5 lit at azimuth 32.46°")
    fitted = litrig("ptm", "fit", tmp_path / "coin", "-o", tmp_path / "coin.ptm").stdout
    assert float(fitted.split()[1]) > ARM_DB, fitted


@pytest.mark.parametrize("arguments", [[], ["--azimuth", "3"]], ids=["neither lamp nor direction", "half a direction"])
def test_a_light_from_nowhere_is_wrong_usage(arguments: list[str]) -> None:
    result = litrig("rig", "light", EXAMPLES / "rig.toml", *arguments)
    assert result.returncode == 2
    assert "give --azimuth and --elevation, or --lamp of a dome" in result.stderr


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
        ["render", ptm, "-o", tmp_path / "detail.png", "--window", "120", "130", "60", "40", "--zoom", "6"],
        ["render", ptm, "-o", tmp_path / "tour.mp4", "--tour", "4", "--light", "0.7", "0", "--specular", "0.4", "60"],
    ]
    for command in commands:
        result = litrig(*command)
        assert result.returncode == 0, f"{command}: {result.stderr}"
    assert (tmp_path / "tour.mp4").stat().st_size > 10_000
    for picture in tmp_path.glob("*.png"):
        assert read_codes(picture).std() > 5
    assert abs(read_codes(tmp_path / "lit.png").astype(int) - read_codes(tmp_path / "flat.png")).max() <= 1
