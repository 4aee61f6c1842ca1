"""Files as various renderers write them become the same buffers."""

import dataclasses
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import pytest

from litrig.base.errors import FormatError, InputError
from processing.shape.buffers.camera import CameraSaid
from processing.shape.buffers_exr import ReadOptions, parse_layers, read_buffers
from processing.shape.editing.edit import edit
from processing.shape.editing.operations import Emboss, Noise, Recipe, Smooth
from processing.shape.model import ShadingBuffers
from tests.processing.shape.scene import buffers
from tests.processing.shape.stored import layers, write

GOOD = buffers()
SHOWN = GOOD.surfaces > 0
Planes = dict[str, np.ndarray]
ALBEDO = np.random.default_rng(3).uniform(0.2, 0.9, (*GOOD.shape, 3)).astype(np.float32)


def colour(name: str, plane: np.ndarray, parts: str = "RGB") -> Planes:
    return {f"{name}.{part}".lstrip("."): plane[..., index] for index, part in enumerate(parts)}


def depth_z() -> np.ndarray:
    return np.where(SHOWN, -GOOD.positions[..., 2], 1e10).astype(np.float32)


def blender() -> Planes:
    """Cycles: light apart from colour, numbers as floats, a background very far away."""
    light, mirror = GOOD.diffuse / ALBEDO, GOOD.reflection / 0.5
    return {
        **colour("ViewLayer.Combined", GOOD.picture),
        "ViewLayer.Combined.A": GOOD.coverage,
        **colour("ViewLayer.DiffDir", light * 0.75),
        **colour("ViewLayer.DiffInd", light * 0.25),
        **colour("ViewLayer.DiffCol", ALBEDO),
        **colour("ViewLayer.GlossDir", mirror * 0.5),
        **colour("ViewLayer.GlossInd", mirror * 0.5),
        **colour("ViewLayer.GlossCol", np.full_like(mirror, 0.5)),
        **colour("ViewLayer.Normal", GOOD.normals, "XYZ"),
        "ViewLayer.Depth.Z": depth_z(),
        "ViewLayer.IndexOB.X": GOOD.surfaces.astype(np.float32),
        **colour("ViewLayer.AO", np.repeat(GOOD.ambient_occlusion[..., None], 3, axis=-1)),
    }


def arnold() -> Planes:
    return {
        **colour("", GOOD.picture),
        "A": GOOD.coverage,
        **colour("diffuse_direct", GOOD.diffuse * 0.5),
        **colour("diffuse_indirect", GOOD.diffuse * 0.5),
        **colour("diffuse_albedo", ALBEDO),
        **colour("specular", GOOD.reflection * 0.75),
        **colour("coat", GOOD.reflection * 0.25),
        **colour("N", GOOD.normals, "XYZ"),
        **colour("P", GOOD.positions, "XYZ"),
        "Z": depth_z(),
        "ID.I": GOOD.surfaces,
    }


def modo() -> Planes:
    ids = np.zeros((*GOOD.shape, 3), np.float32)
    ids[GOOD.surfaces == 2], ids[GOOD.surfaces == 7] = (0.1, 0.5, 0.9), (0.8, 0.1, 0.3)
    return {
        **colour("Final Color", GOOD.picture),
        "Alpha.R": GOOD.coverage,
        **colour("Diffuse Shading (Total)", GOOD.diffuse),
        **colour("Reflection Shading", GOOD.reflection),
        **colour("Shading Normal", (np.where(SHOWN[..., None], GOOD.normals, 0) + 1) / 2),
        **colour("World Coordinates", GOOD.positions),
        **colour("Surface ID", ids),
        "Ambient Occlusion.R": GOOD.ambient_occlusion,
        "Reflection Occlusion.R": GOOD.reflection_occlusion,
    }


FOV_DEG = float(np.degrees(2 * np.arctan(150 / 2 / 240)))


