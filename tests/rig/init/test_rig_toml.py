"""RIG.toml from what was found: readable by us, and by people."""

import tomllib
from pathlib import Path

import pytest

from rig.config import ArmConfig, CameraConfig, RigConfig, TurntableConfig, read_rig
from rig.init.discovery import Discovery, FoundCamera, FoundController, FoundServos, Silent
from rig.init.rig_toml import write_rig_toml

SERVOS = FoundServos("/dev/ttyA", 1_000_000, {3: 1060, 8: 1060})
CONTROLLER = FoundController("/dev/ttyB", "1.1h", {30: 255.0, 130: 340.0, 131: 85.0})
CAMERA = FoundCamera(CameraConfig(device="/dev/video0", width=1280, height=720, pixel_format="YUYV"))


def read_back(found: Discovery, folder: Path) -> RigConfig:
    (folder / "rig.toml").write_text(write_rig_toml(found))
    return read_rig(folder / "rig.toml")


def test_what_was_found_is_what_is_read(tmp_path: Path) -> None:
    config = read_back(Discovery((SERVOS,), (CONTROLLER,), (CAMERA,)), tmp_path)
    assert isinstance(config.turntable, TurntableConfig)
    assert (config.turntable.port, config.turntable.baud, config.turntable.id) == ("/dev/ttyA", 1_000_000, 3)
    assert isinstance(config.arm, ArmConfig)
    assert (config.arm.azimuth_origin_deg, config.arm.elevation_origin_deg) == (-340.0, -85.0)
    assert config.lights is not None
    assert config.lights.kind == "grbl-spindle"
    assert config.lights.model_dump()["power"] == 255.0
    assert config.camera == CAMERA.config


@pytest.mark.parametrize("camera", [(), (CAMERA,)])
@pytest.mark.parametrize("controllers", [(), (CONTROLLER,), (FoundController("/dev/ttyB", "", {}),)])
@pytest.mark.parametrize("servos", [(), (SERVOS,), (FoundServos("/dev/ttyA", 57600, {1: 9999}),)])
def test_whatever_was_found_can_be_read(
    tmp_path: Path,
    servos: tuple[FoundServos, ...],
    controllers: tuple[FoundController, ...],
    camera: tuple[FoundCamera, ...],
) -> None:
    silent = (Silent("/dev/ttyC", "opens, but\nnobody answers"),)
    config = read_back(Discovery(servos, controllers, camera, silent), tmp_path)
    assert (config.turntable is None, config.arm is None, config.camera is None) == (
        not servos,
        not controllers,
        not camera,
    )
    assert config.lights is not None


def test_the_defaults_that_are_commented_out_are_the_defaults() -> None:
    text = write_rig_toml(Discovery((SERVOS,), (CONTROLLER,), (CAMERA,)))
    full = "\n".join(line.removeprefix("# ") for line in text.splitlines() if " = " in line or line.startswith("["))
    spelt_out = "\n".join(line for line in full.splitlines() if "= …" not in line)
    assert RigConfig.model_validate(tomllib.loads(spelt_out)) == RigConfig.model_validate(tomllib.loads(text))


def test_others_of_a_kind_and_what_is_silent_are_told() -> None:
    second = FoundServos("/dev/ttyD", 57600, {1: 1060})
    text = write_rig_toml(Discovery((SERVOS, second), silent=(Silent("/dev/ttyC", "permission denied"),)))
    assert "# There is also servo 8 on the same bus." in text
    assert "# There is also servos 1 on /dev/ttyD at 57600 baud." in text
    assert "# /dev/ttyC: permission denied" in text
    assert "# no GRBL controller answers. If there is one" in text
