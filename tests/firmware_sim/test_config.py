import tomllib
from pathlib import Path

import pytest

from firmware_sim.config import ReliefScene, SimConfig, SphereScene, read_sim
from firmware_sim.errors import SimConfigError
from firmware_sim.mitsuba.config import MitsubaScene
from firmware_sim.rig_toml import rig_toml
from firmware_sim.udmx.config import DomeSim
from tests.firmware_sim.conftest import ROOT

EXAMPLES = ROOT / "examples"


def test_the_amc_example_states_every_default() -> None:
    path = EXAMPLES / "sim-amc.toml"
    assert read_sim(path) == SimConfig()
    stated = tomllib.loads(path.read_text("utf-8"))
    assert stated.keys() == SimConfig.model_fields.keys() - {"dome", "stepper"}, "a stepper takes the servo's place"
    for name, table in stated.items():
        assert table.keys() == type(getattr(SimConfig(), name)).model_fields.keys()


def test_the_ptm_example_is_the_relief() -> None:
    assert read_sim(EXAMPLES / "sim-ptm.toml") == SimConfig(scene=ReliefScene())


@pytest.mark.parametrize(
    ("stepper", "kind"),
    [
        pytest.param({"axis": "X"}, 'zero = "switch"', id="on a controller of its own"),
        pytest.param({"axis": "A", "on_the_arm": True}, 'port = "/arm"', id="on the arm's"),
    ],
)
def test_a_stepper_is_described_in_the_servos_place(stepper: dict[str, object], kind: str) -> None:
    config = SimConfig.model_validate({"stepper": {"switch_deg": 360, **stepper}})
    text = rig_toml(config, "/arm" if config.stepper is not None and config.stepper.on_the_arm else "/table", "/arm")
    assert kind in text
    assert "dynamixel" not in text


def test_the_dome_example_states_every_default_of_a_dome() -> None:
    path = EXAMPLES / "sim-dome.toml"
    config = read_sim(path)
    assert config.dome == DomeSim()
    stated = tomllib.loads(path.read_text("utf-8"))["dome"]
    assert stated.keys() == DomeSim.model_fields.keys() - {"swapped"}


BROKEN = [
    ("[dome]", "a [dome] lights the scene of kind relief only", "a dome over a sphere"),
    (
        "[dome]\nlamps = 9\ndead = [9]\n[scene]\nkind = 'relief'",
        "there are lamps 0..8 only",
        "a lamp that is not there",
    ),
    ("[dome]\nlamps = 300\nsixteen_bit = true\n[scene]\nkind = 'relief'", "more than 512 slots", "too many lamps"),
    ("[turntable]\nidd = 1", "unknown key 'turntable.idd'; remove it or mend its spelling", "a misspelt key"),
    ("[turntable]\nbaud = 1234", "turntable.baud: Input should be", "a speed that no servo has"),
    ("[camera]\nexposure_ms = 0", "camera.exposure_ms: Input should be greater", "no exposure"),
    ("[camera]\nfps = nan", "camera.fps", "not a number"),
    ('[scene]\nkind = "teapot"', "scene: Input tag 'teapot'", "a scene that does not exist"),
    ('[scene]\nkind = "relief"\nradius_px = 3', "unknown key 'scene.relief.radius_px'", "another scene's key"),
    ("[turntable", "not valid TOML", "no TOML"),
]


@pytest.mark.parametrize(("text", "complaint"), [row[:2] for row in BROKEN], ids=[row[2] for row in BROKEN])
def test_a_broken_file_is_named_with_its_misfit(tmp_path: Path, text: str, complaint: str) -> None:
    path = tmp_path / "SIM.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SimConfigError, match=f"{path}: ") as caught:
        read_sim(path)
    assert complaint in str(caught.value)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(SimConfigError, match=r"nowhere\.toml: no such file"):
        read_sim(tmp_path / "nowhere.toml")


def test_a_file_that_is_no_text_is_named(tmp_path: Path) -> None:
    path = tmp_path / "SIM.toml"
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(SimConfigError, match="cannot be read"):
        read_sim(path)


SPHERE = {"kind": "always-on"}
LAMP = {"kind": "grbl-spindle", "power": 1000}
BRUSHED, FABRIC = MitsubaScene(), MitsubaScene(sample="fabric", distance_radii=20, lights="near-lamp")
CARD, CHROME = MitsubaScene(sample="white-card"), MitsubaScene(sample="chrome-ball", projection="orthographic")


@pytest.mark.parametrize(
    ("scene", "name", "lights", "sample"),
    [
        pytest.param(SphereScene(), "brushed sphere", SPHERE, {"sphere_distance_radii": 8}, id="perspective sphere"),
        pytest.param(SphereScene(projection="orthographic"), "brushed sphere", SPHERE, None, id="orthographic sphere"),
        pytest.param(ReliefScene(), "relief", LAMP, None, id="relief"),
        pytest.param(BRUSHED, "rendered brushed metal", SPHERE, {"sphere_distance_radii": 8}, id="rendered sphere"),
        pytest.param(FABRIC, "rendered fabric", LAMP, {"sphere_distance_radii": 20}, id="rendered, lit by the arm"),
        pytest.param(CARD, "rendered white card", SPHERE, None, id="rendered, but no sphere"),
        pytest.param(CHROME, "rendered chrome ball", SPHERE, None, id="rendered, orthographic"),
    ],
)
def test_rig_toml_describes_the_devices(
    scene: SphereScene | ReliefScene | MitsubaScene,
    name: str,
    lights: dict[str, object],
    sample: dict[str, object] | None,
) -> None:
    rig = tomllib.loads(rig_toml(SimConfig(scene=scene), "/dev/pts/5", "/dev/pts/6"))
    assert rig == {
        "rig": {"name": f"simulated: {name}"},
        "turntable": {"kind": "dynamixel", "port": "/dev/pts/5", "baud": 57600, "id": 1, "model": "XL430-W250"},
        "arm": {
            "kind": "grbl",
            "port": "/dev/pts/6",
            "baud": 115200,
            "azimuth_origin_deg": -360,
            "elevation_origin_deg": -90,
        },
        "lights": lights,
        "camera": {
            "kind": "v4l2",
            "device": "/dev/video42",
            "width": 640,
            "height": 480,
            "fps": 30,
            "pixel_format": "MJPG",
            "exposure_ms": 10,
            "gain": 0,
        },
    } | ({"sample": sample} if sample else {})


def test_a_rendered_scene_is_chosen_by_its_kind(tmp_path: Path) -> None:
    path = tmp_path / "SIM.toml"
    path.write_text('[scene]\nkind = "mitsuba"\nsample = "fabric"\ninvariance = 3', encoding="utf-8")
    assert read_sim(path).scene == MitsubaScene(sample="fabric", invariance=3)
