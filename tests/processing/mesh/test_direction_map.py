"""Direction maps from files: numbers, not colours."""

from pathlib import Path

import cv2
import numpy as np
import OpenEXR
import pytest

from litrig.base.errors import FormatError, InputError
from processing.mesh.direction_map import read_directions


@pytest.mark.parametrize("ending", [".png", ".tif"])
@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
def test_codes_are_taken_as_they_are(tmp_path: Path, ending: str, kind: type[np.integer]) -> None:
    """Without an sRGB curve: half of the codes is half of the way."""
    most = np.iinfo(kind).max
    blue_green_red = np.array([[[7, most, 0], [9, most // 5, most // 5 * 4]]], kind)
    cv2.imwrite(str(tmp_path / f"map{ending}"), blue_green_red)
    found = read_directions(tmp_path / f"map{ending}")
    assert found.dtype == np.float32
    np.testing.assert_allclose(found, np.array([[[-1, 1], [0.6, -0.6]]]), atol=1e-6)


def test_an_exr_has_the_same_scale(tmp_path: Path) -> None:
    rgb = np.array([[[0.5, 1.0, 0.3], [0.0, 0.25, 0.9]]], np.float32)
    OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGB": rgb}).write(str(tmp_path / "map.exr"))
    np.testing.assert_allclose(read_directions(tmp_path / "map.exr"), np.array([[[0, 1], [-1, -0.5]]]), atol=1e-6)


@pytest.mark.parametrize("value", [-0.1, 1.1])
def test_values_beyond_the_scale_are_refused(tmp_path: Path, value: float) -> None:
    """A map that stores −1..1 would be read as another one."""
    rgb = np.full((2, 2, 3), 0.5, np.float32)
    rgb[1, 1, 1] = value
    OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGB": rgb}).write(str(tmp_path / "map.exr"))
    with pytest.raises(InputError, match=r"map\.exr: red and green reach beyond 0\.\.1; store"):
        read_directions(tmp_path / "map.exr")


@pytest.mark.parametrize("name", ["map.jpg", "map.txt", "map"])
def test_other_formats_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match="use PNG or EXR"):
        read_directions(tmp_path / name)


def test_a_missing_map_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no\.png: no such file"):
        read_directions(tmp_path / "no.png")


def test_a_damaged_map_is_named(tmp_path: Path) -> None:
    (tmp_path / "map.png").write_bytes(b"\x89PNG\r\n")
    with pytest.raises(FormatError, match=r"map\.png"):
        read_directions(tmp_path / "map.png")