@pytest.mark.parametrize("made", [blender, arnold, modo])
def test_layers_of_other_renderers_are_recognised(tmp_path: Path, made: Callable[[], Planes]) -> None:
    write(
        tmp_path / "x.exr",
        {name: plane.astype(np.float32) for name, plane in made().items() if name != "ID.I"}
        | {name: plane for name, plane in made().items() if name == "ID.I"},
    )
    found = read_buffers(tmp_path / "x.exr", ReadOptions(camera=CameraSaid(fov_deg=FOV_DEG)))
    for name in ("picture", "coverage", "diffuse", "reflection", "normals", "positions"):
        np.testing.assert_allclose(getattr(found, name), getattr(GOOD, name), atol=3e-6, err_msg=name)
    numbers = {0: 0, 2: 0x1A80E6, 7: 0xCC1A4C} if made is modo else {0: 0, 2: 2, 7: 7}
    np.testing.assert_array_equal(found.surfaces, np.vectorize(numbers.__getitem__)(GOOD.surfaces))
    if made is not arnold:
        np.testing.assert_allclose(found.ambient_occlusion, GOOD.ambient_occlusion, atol=1e-6)
    if made is not modo:
        np.testing.assert_allclose(found.albedo[SHOWN], ALBEDO[SHOWN])  # type: ignore[index]
    assert not found.orthographic


def test_cryptomatte_tells_surfaces_by_their_bits(tmp_path: Path) -> None:
    hashes = np.array([0, 0x3F9A1C55, 0x41000001], np.uint32)
    bits = hashes[np.select([GOOD.surfaces == 2, GOOD.surfaces == 7], [1, 2], 0)].view(np.float32)
    stored = {name: plane for name, plane in layers(GOOD).items() if name != "surface_id.I"}
    write(tmp_path / "x.exr", {**stored, "crypto_object00.R": bits, "crypto_object00.G": np.ones_like(bits)})
    found = read_buffers(tmp_path / "x.exr").surfaces
    np.testing.assert_array_equal(found == 0x3F9A1C55, GOOD.surfaces == 2)
    np.testing.assert_array_equal(found == 0x41000001, GOOD.surfaces == 7)


def test_layers_may_be_in_parts_of_their_own(tmp_path: Path) -> None:
    by_layer: dict[str, Planes] = {}
    for name, plane in layers(GOOD).items():
        layer, _, channel = name.rpartition(".")
        by_layer.setdefault(layer or "rgba", {})[channel] = np.ascontiguousarray(plane)
    parts = [OpenEXR.Part({"name": name, "type": OpenEXR.scanlineimage}, planes) for name, planes in by_layer.items()]
    OpenEXR.File(parts).write(str(tmp_path / "x.exr"))
    found = read_buffers(tmp_path / "x.exr")
    for field in dataclasses.fields(ShadingBuffers):
        if field.name not in ("albedo", "reflection_albedo", "stored_turn"):
            np.testing.assert_allclose(getattr(found, field.name), getattr(GOOD, field.name), atol=1e-6)


def test_other_names_are_said(tmp_path: Path) -> None:
    stored = {name.replace("reflection.", "spec_all."): plane for name, plane in layers(GOOD).items()}
    stored |= {f"half.{part}": stored.pop(f"diffuse.{part}") / 2 for part in "RGB"}
    write(tmp_path / "x.exr", stored)
    said = parse_layers(("reflection=spec_all", "diffuse = half + half"))
    found = read_buffers(tmp_path / "x.exr", ReadOptions(said))
    np.testing.assert_array_equal(found.reflection, GOOD.reflection)
    np.testing.assert_array_equal(found.diffuse, GOOD.diffuse)
    with pytest.raises(InputError, match=r"has no layers shine that could be its reflection; it has .*spec_all"):
        read_buffers(tmp_path / "x.exr", ReadOptions(parse_layers(("reflection=shine", "diffuse=half"))))
    with pytest.raises(InputError, match="no buffer is called sheen"):
        parse_layers(("sheen=a",))
    with pytest.raises(InputError, match="is no layer"):
        parse_layers(("diffuse=a*b*c",))


def test_a_cropped_picture_is_filled_up(tmp_path: Path) -> None:
    top, left = 10, 20
    cut = {name: plane[top:110, left:140] for name, plane in layers(GOOD).items()}
    display = (np.zeros(2, np.int32), np.array([149, 119], np.int32))
    data = (np.array([left, top], np.int32), np.array([139, 109], np.int32))
    write(tmp_path / "x.exr", cut, displayWindow=display, dataWindow=data)
    remarks: list[str] = []
    found = read_buffers(tmp_path / "x.exr", tell=remarks.append)
    assert found.shape == (120, 150)
    np.testing.assert_array_equal(found.diffuse[top:110, left:140], GOOD.diffuse[top:110, left:140])
    assert not found.surfaces[:top].any() and not found.surfaces[:, 140:].any()
    assert any("another part than the whole picture" in remark for remark in remarks)


