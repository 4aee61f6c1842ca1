import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from litrig.base.errors import FormatError, InputError
from processing.ptm.basis import PTM, Basis
from processing.ptm.files.web_folder import describe_web_folder, read_web_folder, write_web_folder
from processing.ptm.model import Colour, Ptm, Space
from processing.ptm.relighting.relight import relight
from tests.processing.ptm.files.fitted import SIZE, fitted, small
from tests.processing.ptm.files.plain_web_folder import plain_picture

BASES = [PTM, Basis("ptm", 3), Basis("hsh", 4), Basis("hsh", 9)]
SOME_LIGHTS = [(0.0, 0.0), (0.6, 0.3), (-0.2, 0.8), (-0.5, -0.5)]


@pytest.mark.parametrize("colour", ["lrgb", "rgb"])
@pytest.mark.parametrize("basis", BASES, ids=str)
def test_another_reader_sees_the_same_pictures(tmp_path: Path, basis: Basis, colour: Colour) -> None:
    """Two JPEG decoders differ by a code here and there."""
    material = fitted(basis, colour)
    write_web_folder(tmp_path / "w", material)
    for light in SOME_LIGHTS:
        seen = plain_picture(tmp_path / "w", *light)
        assert seen == pytest.approx(relight(read_web_folder(tmp_path / "w"), np.array(light)), abs=0.05)
        assert np.sqrt(np.mean((seen - relight(material, np.array(light))) ** 2)) < 0.02


@pytest.mark.parametrize("basis", BASES, ids=str)
def test_luminance_stays_apart_where_readers_know_it(tmp_path: Path, basis: Basis) -> None:
    write_web_folder(tmp_path / "w", fitted(basis, "lrgb"))
    info = json.loads((tmp_path / "w" / "info.json").read_text())
    wanted = ("lrgb", basis.terms + 3) if basis.kind == "ptm" else ("rgb", 3 * basis.terms)
    assert (info["colorspace"], info["nplanes"]) == wanted
    assert len(list((tmp_path / "w").glob("plane_*.jpg"))) == info["nplanes"] // 3
    assert all(0 <= bias <= 1 for bias in info["materials"][0]["bias"])


@pytest.mark.parametrize("space", ["srgb", "linear"])
def test_basis_colour_space_and_source_survive(tmp_path: Path, space: Space) -> None:
    write_web_folder(tmp_path / "w", small(PTM, "lrgb", space))
    again = read_web_folder(tmp_path / "w")
    assert (again.basis, again.kind, again.space, again.source) == (PTM, "lrgb", space, "abc123")


def test_a_lower_quality_makes_smaller_files(tmp_path: Path) -> None:
    material = fitted(PTM, "rgb")
    for quality in (100, 90):
        write_web_folder(tmp_path / str(quality), material, quality=quality)
    fine, coarse = (sum(file.stat().st_size for file in (tmp_path / name).iterdir()) for name in ("100", "90"))
    assert coarse < 0.6 * fine


def test_luminance_of_hemispherical_harmonics_is_read(tmp_path: Path) -> None:
    """Seven planes in three JPEGs, of which the last holds one."""
    folder = foreign_folder(tmp_path, type="hsh", colorspace="lrgb", planes=7)
    material = read_web_folder(folder)
    assert (material.kind, material.basis) == ("lrgb", Basis("hsh", 4))
    assert material.coefficients[3, 0, 0, 0] == pytest.approx((60 / 255 - 0.5) * 2, abs=0.02)


def foreign_folder(tmp_path: Path, *, planes: int = 9, **changes: Any) -> Path:
    """Write what another program might: plane k is 10·k all over, YCbCr JPEGs."""
    folder = tmp_path / "foreign"
    folder.mkdir()
    for number in range((planes + 2) // 3):
        picture = np.zeros((16, 24, 3), np.uint8)
        picture[:] = [10 * (3 * number + channel) for channel in (2, 1, 0)]
        cv2.imwrite(str(folder / f"plane_{number}.jpg"), picture, [cv2.IMWRITE_JPEG_QUALITY, 100])
    info = {
        "width": 24,
        "height": 16,
        "format": "jpg",
        "type": "ptm",
        "colorspace": "lrgb",
        "lights": [0.1, 0.2, 0.9],
        "nplanes": planes,
        "quality": 95,
        "colorprofile": "sRGB",
        "materials": [{"scale": [1, 1, 1] + [2] * (planes - 3), "bias": [0, 0, 0] + [0.5] * (planes - 3)}],
    }
    (folder / "info.json").write_text(json.dumps({**info, **changes}))
    return folder


def test_what_others_write_is_read(tmp_path: Path) -> None:
    material = read_web_folder(foreign_folder(tmp_path))
    assert material.colour is not None
    assert material.colour[3, 5] * 255 == pytest.approx([0, 10, 20], abs=2)
    # Planes 3 to 8 are 1, u, v, u², uv, v²; the model has u², v², uv, u, v, 1.
    codes = np.array([60, 80, 70, 40, 50, 30])
    assert material.coefficients[:, 3, 5, 0] == pytest.approx((codes / 255 - 0.5) * 2, abs=0.02)
    assert (material.space, material.source) == ("srgb", "")


def test_it_is_described_from_its_head(tmp_path: Path) -> None:
    folder = foreign_folder(tmp_path)
    for plane in folder.glob("plane_*"):
        plane.unlink()
    facts = describe_web_folder(folder)
    assert (facts["width"], facts["height"], facts["basis"], facts["colour"]) == (24, 16, "PTM of 6 terms", "lrgb")
    assert facts["coefficients"] == dict.fromkeys(PTM.names, (-1, 1))


def test_memory_is_taken_only_for_sizes_that_a_plane_confirms(tmp_path: Path) -> None:
    """29 GB for 18 planes, of JPEGs of a few hundred bytes."""
    material = {"scale": [1] * 18, "bias": [0] * 18}
    folder = foreign_folder(tmp_path, planes=18, colorspace="rgb", width=20_000, height=20_000, materials=[material])
    with pytest.raises(FormatError, match=r"plane_0\.jpg: is 24 × 16 pixels, where 20000 × 20000"):
        read_web_folder(folder)


NO_NUMBER = {"scale": [1] * 8 + [float("nan")], "bias": [0] * 9}


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        pytest.param({"type": "rbf"}, "type is 'rbf'; ptm and hsh are read", id="another basis"),
        pytest.param({"colorspace": "mrgb"}, "colorspace is 'mrgb'", id="principal components"),
        pytest.param({"nplanes": 8}, "8 planes make no lrgb ptm", id="five terms"),
        pytest.param({"nplanes": 10**9}, "nplanes: .*less than or equal to 64", id="planes without end"),
        pytest.param({"width": 10**30}, "width: ", id="a width of thirty digits"),
        pytest.param({"width": 100_000, "height": 100_000}, "claims 100000 × 100000", id="a head of gigabytes"),
        pytest.param({"width": 23}, "plane_0.jpg: is 24 × 16 pixels, where 23 × 16", id="another width"),
        pytest.param({"materials": [NO_NUMBER]}, r"scale\.8: .*finite", id="a scale that is no number"),
        pytest.param(
            {"materials": [{"scale": [1] * 8, "bias": [0] * 9}]}, "8 scales and 9 biases for 9", id="a scale short"
        ),
        pytest.param({"materials": []}, "materials: ", id="no material"),
        pytest.param({"materials": [{}]}, r"materials\.0\.scale' is missing", id="no scales"),
        pytest.param({"litrig": {"space": "lab"}}, "space 'lab'", id="an unknown space"),
    ],
)
def test_a_lie_in_the_head_is_named(tmp_path: Path, changes: dict[str, Any], reason: str) -> None:
    with pytest.raises(FormatError, match=rf"foreign/.*{reason}") as refused:
        read_web_folder(foreign_folder(tmp_path, **changes))
    assert len(str(refused.value)) < 1000


