import dataclasses
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from litrig.base.errors import FormatError, InputError
from processing.shape.buffers.camera import CameraSaid
from processing.shape.buffers_exr import ReadOptions, read_buffers, read_normals
from processing.shape.model import ShadingBuffers
from tests.processing.shape.scene import buffers, bumped
from tests.processing.shape.stored import layers, write

GOOD = buffers()
FIELDS = [field.name for field in dataclasses.fields(GOOD)]


def same(found: ShadingBuffers, wanted: ShadingBuffers, atol: float = 1e-6) -> None:
    assert (found.albedo, found.reflection_albedo) == (None, None)
    for name in set(FIELDS) - {"albedo", "reflection_albedo", "stored_turn"}:
        np.testing.assert_allclose(getattr(found, name), getattr(wanted, name), atol=atol, err_msg=name)


def test_every_layer_is_found(tmp_path: Path) -> None:
    write(tmp_path / "x.exr", layers(GOOD))
    same(read_buffers(tmp_path / "x.exr"), GOOD)


def test_what_is_missing_is_open_and_opaque(tmp_path: Path) -> None:
    optional = ("A", "ambient_occlusion.Y", "reflection_occlusion.Y")
    write(tmp_path / "x.exr", {name: plane for name, plane in layers(GOOD).items() if name not in optional})
    found = read_buffers(tmp_path / "x.exr")
    np.testing.assert_array_equal(found.coverage, GOOD.surfaces > 0)
    assert found.ambient_occlusion.min() == found.reflection_occlusion.min() == 1


def test_the_world_is_turned_to_the_camera(tmp_path: Path) -> None:
    """Row vectors, as OpenEXR's standard attribute has it."""
    turn = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]], np.float64)
    shift = np.array([0.3, -2, 5])
    matrix = np.eye(4)
    matrix[:3, :3], matrix[3, :3] = turn, shift
    shown = (GOOD.surfaces > 0)[..., None]
    world = dataclasses.replace(
        GOOD,
        normals=(GOOD.normals @ turn.T).astype(np.float32),
        positions=np.where(shown, (GOOD.positions - shift) @ turn.T, 0).astype(np.float32),
    )
    write(tmp_path / "x.exr", layers(world), worldToCamera=matrix.astype(np.float32))
    same(read_buffers(tmp_path / "x.exr"), GOOD, atol=1e-5)


def test_normals_are_read_by_any_of_their_names(tmp_path: Path) -> None:
    wanted = bumped(GOOD.normals)
    for names in (("normal.X", "normal.Y", "normal.Z"), [f"sh_normal.{c}" for c in "XYZ"], "XYZ", "RGB"):
        write(tmp_path / "n.exr", {name: 2 * wanted[..., index] for index, name in enumerate(names)})
        np.testing.assert_allclose(read_normals(tmp_path / "n.exr", GOOD), wanted, atol=1e-6)


def test_normals_of_a_camera_that_the_user_told_are_turned_as_the_pictures_own(tmp_path: Path) -> None:
    turn, shown = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]]), (GOOD.surfaces > 0)[..., None]
    # A camera that looks along its z, its x to the left.
    flip = np.array([-1, 1, -1])
    in_world = {
        "normals": (GOOD.normals * flip @ turn.T).astype(np.float32),
        "positions": np.where(shown, GOOD.positions * flip @ turn.T, 0).astype(np.float32),
    }
    write(tmp_path / "x.exr", layers(dataclasses.replace(GOOD, **in_world)))
    np.savetxt(tmp_path / "camera.txt", np.block([[turn, np.zeros((3, 1))], [np.zeros(3), 1]]))
    found = read_buffers(tmp_path / "x.exr", ReadOptions(camera=CameraSaid(tmp_path / "camera.txt")))
    np.testing.assert_allclose(found.normals, GOOD.normals, atol=1e-6)
    np.testing.assert_allclose(read_normals(tmp_path / "x.exr", found), found.normals, atol=1e-6)
    channels = {f"normal.{axis}": GOOD.normals[..., index] for index, axis in enumerate("XYZ")}
    write(tmp_path / "ours.exr", channels, **{"litrig.kind": "normals"})
    np.testing.assert_allclose(read_normals(tmp_path / "ours.exr", found), found.normals, atol=1e-6)
    write(tmp_path / "detail.exr", channels)
    detail = read_normals(tmp_path / "detail.exr", found, in_surface=True)
    np.testing.assert_allclose(detail, found.normals, atol=1e-6)


