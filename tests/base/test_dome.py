import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from litrig.base.errors import FormatError, InputError
from litrig.base.light_files import read_lights

DIRECTIONS = [{"x": 0, "y": 0, "z": 0.5}, {"x": 0.6, "y": 0, "z": 0.8}]
DOME: dict[str, Any] = {
    "label": "RelightLab's dome",
    "notes": "",
    "imageWidth": 0,
    "domeDiameter": 0,
    "verticalOffset": 0,
    "lightConfiguration": "directional",
    "directions": DIRECTIONS,
    "positionsSphere": [],
    "positions3d": [],
    "ledAdjust": [],
}


def write_dome(folder: Path, **changes: Any) -> Path:
    (folder / "x.dome").write_text(json.dumps({**DOME, **changes}))
    return folder / "x.dome"


def test_directions_come_unit_and_without_names(tmp_path: Path) -> None:
    lights = read_lights(write_dome(tmp_path))
    assert lights.directions == pytest.approx(np.array([[0, 0, 1], [0.6, 0, 0.8]]))
    assert (lights.names, lights.positions_mm, lights.picture_width_mm, lights.gains) == (None, None, None, None)


def test_a_sphere_puts_lights_at_its_radius_above_the_sample(tmp_path: Path) -> None:
    sphere = {"lightConfiguration": "spherical", "domeDiameter": 600, "verticalOffset": 20, "imageWidth": 150}
    lights = read_lights(write_dome(tmp_path, **sphere))
    assert lights.positions_mm == pytest.approx(np.array([[0, 0, 320], [180, 0, 260]]))
    assert lights.directions[1] == pytest.approx(np.array([180, 0, 260]) / np.hypot(180, 260))
    assert lights.picture_width_mm == 150


@pytest.mark.parametrize(
    ("configuration", "key"), [("spherical", "positionsSphere"), ("lights3d", "positions3d")], ids=["sphere", "free"]
)
def test_positions_that_the_file_holds_are_taken(tmp_path: Path, configuration: str, key: str) -> None:
    positions = [{"x": 0, "y": -30, "z": 40}]
    lights = read_lights(write_dome(tmp_path, lightConfiguration=configuration, imageWidth=80, **{key: positions}))
    assert lights.positions_mm == pytest.approx(np.array([[0, -30, 40]]))
    assert lights.directions == pytest.approx(np.array([[0, -0.6, 0.8]]))


def test_free_lights_of_a_picture_without_a_size_are_in_its_widths(tmp_path: Path) -> None:
    lights = read_lights(write_dome(tmp_path, lightConfiguration="lights3d", positions3d=[{"x": 0, "y": 0, "z": 2.5}]))
    assert lights.positions_mm == pytest.approx(np.array([[0, 0, 2.5]]))
    assert lights.picture_width_mm == 1


def test_corrections_of_the_lamps_are_gains(tmp_path: Path) -> None:
    lights = read_lights(write_dome(tmp_path, ledAdjust=[{"r": 1, "g": 1.5, "b": 2}, {"r": 1, "g": 1, "b": 0.5}]))
    assert lights.gains == pytest.approx(np.array([[1, 1.5, 2], [1, 1, 0.5]]))


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        pytest.param({"directions": []}, "directional dome of 0 lights", id="no light"),
        pytest.param({"directions": [{"x": 0, "y": 0, "z": 0}]}, "light 1 is at a distance of 0", id="no direction"),
        pytest.param({"directions": [{"x": 0, "y": 0}]}, r"directions\.0\.z' is missing", id="two numbers"),
        pytest.param({"directions": DIRECTIONS * 5001}, "at most 10000", id="too many lights"),
        pytest.param({"directions": [{}] * 500_000}, "directions", id="too many empty lights"),
        pytest.param({"lightConfiguration": "ring"}, "lightConfiguration", id="an unknown arrangement"),
        pytest.param({"lightConfiguration": "lights3d"}, "lights3d dome of 0 lights", id="no positions"),
        pytest.param({"lightConfiguration": "spherical"}, "sphere of diameter 0 mm", id="a sphere without a size"),
        pytest.param({"imageWidth": -3}, "imageWidth is -3 mm", id="a negative width"),
        pytest.param({"imageWidth": float("nan")}, "imageWidth: .*finite", id="not a number"),
        pytest.param({"ledAdjust": [{"r": 1, "g": 1, "b": 1}]}, "2 factors above 0", id="a correction for one of two"),
        pytest.param({"ledAdjust": [{"r": 1, "g": 0, "b": 1}] * 2}, "2 factors above 0", id="a lamp times nothing"),
    ],
)
def test_a_bad_dome_is_refused_with_its_reason(tmp_path: Path, changes: dict[str, Any], reason: str) -> None:
    with pytest.raises(FormatError, match=rf"x\.dome: .*{reason}") as refused:
        read_lights(write_dome(tmp_path, **changes))
    assert len(str(refused.value)) < 1000


@pytest.mark.parametrize("content", [b"", b"{", b"[" * 100_000, b'{"a":' * 100_000, b"1" * 5000, b"\xff\xd8\xff\xe0"])
def test_what_is_no_json_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "x.dome").write_bytes(content)
    with pytest.raises(FormatError, match=r"x\.dome: "):
        read_lights(tmp_path / "x.dome")


def test_a_dome_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"gone\.dome: no such file"):
        read_lights(tmp_path / "gone.dome")