@pytest.mark.parametrize("content", [b"", b"{", b"[" * 100_000, b'{"a":' * 100_000, b"1" * 9999, b"\xff\xd8"])
def test_what_is_no_json_is_refused(tmp_path: Path, content: bytes) -> None:
    folder = foreign_folder(tmp_path)
    (folder / "info.json").write_bytes(content)
    with pytest.raises(FormatError, match=r"info\.json: "):
        read_web_folder(folder)


def cut(plane: Path) -> None:
    plane.write_bytes(plane.read_bytes()[:-40])


def grey(plane: Path) -> None:
    cv2.imwrite(str(plane), np.zeros((16, 24), np.uint8))


def tiles(plane: Path) -> None:
    for other in plane.parent.glob("plane_*.jpg"):
        other.unlink()
    plane.with_suffix(".dzi").write_text("<xml/>")


@pytest.mark.parametrize(
    ("harm", "reason"),
    [
        pytest.param(Path.unlink, r"plane_0\.jpg: no such file", id="gone"),
        pytest.param(cut, r"plane_0\.jpg: is a damaged JPEG", id="cut short"),
        pytest.param(grey, r"plane_0\.jpg: is a grey JPEG", id="grey"),
        pytest.param(tiles, "is cut into tiles, which are not read", id="tiles"),
        pytest.param(lambda plane: plane.write_bytes(b"\x89PNG"), r"plane_0\.jpg: is a damaged JPEG", id="a PNG"),
    ],
)
def test_a_harmed_plane_is_named(tmp_path: Path, harm: Callable[[Path], Any], reason: str) -> None:
    folder = foreign_folder(tmp_path)
    harm(folder / "plane_0.jpg")
    with pytest.raises(InputError, match=f"foreign.*{reason}"):
        read_web_folder(folder)


def test_an_empty_folder_is_filled_and_any_other_left_alone(tmp_path: Path) -> None:
    (tmp_path / "w").mkdir()
    write_web_folder(tmp_path / "w", small(PTM, "rgb"))
    before = {file: file.read_bytes() for file in (tmp_path / "w").iterdir()}
    with pytest.raises(InputError, match=r"w: holds files already"):
        write_web_folder(tmp_path / "w", small(PTM, "lrgb"))
    assert {file: file.read_bytes() for file in (tmp_path / "w").iterdir()} == before
    assert list(tmp_path.iterdir()) == [tmp_path / "w"]


def test_a_fit_that_fails_leaves_no_folder(tmp_path: Path) -> None:
    material = small(PTM, "lrgb")
    broken = Ptm(np.full_like(material.coefficients, np.inf), material.colour)
    with pytest.raises(InputError, match="w: coefficients that are not numbers"):
        write_web_folder(tmp_path / "w", broken)
    assert not list(tmp_path.iterdir())


def test_a_picture_wider_than_a_jpeg_is_refused(tmp_path: Path) -> None:
    wide = Ptm(np.zeros((6, 1, 65_501, 3), np.float32), None)
    with pytest.raises(InputError, match=r"JPEGs end at 65,500 pixels a side; write a \.ptm\.exr"):
        write_web_folder(tmp_path / "w", wide)
    assert not list(tmp_path.iterdir())


def test_odd_sizes_come_back(tmp_path: Path) -> None:
    material = fitted(PTM, "rgb")
    part = Ptm(material.coefficients[:, : SIZE - 3, : SIZE - 9], None)
    write_web_folder(tmp_path / "w", part)
    assert read_web_folder(tmp_path / "w").coefficients.shape == part.coefficients.shape