MISSING: list[tuple[str, str, Callable[[ShadingBuffers], Any]]] = [
    ("ambient_occlusion", "no ambient occlusion", lambda b: b.ambient_occlusion.min() == 1),
    ("reflection_occlusion", "no reflection occlusion", lambda b: b.reflection_occlusion.min() == 1),
    ("surface_id", "taken as surface 1", lambda b: np.array_equal(b.surfaces, GOOD.coverage > 0)),
    ("position", "seen along one direction", lambda b: b.orthographic and np.all(b.to_eye == [0, 0, 1])),
    ("reflection.", "no reflection:", lambda b: not b.reflection.any()),
    ("A", "no alpha", lambda b: np.array_equal(b.coverage, SHOWN)),
]


@pytest.mark.parametrize(("layer", "remark", "holds"), MISSING, ids=[row[0] for row in MISSING])
def test_what_is_missing_is_said_and_done_without(
    tmp_path: Path, layer: str, remark: str, holds: Callable[[ShadingBuffers], Any]
) -> None:
    write(tmp_path / "x.exr", {name: plane for name, plane in layers(GOOD).items() if not name.startswith(layer)})
    remarks: list[str] = []
    assert holds(read_buffers(tmp_path / "x.exr", tell=remarks.append))
    assert sum(remark in said for said in remarks) == 1


SPOILED: list[tuple[str, float, str]] = [
    ("diffuse.G", np.nan, "layer diffuse holds no numbers in 3 pixels"),
    ("R", np.inf, "the picture holds no numbers in 3 pixels"),
    ("normal.", 0.0, "normals of 3 pixels of surfaces have no direction"),
    ("position.", 0.0, "3 pixels in the camera itself"),
    ("surface_id.I", 2.5, "between two surfaces in 3 pixels"),
]


@pytest.mark.parametrize(("layer", "value", "remark"), SPOILED, ids=[row[0] for row in SPOILED])
def test_a_few_bad_pixels_are_left_and_counted(tmp_path: Path, layer: str, value: float, remark: str) -> None:
    bad = [tuple(place) for place in np.argwhere(GOOD.surfaces == 2)[100:103]]
    stored = layers(GOOD)
    for name in [name for name in stored if name == layer or (layer.endswith(".") and name.startswith(layer))]:
        plane = stored[name].astype(np.float32)
        for place in bad:
            plane[place] = value
        stored[name] = plane
    write(tmp_path / "x.exr", stored)
    remarks: list[str] = []
    found = read_buffers(tmp_path / "x.exr", tell=remarks.append)
    assert np.count_nonzero(found.surfaces != GOOD.surfaces) == 3
    assert all(found.surfaces[place] == 0 for place in bad)
    assert any(remark in said for said in remarks)
    for name in ("diffuse", "normals", "positions"):
        assert np.all(np.isfinite(getattr(found, name)))


@pytest.mark.parametrize("seed", range(12))
def test_whatever_a_few_pixels_hold_edits_stay_finite_or_the_file_is_refused(tmp_path: Path, seed: int) -> None:
    random = np.random.default_rng(seed)
    stored = {name: plane.copy() for name, plane in layers(GOOD).items()}
    for name in random.choice(sorted(set(stored) - {"surface_id.I"}), 3, replace=False):
        places = random.integers(0, stored[name].size, 200)
        strange = random.choice([np.nan, np.inf, -np.inf, -1, 0, 1e30, -1e30], 200)
        stored[name].reshape(-1)[places] = strange.astype(np.float32)
    write(tmp_path / "x.exr", stored)
    try:
        found = read_buffers(tmp_path / "x.exr")
    except FormatError as error:
        assert "leaves 0 to 1" in str(error)
        return
    across: Any = "positions"
    edits = (Emboss(beta=0.5), Smooth(radius=2), Noise(height=0.1, scale=0.5, across=across, displace=True))
    normals = edit(found, Recipe(steps=edits)).normals
    assert np.all(np.isfinite(normals))
    np.testing.assert_allclose(np.linalg.norm(normals[found.surfaces > 0], axis=-1), 1, atol=1e-5)