def test_infinite_backgrounds_do_no_harm(tmp_path: Path) -> None:
    stored = layers(GOOD)
    for part in "XYZ":
        stored[f"position.{part}"] = np.where(GOOD.surfaces > 0, stored[f"position.{part}"], np.inf).astype(np.float32)
    write(tmp_path / "x.exr", stored)
    same(read_buffers(tmp_path / "x.exr"), GOOD)


Change = Callable[[dict[str, np.ndarray]], dict[str, np.ndarray]]


def spoiled(name: str, value: float) -> Change:
    def change(stored: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        return {**stored, name: np.where(GOOD.surfaces > 0, value, stored[name]).astype(np.float32)}

    return change


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        pytest.param(
            lambda s: {k: v for k, v in s.items() if "diffuse" not in k},
            "lacks diffuse.R, diffuse.G",
            id="a layer short",
        ),
        pytest.param(spoiled("reflection.G", np.nan), "layer reflection holds no numbers in", id="NaN"),
        pytest.param(spoiled("R", np.inf), "the picture holds no numbers", id="infinite"),
        pytest.param(spoiled("ambient_occlusion.Y", 1.5), "ambient_occlusion.Y leaves 0 to 1", id="occlusion"),
        pytest.param(spoiled("surface_id.I", 2.5), "no numbers of surfaces", id="half a surface"),
        pytest.param(
            lambda s: {k: v * 0 if "normal" in k else v for k, v in s.items()}, "have no direction", id="no normals"
        ),
        pytest.param(
            lambda s: {k: v * 0 if "position" in k else v for k, v in s.items()}, "in the camera itself", id="positions"
        ),
    ],
)
def test_buffers_that_cannot_be_used_are_refused(tmp_path: Path, change: Change, reason: str) -> None:
    write(tmp_path / "x.exr", change(layers(GOOD)))
    with pytest.raises(FormatError, match=reason) as caught:
        read_buffers(tmp_path / "x.exr")
    assert "x.exr" in str(caught.value) and "\n" not in str(caught.value)


def test_a_scaled_camera_and_normals_of_another_size_are_refused(tmp_path: Path) -> None:
    write(tmp_path / "x.exr", layers(GOOD), worldToCamera=np.diag([2, 2, 2, 1]).astype(np.float32))
    with pytest.raises(FormatError, match="worldToCamera is no rotation"):
        read_buffers(tmp_path / "x.exr")
    write(tmp_path / "n.exr", {name: np.ones((4, 5), np.float32) for name in "XYZ"})
    with pytest.raises(InputError, match="5 × 4 normals for a picture of 150 × 120"):
        read_normals(tmp_path / "n.exr", GOOD)
    write(tmp_path / "m.exr", {"Y": np.ones((4, 5), np.float32)})
    with pytest.raises(FormatError, match="holds no normals"):
        read_normals(tmp_path / "m.exr", GOOD)


@pytest.mark.parametrize("share", [0.0, 0.01, 0.4, 0.9])
def test_a_file_cut_short_is_refused(tmp_path: Path, share: float) -> None:
    write(tmp_path / "x.exr", layers(GOOD))
    content = (tmp_path / "x.exr").read_bytes()
    (tmp_path / "x.exr").write_bytes(content[: int(share * len(content))])
    with pytest.raises(FormatError, match=r"x\.exr"):
        read_buffers(tmp_path / "x.exr")


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_buffers(tmp_path / "x.exr")


def test_a_small_object_before_much_black_is_no_bomb(tmp_path: Path) -> None:
    planes = {name: np.zeros((1024, 1024), plane.dtype) for name, plane in layers(GOOD).items()}
    for name, plane in layers(GOOD).items():
        small = plane[::4, ::4]
        planes[name][: small.shape[0], : small.shape[1]] = small
    write(tmp_path / "s.exr", planes)
    assert (tmp_path / "s.exr").stat().st_size * 200 < sum(plane.nbytes for plane in planes.values())
    assert read_buffers(tmp_path / "s.exr").seen == GOOD.seen
