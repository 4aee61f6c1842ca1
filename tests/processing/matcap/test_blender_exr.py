"""Blender's MatCaps, read back by OpenEXR's own channels."""

import dataclasses
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from click.testing import CliRunner

from litrig.base.errors import FormatError, InputError
from processing.matcap.blender_exr import is_blender_matcap, read_blender_matcap, write_blender_matcap
from processing.matcap.cli import matcap
from processing.matcap.disc import disc_normals
from processing.matcap.matcap_exr import read_matcap, write_matcap
from processing.matcap.render import disc_picture, half_pictures
from tests.processing.matcap.maps import analytic

RNG = np.random.default_rng(2)
HALVES = RNG.random((2, 6, 6, 3), np.float32)
COLOURS = [f"{name}.{colour}" for name in ("diffuse", "specular") for colour in "RGB"]


def raw(path: Path, channels: dict[str, np.ndarray]) -> Path:
    """Write channels as another program would."""
    OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}, channels).write(str(path))
    return path


def planes(prefix: str = "", names: list[str] = COLOURS) -> dict[str, np.ndarray]:
    every = dict(zip(COLOURS, HALVES.transpose(0, 3, 1, 2).reshape(6, 6, 6), strict=True))
    return {prefix + name: np.ascontiguousarray(every[name]) for name in names}


def test_both_passes_are_written_as_blender_names_them(tmp_path: Path) -> None:
    write_blender_matcap(tmp_path / "x.exr", HALVES[0], HALVES[1])
    with OpenEXR.File(str(tmp_path / "x.exr"), separate_channels=True) as exr:
        assert len(exr.parts) == 1
        channels = {name: channel.pixels for name, channel in exr.channels().items()}
    assert sorted(channels) == sorted(COLOURS)
    for name, plane in planes().items():
        np.testing.assert_allclose(channels[name], plane, rtol=1e-3)
        assert channels[name].dtype == np.float16


@pytest.mark.parametrize("prefix", ["", "View Layer."])
def test_passes_are_read_whatever_layer_they_are_in(tmp_path: Path, prefix: str) -> None:
    extra = {f"{prefix}Combined.{colour}": np.ones((6, 6), np.float32) for colour in "RGBA"}
    alpha = {f"{prefix}diffuse.A": np.ones((6, 6), np.float32)}
    path = raw(tmp_path / "x.exr", {**planes(prefix), **extra, **alpha})
    assert is_blender_matcap(path)
    for found, wanted in zip(read_blender_matcap(path), HALVES, strict=True):
        np.testing.assert_array_equal(found, wanted)


def test_other_pictures_are_none(tmp_path: Path) -> None:
    assert not is_blender_matcap(raw(tmp_path / "x.exr", {"RGB": HALVES[0]}))
    (tmp_path / "y.exr").write_bytes(b"no EXR")
    assert not is_blender_matcap(tmp_path / "y.exr")
    assert not is_blender_matcap(tmp_path / "z.exr")
    assert not is_blender_matcap(tmp_path / "x.png")


def test_a_file_that_lacks_something_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"lacks channel specular\.G"):
        read_blender_matcap(raw(tmp_path / "x.exr", planes(names=[*COLOURS[:4], COLOURS[5]])))
    broken = planes()
    broken["diffuse.R"][2, 2] = np.nan
    with pytest.raises(FormatError, match="pass diffuse holds values that are no numbers"):
        read_blender_matcap(raw(tmp_path / "y.exr", broken))
    with pytest.raises(InputError, match="no such file"):
        read_blender_matcap(tmp_path / "none.exr")
    (tmp_path / "cut.exr").write_bytes((tmp_path / "x.exr").read_bytes()[:300])
    with pytest.raises(FormatError, match=r"cut\.exr"):
        read_blender_matcap(tmp_path / "cut.exr")
    with pytest.raises(InputError, match=r"end the name in \.exr"):
        write_blender_matcap(tmp_path / "x.png", HALVES[0], HALVES[1])


def test_it_is_decomposed_without_being_split(tmp_path: Path) -> None:
    """The halves of the picture that comes back are the passes, whatever a split would make of their sum."""
    low, high = half_pictures(analytic(64), 48)
    write_blender_matcap(tmp_path / "x.exr", low, high)
    arguments = ["decompose", str(tmp_path / "x.exr"), "-o", str(tmp_path / "y.matcap.exr"), "--slopes", "0.3", "0.9"]
    assert CliRunner().invoke(matcap, arguments, catch_exceptions=False).exit_code == 0
    normals, _ = disc_normals(48)
    inner = normals[..., 2] > 0.4
    for found, wanted in zip(half_pictures(read_matcap(tmp_path / "y.matcap.exr")), (low, high), strict=True):
        np.testing.assert_allclose(found[inner], wanted[inner], atol=0.01)


def test_the_command_writes_halves_that_add_up_to_the_picture(tmp_path: Path) -> None:
    gold = dataclasses.replace(analytic(32), picture_size=24)
    write_matcap(tmp_path / "gold.matcap.exr", gold)
    arguments = ["export", str(tmp_path / "gold.matcap.exr"), "-o", str(tmp_path / "x.exr")]
    assert CliRunner().invoke(matcap, arguments, catch_exceptions=False).exit_code == 0
    low, high = read_blender_matcap(tmp_path / "x.exr")
    np.testing.assert_allclose(low + high, disc_picture(gold), atol=2e-3)
    assert low.shape == (24, 24, 3) and high.std() > 0.02
    with pytest.raises(InputError, match="is a name of litrig's own"):
        CliRunner().invoke(matcap, [*arguments[:-1], str(tmp_path / "y.matcap.exr")], catch_exceptions=False)


def test_light_that_half_floats_cannot_hold_is_cut_off_and_told(tmp_path: Path) -> None:
    bright = analytic(16)
    low = dataclasses.replace(bright.low, base_colour=(1e6, 1e6, 1e6))
    write_matcap(tmp_path / "x.matcap.exr", dataclasses.replace(bright, low=low, picture_size=16))
    found = CliRunner().invoke(matcap, ["export", str(tmp_path / "x.matcap.exr"), "-o", str(tmp_path / "x.exr")])
    assert found.exit_code == 0 and "is cut off at 65504" in found.stderr
    assert read_blender_matcap(tmp_path / "x.exr")[0].max() == 65504