def test_normals_of_the_world_without_its_camera_are_noticed(tmp_path: Path) -> None:
    turned = dataclasses.replace(GOOD, normals=GOOD.normals * np.array([-1, 1, -1], np.float32))
    write(tmp_path / "x.exr", layers(turned))
    with pytest.raises(FormatError, match=r"look away from the camera; .*--world-to-camera"):
        read_buffers(tmp_path / "x.exr")
    (tmp_path / "camera.txt").write_text("-1 0 0 0\n0 1 0 0\n0 0 -1 0\n0 0 0 1\n")
    turned = dataclasses.replace(turned, positions=GOOD.positions * np.array([-1, 1, -1], np.float32))
    write(tmp_path / "x.exr", layers(turned))
    camera = CameraSaid(world_to_camera=tmp_path / "camera.txt")
    found = read_buffers(tmp_path / "x.exr", ReadOptions(camera=camera))
    np.testing.assert_allclose(found.normals, GOOD.normals, atol=1e-6)


@pytest.mark.parametrize("signs", [(1, 1, -1), (-1, 1, -1)], ids=["left-handed", "turned about y"])
def test_a_camera_that_looks_along_z_is_turned_round(tmp_path: Path, signs: tuple[int, int, int]) -> None:
    along = np.array(signs, np.float32)
    turned = dataclasses.replace(GOOD, normals=GOOD.normals * along, positions=GOOD.positions * along)
    write(tmp_path / "x.exr", layers(turned))
    found = read_buffers(tmp_path / "x.exr")
    np.testing.assert_allclose(found.normals, GOOD.normals, atol=1e-6)
    np.testing.assert_allclose(found.positions, GOOD.positions, atol=1e-6)


def test_depth_and_a_lens_in_the_header_give_positions(tmp_path: Path) -> None:
    stored = {name: plane for name, plane in layers(GOOD).items() if "position" not in name}
    sensor = np.array([30.0, 24.0], np.float32)
    write(tmp_path / "x.exr", {**stored, "depth.Z": depth_z()}, pinholeFocalLength=48.0, sensorOverallDimensions=sensor)
    np.testing.assert_allclose(read_buffers(tmp_path / "x.exr").positions, GOOD.positions, atol=1e-5)
    write(tmp_path / "y.exr", {**stored, "depth.Z": depth_z()})
    assert read_buffers(tmp_path / "y.exr").orthographic


@pytest.mark.parametrize("pixels", [0, 1])
def test_hardly_anything_to_see(tmp_path: Path, pixels: int) -> None:
    surfaces = np.zeros_like(GOOD.surfaces)
    surfaces[tuple(np.argwhere(GOOD.surfaces == 2)[50])] = 2 * pixels
    write(tmp_path / "x.exr", layers(dataclasses.replace(GOOD, surfaces=surfaces)))
    if pixels:
        np.testing.assert_array_equal(read_buffers(tmp_path / "x.exr").surfaces, surfaces)
    else:
        with pytest.raises(FormatError, match="no surface is seen"):
            read_buffers(tmp_path / "x.exr")


def test_darker_than_nothing_is_said(tmp_path: Path) -> None:
    stored: dict[str, Any] = layers(GOOD)
    stored["diffuse.B"] = np.where(GOOD.surfaces == 2, np.float32(-0.01), stored["diffuse.B"])
    write(tmp_path / "x.exr", stored)
    remarks: list[str] = []
    read_buffers(tmp_path / "x.exr", tell=remarks.append)
    assert any("diffuse is negative in" in said for said in remarks)


MITSUBA = """
import sys
import mitsuba as mi
mi.set_variant("scalar_rgb")
ball = {"type": "sphere", "radius": 0.7, "bsdf": {"type": "diffuse"}}
scene = mi.load_dict({"type": "scene", "light": {"type": "constant"},
    "integrator": {"type": "aov", "diffuse": {"type": "direct"},
        "aovs": "sh_normal:sh_normal,position:position,depth:depth,shape_index:shape_index,albedo:albedo"},
    "sensor": {"type": "perspective", "fov": 40,
        "film": {"type": "hdrfilm", "width": 24, "height": 16, "rfilter": {"type": "box"}, "pixel_format": "rgba"},
        "sampler": {"type": "independent", "sample_count": 1}},
    "a": {**ball, "center": [-0.8, 0, 5]}, "b": {**ball, "center": [0.8, 0.2, 6]}})
mi.render(scene)
scene.sensors()[0].film().bitmap().write(sys.argv[1])
"""


