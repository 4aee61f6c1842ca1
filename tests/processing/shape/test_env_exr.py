import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import pytest

from litrig.base.errors import FormatError, InputError
from processing.shape.env_exr import KEY, check_room, read_environments, write_environments
from processing.shape.model import Environments
from tests.processing.shape.scene import environments

GOOD = environments(8)


def test_what_is_written_is_read_bit_by_bit(tmp_path: Path) -> None:
    write_environments(tmp_path / "x.env.exr", GOOD)
    found = read_environments(tmp_path / "x.env.exr")
    assert list(found) == [2, 7]
    for number, one in GOOD.items():
        for field in ("front", "back", "diffuse"):
            np.testing.assert_array_equal(getattr(found[number], field), getattr(one, field))


def test_another_reader_finds_parts_and_coefficients(tmp_path: Path) -> None:
    write_environments(tmp_path / "x.env.exr", GOOD, "abc")
    with OpenEXR.File(str(tmp_path / "x.env.exr")) as exr:
        names = [part.name() for part in exr.parts]
        assert names == ["surface.2.front", "surface.2.back", "surface.7.front", "surface.7.back"]
        told = json.loads(exr.parts[0].header[KEY])
        np.testing.assert_array_equal(exr.parts[2].channels["RGB"].pixels, GOOD[7].front)
    np.testing.assert_allclose(told["diffuse"]["7"], GOOD[7].diffuse)
    assert told["source"] == "abc"


def test_light_before_albedo_is_told_from_shading(tmp_path: Path) -> None:
    mixed = {
        2: dataclasses.replace(GOOD[2], diffuse_is_illumination=True),
        7: dataclasses.replace(GOOD[7], diffuse_is_illumination=True, reflection_is_illumination=True),
    }
    write_environments(tmp_path / "x.env.exr", mixed)
    found = read_environments(tmp_path / "x.env.exr")
    assert [one.diffuse_is_illumination for one in found.values()] == [True, True]
    assert [one.reflection_is_illumination for one in found.values()] == [False, True]


def test_files_of_before_albedo_hold_shading(tmp_path: Path) -> None:
    rewritten(tmp_path / "x.env.exr", without=("diffuse_is_illumination", "reflection_is_illumination"))
    found = read_environments(tmp_path / "x.env.exr")
    assert not any(one.diffuse_is_illumination or one.reflection_is_illumination for one in found.values())


def test_surfaces_without_reflections_are_read_again_however_well_they_pack(tmp_path: Path) -> None:
    black = np.zeros((512, 512, 3), np.float32)
    light = dataclasses.replace(GOOD[2], front=black, back=black)
    write_environments(tmp_path / "x.env.exr", dict.fromkeys(range(1, 12), light))
    assert len(read_environments(tmp_path / "x.env.exr")) == 11


@pytest.mark.parametrize(
    ("surfaces", "regions", "size", "reason"),
    [
        (257, 1, 8, "holds 256 surfaces at most, and not 257; choose those to edit with --surface"),
        (3, 64, 4096, "73.1 GiB of environments, and takes 8 at most"),
        (22, 1, 4096, "8.2 GiB of environments, and takes 8 at most"),
    ],
)
def test_more_than_a_file_holds_is_refused_before_the_work(surfaces: int, regions: int, size: int, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        check_room(Path("x.env.exr"), surfaces, regions, size)
    check_room(Path("x.env.exr"), 21, 1, 4096)
    check_room(Path("x.env.exr"), 256, 1, 512)


@pytest.mark.parametrize(
    ("name", "light", "reason"),
    [
        ("x.exr", GOOD, "end the name in .env.exr"),
        ("x.env.exr", {}, "are not square"),
        ("x.env.exr", {2: GOOD[2], 7: environments(4)[7]}, "of one size"),
        ("x.env.exr", {2: dataclasses.replace(GOOD[2], back=GOOD[2].back * np.nan)}, "no number"),
        ("x.env.exr", {2: dataclasses.replace(GOOD[2], diffuse=GOOD[2].diffuse[:4])}, "nine finite coefficients"),
        ("x.env.exr", {0: GOOD[2]}, "greater than or equal to 1"),
    ],
    ids=["ending", "none", "sizes", "NaN", "coefficients", "background"],
)
def test_what_are_no_environments_are_not_written(tmp_path: Path, name: str, light: Environments, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        write_environments(tmp_path / name, light)
    assert not any(tmp_path.iterdir())


def rewritten(path: Path, keep: slice = slice(None), without: tuple[str, ...] = (), **changes: Any) -> None:
    write_environments(path, GOOD)
    with OpenEXR.File(str(path)) as exr:
        parts = [(dict(part.header), part.channels["RGB"].pixels.copy()) for part in exr.parts][keep]
    kept = ("type", "name", "displayWindow", "litrig.kind", KEY)
    made = []
    for header, texels in parts:
        head = {name: value for name, value in header.items() if name in kept}
        told = {key: value for key, value in json.loads(head[KEY]).items() if key not in without}
        head[KEY] = json.dumps({**told, **changes})
        made.append(OpenEXR.Part(head, {"RGB": texels}))
    OpenEXR.File(made).write(str(path))


@pytest.mark.parametrize(
    ("keep", "changes", "reason"),
    [
        (slice(3), {}, "has parts surface.2.front, surface.2.back, surface.7.front, not"),
        (slice(None), {"diffuse": {"2": [[0, 0, 0]] * 9}}, "has parts"),
        (slice(None), {"diffuse": {}}, "diffuse"),
        (slice(None), {"diffuse": {"2": [[0, 0, 0]] * 8}}, r"diffuse\.2"),
        (slice(None), {"what": 1}, "what"),
        (
            slice(None),
            {"regions": {"2": {"falloff": 1, "centres": [[0, 0, 0]] * 2, "diffuse": [[[0, 0, 0]] * 9]}}},
            "2 centres for 1 regions",
        ),
        (
            slice(None),
            {"regions": {"3": {"falloff": 1, "centres": [[0, 0, 0]], "diffuse": [[[0, 0, 0]] * 9]}}},
            "regions of surface 3",
        ),
        (slice(None), {"diffuse_is_illumination": [9]}, "illumination of surface 9, which has no coefficients"),
    ],
    ids=[
        "a part short",
        "a surface short",
        "no surface",
        "a coefficient short",
        "an unknown key",
        "a region short",
        "regions of nothing",
        "a stranger",
    ],
)
def test_a_file_that_contradicts_itself_is_refused(
    tmp_path: Path, keep: slice, changes: dict[str, Any], reason: str
) -> None:
    rewritten(tmp_path / "x.env.exr", keep, **changes)
    with pytest.raises(FormatError, match=reason) as caught:
        read_environments(tmp_path / "x.env.exr")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("share", [0.0, 0.05, 0.4, 0.9])
def test_a_file_cut_short_is_refused(tmp_path: Path, share: float) -> None:
    write_environments(tmp_path / "x.env.exr", GOOD)
    content = (tmp_path / "x.env.exr").read_bytes()
    (tmp_path / "x.env.exr").write_bytes(content[: int(share * len(content))])
    with pytest.raises(FormatError, match=r"x\.env\.exr"):
        read_environments(tmp_path / "x.env.exr")