def test_a_file_that_mitsuba_wrote_is_recognised(tmp_path: Path) -> None:
    """In a process of its own, since a variant once set stays."""
    pytest.importorskip("mitsuba")
    subprocess.run([sys.executable, "-c", MITSUBA, str(tmp_path / "m.exr")], check=True, timeout=200)
    found = read_buffers(tmp_path / "m.exr", ReadOptions(camera=CameraSaid(fov_deg=40)))
    assert set(np.unique(found.surfaces)) == {0, 1, 2}
    assert found.positions[found.surfaces == 1][:, 0].mean() * found.positions[found.surfaces == 2][:, 0].mean() < 0
    here = found.surfaces > 0
    assert np.all(np.sum(found.normals * found.to_eye, axis=-1)[here] > -0.05)
    assert found.albedo is not None and np.all(found.albedo[here] == 0.5)
    columns = np.nonzero(here)[1]
    assert np.corrcoef(columns, found.positions[here][:, 0])[0, 1] > 0.9


SAMPLE = Path(__file__).parent / "data"


def test_a_file_that_blender_wrote_is_recognised() -> None:
    """Two balls by Cycles of Blender 5.0, in parts, in the world's frame, multiplied by alpha."""
    remarks: list[str] = []
    camera = CameraSaid(world_to_camera=SAMPLE / "blender-5.0-camera.txt")
    found = read_buffers(SAMPLE / "blender-5.0.exr", ReadOptions(camera=camera), remarks.append)
    assert any("multiplied by alpha" in remark for remark in remarks)
    assert not any("turned round" in remark or "look away" in remark for remark in remarks)
    here = (found.surfaces > 0) & (found.coverage == 1)
    assert set(np.unique(found.surfaces)) == {0, 1, 2} and here.sum() > 100
    np.testing.assert_allclose((found.diffuse + found.reflection)[here], found.picture[here], atol=1e-5)
    # The camera stands √62 from the middle of the scene, and the balls have a radius of 1.
    assert -np.sqrt(62) - 1 < found.positions[here][:, 2].min() < found.positions[here][:, 2].max() < -np.sqrt(62) + 2
    assert np.sum(found.normals * found.to_eye, axis=-1)[here].min() > 0
    assert found.albedo is not None
    red = found.albedo[(found.surfaces == 1) & here]
    assert red[:, 0].min() > 2 * red[:, 1].max()
    # A ball's middle follows from any of its points and normals.
    middles = found.positions[here & (found.surfaces == 1)] - found.normals[here & (found.surfaces == 1)]
    assert np.linalg.norm(middles - np.median(middles, axis=0), axis=1).max() < 0.1


def test_depth_of_blender_agrees_with_its_positions(tmp_path: Path) -> None:
    with OpenEXR.File(str(SAMPLE / "blender-5.0.exr"), separate_channels=True) as exr:
        planes = {name: np.array(channel.pixels) for part in exr.parts for name, channel in part.channels.items()}
    write(tmp_path / "x.exr", {name: plane for name, plane in planes.items() if "Position" not in name})
    said = CameraSaid(world_to_camera=SAMPLE / "blender-5.0-camera.txt", fov_deg=39.597755)
    by_depth = read_buffers(tmp_path / "x.exr", ReadOptions(camera=said))
    by_position = read_buffers(SAMPLE / "blender-5.0.exr", ReadOptions(camera=said))
    here = (by_position.surfaces > 0) & (by_position.coverage == 1)
    np.testing.assert_allclose(by_depth.positions[here], by_position.positions[here], atol=0.02)


def test_layers_multiplied_by_alpha_are_divided_by_it(tmp_path: Path) -> None:
    alpha = GOOD.coverage[..., None]
    over_black = (GOOD.diffuse + GOOD.reflection) * alpha
    light = dataclasses.replace(
        GOOD, picture=over_black, diffuse=GOOD.diffuse * alpha, reflection=GOOD.reflection * alpha
    )
    write(tmp_path / "x.exr", layers(light))
    found = read_buffers(tmp_path / "x.exr")
    np.testing.assert_allclose(found.diffuse, GOOD.diffuse, atol=1e-6)
    np.testing.assert_array_equal(found.picture, over_black)
    write(tmp_path / "y.exr", layers(dataclasses.replace(GOOD, picture=over_black)))
    np.testing.assert_array_equal(read_buffers(tmp_path / "y.exr").diffuse, GOOD.diffuse)
