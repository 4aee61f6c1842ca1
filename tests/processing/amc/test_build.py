"""Building against a rendered sphere; the truth is shaded at the table's own normals and tangents, orthographically."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.camera_model import CameraModel
from litrig.base.capture_folder.capture import Capture
from litrig.base.capture_folder.reader import read_capture
from litrig.base.errors import InputError
from litrig.base.pictures import write_picture
from litrig.base.progress import Progress
from litrig.base.table_normals import TableNormal, rotate_smallest
from processing.amc.build import build, build_split, build_unlit
from processing.amc.files.ktx2 import read_amc, write_amc
from processing.amc.model import Amc, TangentAngle
from processing.amc.settings import Settings
from processing.outline.circle import Circle
from tests.processing.amc.brushed_sphere import Scene, shade, true_table

SIZE = 32
CIRCLE = Circle(59.3, 54.8, 46.4)
SHAPE = (110, 118)
SLICES = 24
EVEN_DEG = np.arange(SLICES) * 360 / SLICES


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> "Folders":
    return Folders(tmp_path_factory.mktemp("spheres"))


class Folders:
    """Renders every scene once."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self.shoot = cache(self._shoot)

    def _shoot(self, kind: str, distance_radii: float | None = None, angles_deg: tuple[float, ...] = ()) -> Capture:
        circle = (CIRCLE.x_px, CIRCLE.y_px, CIRCLE.radius_px)
        scene = Scene(kind, circle, SHAPE, distance_radii, background="white", noise=0.004, samples=2)
        angles = np.array(angles_deg) if angles_deg else EVEN_DEG
        folder = self._root / f"{kind}-{distance_radii}-{hash(angles_deg)}"
        return read_capture(scene.shoot(folder, angles, ".jpg" if kind == "3" else ".png"))


def build_there(capture: Capture, **options: Any) -> Amc:
    """Build with the circle given, for tests that are about something else."""
    return build(capture, Settings(**{"size": SIZE, "circle": CIRCLE, "defects": "ignore", **options})).amc


def error_against(amc: Amc, kind: str, taus_deg: NDArray[np.float64] | None = None) -> float:
    """Relative RMSE over the disc up to n-radius 0.8."""
    even = np.arange(len(amc.slices)) * 360 / (len(amc.slices) * amc.repeats)
    truth, radius = true_table(kind, amc.slices.shape[1], even if taus_deg is None else taus_deg)
    inner = radius < 0.8
    return float(np.sqrt(np.mean((amc.slices - truth)[:, inner] ** 2) / np.mean(truth[:, inner] ** 2)))


@pytest.mark.parametrize("kind", ["1", "2", "isotropic"])
def test_an_orthographic_table_is_the_material(folders: Folders, kind: str) -> None:
    assert error_against(build_there(folders.shoot(kind), invariance=1, depth=SLICES), kind) < 0.012


@pytest.mark.parametrize(("kind", "found"), [("1", 1), ("2", 2), ("3", 3), ("4", 4), ("isotropic", "isotropic")])
@pytest.mark.parametrize("distance_radii", [None, 4.0])
def test_the_invariance_is_found(folders: Folders, kind: str, found: int | str, distance_radii: float | None) -> None:
    result = build(folders.shoot(kind, distance_radii), Settings(size=SIZE, distance_radii=distance_radii))
    assert result.amc.invariance == result.invariance.found == found
    assert len(result.amc.slices) == (1 if found == "isotropic" else SLICES / int(found))


@pytest.mark.parametrize("distance_radii", [None, 4.0])
@pytest.mark.parametrize("depth", [12, 60])
def test_slices_that_do_not_fit_into_memory_give_the_same_table(
    folders: Folders, distance_radii: float | None, depth: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    options = {"distance_radii": distance_radii, "invariance": 2, "depth": depth}
    in_memory = build_there(folders.shoot("2", distance_radii), **options).slices
    monkeypatch.setattr("processing.room.MOST_IN_MEMORY_BYTES", 0)
    np.testing.assert_array_equal(build_there(folders.shoot("2", distance_radii), **options).slices, in_memory)


def test_a_folded_table_keeps_the_material(folders: Folders) -> None:
    amc = build_there(folders.shoot("2"))
    assert amc.slices.shape == (SLICES // 2, SIZE, SIZE, 3)
    assert error_against(amc, "2") < 0.012


@pytest.mark.parametrize(("distance_radii", "limit"), [(4.0, 0.04), (8.0, 0.02)])
def test_in_perspective_rectified_is_nearest_to_the_orthographic_truth(
    folders: Folders, distance_radii: float, limit: float
) -> None:
    capture = folders.shoot("2", distance_radii)
    options = {"invariance": 1, "depth": SLICES}
    rectified, view, camera = (
        error_against(build_there(capture, distance_radii=distance_radii, table_normal=kind, **options), "2")
        for kind in (TableNormal.RECTIFIED, TableNormal.VIEW, TableNormal.CAMERA)
    )
    naive = error_against(build_there(capture, **options), "2")
    assert rectified < limit
    assert rectified < min(view, camera, naive) / 3


def test_turning_the_sample_counter_clockwise_raises_k(folders: Folders) -> None:
    """The picture at turntable angle θ is the slice at k = θ/360; a wrong sign would show the one at −θ."""
    amc = build_there(folders.shoot("1"), invariance=1, depth=SLICES)
    forward, backward = error_against(amc, "1", EVEN_DEG), error_against(amc, "1", -EVEN_DEG)
    assert forward < 0.012
    assert backward > 20 * forward


def test_the_tangent_at_turntable_zero_shifts_the_slices(folders: Folders) -> None:
    """Said to be 30 degrees further than it was, the table shows at k what was 30 degrees before."""
    amc = build_there(folders.shoot("2"), invariance=1, depth=SLICES, tangent_zero_deg=30)
    assert error_against(amc, "2", EVEN_DEG - 30) < 0.012
    assert amc.slice_angles_deg == pytest.approx(EVEN_DEG + 30)


def test_angles_that_count_clockwise_are_turned_round(folders: Folders) -> None:
    capture = folders.shoot("1")
    frames = tuple(replace(frame, angle_deg=-(frame.angle_deg or 0)) for frame in capture.frames)
    amc = build_there(replace(capture, frames=frames), invariance=1, depth=SLICES, clockwise=True)
    assert error_against(amc, "1") < 0.012


def test_low_and_high_add_up_to_the_material(folders: Folders) -> None:
    """Without perspective the two tables have the same normals."""
    settings = Settings(size=SIZE, circle=CIRCLE, invariance=1, depth=SLICES)
    low, high = build_split(folders.shoot("2"), settings)
    total = replace(high.amc, slices=high.amc.slices + low.amc.slices)
    assert error_against(total, "2") < 0.02
    assert low.invariance.variation < 0.3 * high.invariance.variation


def test_in_perspective_each_part_has_its_own_normals(folders: Folders) -> None:
    capture = folders.shoot("2", 4.0)
    low, high = build_split(capture, Settings(size=SIZE, circle=CIRCLE, distance_radii=4.0))
    assert (low.amc.table_normal, high.amc.table_normal) == (TableNormal.CAMERA, TableNormal.RECTIFIED)
    assert low.amc.slices.min() >= 0
    assert high.amc.slices.min() >= 0


def test_the_unlit_companion_is_of_the_same_form(folders: Folders) -> None:
    lit = build(folders.shoot("2"), Settings(size=SIZE))
    unlit = build_unlit(lit, folders.shoot("1"), Settings(size=SIZE))
    assert unlit.amc.slices.shape == lit.amc.slices.shape
    assert unlit.outline is lit.outline
    assert (unlit.amc.invariance, unlit.invariance.found) == (2, 1)


def test_an_unlit_turn_of_other_pictures_is_refused(folders: Folders, tmp_path: Path) -> None:
    lit = build(folders.shoot("2"), Settings(size=SIZE))
    other = Scene("2", (159.3, 154.8, 96.4), (310, 318), samples=1).shoot(tmp_path, EVEN_DEG)
    with pytest.raises(InputError, match=r"318 × 310 pixels, those with the key light 118 × 110"):
        build_unlit(lit, read_capture(other), Settings(size=SIZE))


def test_two_turns_at_the_same_angles_are_worth_one(folders: Folders) -> None:
    capture = folders.shoot("2")
    again = tuple(replace(frame, angle_deg=(frame.angle_deg or 0) + 360) for frame in capture.frames)
    result = build(replace(capture, frames=capture.frames + again), Settings(size=SIZE, circle=CIRCLE))
    assert len(result.amc.slices) == SLICES / 2


def test_a_table_that_does_not_turn_has_no_folds(tmp_path: Path, folders: Folders) -> None:
    """The same picture again and again: nothing is found, and nothing filled in."""
    capture = folders.shoot("2")
    stuck = tuple(replace(frame, path=capture.frames[0].path) for frame in capture.frames)
    result = build(replace(capture, frames=stuck), Settings(size=SIZE, circle=CIRCLE))
    assert (result.flaws.filled, result.invariance.found) == (0, "isotropic")


def test_dim_light_is_not_rounded_to_black(tmp_path: Path) -> None:
    scene = Scene("2", (59.3, 54.8, 46.4), (110, 118), samples=1)
    lines = ["name,deg"]
    for index, angle in enumerate(EVEN_DEG):
        write_picture(tmp_path / f"{index:02d}.exr", 1e-4 * scene.picture(float(angle)))
        lines.append(f"{index:02d}.exr,{angle}")
    (tmp_path / "angles.csv").write_text("\n".join(lines))
    table = build(read_capture(tmp_path), Settings(size=SIZE, circle=CIRCLE)).amc
    write_amc(tmp_path / "x.amc.ktx2", table)
    stored = read_amc(tmp_path / "x.amc.ktx2").slices
    assert stored.max() > 2e-5
    assert stored == pytest.approx(table.slices, rel=0.01, abs=1e-6)


def test_slices_that_tell_nothing_are_all_kept(tmp_path: Path) -> None:
    """Noise far above the change over the turn."""
    circle = (CIRCLE.x_px, CIRCLE.y_px, CIRCLE.radius_px)
    scene = Scene("2", circle, SHAPE, noise=0.25, samples=1, lights=1, ambient=0.3)
    result = build(read_capture(scene.shoot(tmp_path, EVEN_DEG)), Settings(size=SIZE, circle=CIRCLE))
    assert result.invariance.found == "cannot tell"
    assert (result.amc.invariance, len(result.amc.slices)) == (1, SLICES)


def test_residuals_name_the_slice_that_does_not_fit(folders: Folders) -> None:
    capture = folders.shoot("2")
    wrong = tuple(
        replace(frame, path=capture.frames[3].path) if i == 9 else frame for i, frame in enumerate(capture.frames)
    )
    residuals = build(replace(capture, frames=wrong), Settings(size=SIZE, circle=CIRCLE, defects="ignore")).residuals
    assert int(np.argmax(residuals)) in (9, 21)  # 21 shows the same tangent, half a turn on
    assert residuals.max() > 4 * np.median(residuals)


def test_the_session_says_the_tangent_unless_overruled(folders: Folders) -> None:
    capture = replace(folders.shoot("2"), tangent_zero_deg=30.0)
    assert build_there(capture).slice_angles_deg[0] == pytest.approx(30)
    assert build_there(capture, tangent_zero_deg=10).slice_angles_deg[0] == pytest.approx(10)


def test_uneven_angles_are_put_where_they_were_measured(folders: Folders) -> None:
    jitter = np.random.default_rng(2).uniform(-0.3, 0.3, SLICES)
    angles = (np.arange(SLICES) + jitter) * 360 / SLICES
    amc = build_there(folders.shoot("2", None, tuple(angles)), invariance=1, depth=SLICES)
    assert error_against(amc, "2") < 0.03


def test_frames_in_any_order_and_beyond_a_turn_are_the_same_table(folders: Folders) -> None:
    capture = folders.shoot("2")
    frames = [replace(frame, angle_deg=(frame.angle_deg or 0) - 720) for frame in capture.frames]
    shuffled = replace(capture, frames=tuple(frames[7:] + frames[:7][::-1]))
    expected, found = (build(one, Settings(size=SIZE, circle=CIRCLE)).amc.slices for one in (capture, shuffled))
    assert found == pytest.approx(expected, abs=1e-4)


def test_128_slices_of_a_material_that_repeats_three_times(tmp_path: Path) -> None:
    scene = Scene("3", (47.2, 45.4, 39.1), (92, 96), samples=1, noise=0.004)
    result = build(read_capture(scene.shoot(tmp_path, np.arange(128) * 360 / 128, ".jpg")), Settings(size=24))
    assert result.amc.invariance == 3
    assert len(result.amc.slices) == 43
    assert error_in_the_surface(result.amc, "3") < 0.03


@pytest.mark.parametrize("kind", ["3", "4"])
@pytest.mark.parametrize("distance_radii", [None, 4.0])
def test_what_repeats_in_the_surface_alone_is_stored_by_the_angle_there(
    folders: Folders, kind: str, distance_radii: float | None
) -> None:
    """On tilted normals that angle and its picture differ, so that only R = 1 and 2 fold without loss over both."""
    capture = folders.shoot(kind, distance_radii)
    settings = Settings(size=SIZE, circle=CIRCLE, distance_radii=distance_radii)
    surface = build(capture, settings)
    picture = build(capture, replace(settings, tangent_angle=TangentAngle.PICTURE))
    evidence = surface.invariance.of(int(kind))
    assert evidence is not None
    assert evidence.outside_surface < 0.01 < 0.05 < evidence.outside_picture < 0.15
    assert surface.amc.tangent_angle is TangentAngle.SURFACE
    assert surface.residuals.mean() < picture.residuals.mean() / 3
    assert error_in_the_surface(surface.amc, kind) < 0.03


def error_in_the_surface(amc: Amc, kind: str) -> float:
    """Relative RMSE where each slice has its tangents turned from the surface's plane through z by k."""
    depth, size = amc.slices.shape[:2]
    line = (2 * np.arange(size) + 1) / size - 1
    n_x, n_y = np.meshgrid(line, -line)
    inner = np.hypot(n_x, n_y) < 0.8
    normal = np.stack([n_x, n_y, np.sqrt(np.maximum(1 - n_x**2 - n_y**2, 0))], axis=-1)[inner]
    eye = np.array([0.0, 0.0, 1.0])
    errors = []
    for j in range(depth):
        tau = 2 * np.pi * j / (amc.repeats * depth)
        flat = np.broadcast_to([np.cos(tau), np.sin(tau), 0.0], normal.shape)
        tangent = rotate_smallest(flat, np.broadcast_to(eye, normal.shape), normal)
        truth = shade(kind, normal, np.asarray(tangent, np.float64), np.broadcast_to(eye, normal.shape))
        errors.append((amc.slices[j][inner] - truth, truth))
    error, truths = (np.stack(part) for part in zip(*errors, strict=True))
    return float(np.sqrt(np.mean(error**2) / np.mean(truths**2)))


def test_the_depth_is_what_was_asked_for(folders: Folders) -> None:
    amc = build_there(folders.shoot("2"), depth=31, invariance=2)
    assert len(amc.slices) == 31
    assert error_against(amc, "2") < 0.012


def test_a_prescribed_invariance_overrules_the_found_one(folders: Folders) -> None:
    result = build(folders.shoot("2"), Settings(size=SIZE, invariance="isotropic"))
    assert (result.amc.invariance, len(result.amc.slices), result.invariance.found) == ("isotropic", 1, 2)


def test_the_table_says_where_it_comes_from(folders: Folders) -> None:
    capture = folders.shoot("2")
    steps: list[Progress] = []
    result = build(capture, Settings(size=SIZE), report=steps.append)
    assert result.amc.source == capture.digest
    assert result.amc.valid.shape == result.amc.slices.shape[:3]
    assert result.amc.slices.dtype == np.float32
    assert result.amc.slices.min() >= 0
    assert {step.job for step in steps} == {"finding the sphere", "resampling"}
    assert steps[-1].done == steps[-1].total == SLICES


def test_invalid_texels_hold_the_colour_of_the_nearest_valid_one(folders: Folders) -> None:
    amc = build_there(folders.shoot("2"))
    assert not amc.valid[0, 0, 0]
    rows, columns = np.nonzero(amc.valid[0])
    squared = rows**2 + columns**2
    nearest = squared == squared.min()
    candidates = amc.slices[:, rows[nearest], columns[nearest]]
    assert np.all(candidates == amc.slices[:, :1, 0], axis=(0, 2)).any()


def test_a_camera_model_gives_the_distance(folders: Folders) -> None:
    focal_px = CIRCLE.radius_px * np.sqrt(4.0**2 - 1)
    camera = CameraModel(
        width=SHAPE[1], height=SHAPE[0], focal_x_px=focal_px, focal_y_px=focal_px, centre_x_px=59.3, centre_y_px=54.8
    )
    result = build(folders.shoot("2", 4.0), Settings(size=SIZE, camera=camera))
    assert result.distance_radii == pytest.approx(4.0, abs=0.02)


def test_the_sessions_distance_is_used_unless_overruled(folders: Folders) -> None:
    capture = replace(folders.shoot("2", 4.0), sphere_distance_radii=4.0)
    assert build(capture, Settings(size=SIZE)).distance_radii == 4.0
    assert build(capture, Settings(size=SIZE, distance_radii=5.0)).distance_radii == 5.0


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        pytest.param({"circle": Circle(30, 55, 46)}, "cut by the border", id="circle off the picture"),
        pytest.param({"distance_radii": 0.5}, "0.5 radii", id="camera inside"),
        pytest.param({"size": 2}, "2 texels", id="no table"),
        pytest.param({"depth": 0}, "depth of 0", id="no slice"),
        pytest.param({"depth": 2}, "hold no change", id="slices that hold no change"),
        pytest.param({"depth": 5, "invariance": "isotropic"}, "leave --depth out", id="depth of the isotropic"),
        pytest.param({"circle": Circle(float("nan"), 55, 46)}, "is no circle", id="circle of no numbers"),
        pytest.param({"invariance": 0}, "invariance of 0", id="repeats never"),
        pytest.param({"threshold": 5.0}, "threshold of 5", id="threshold in percent"),
        pytest.param({"tangent_zero_deg": float("nan")}, "tangent at nan deg", id="tangent that is no number"),
        pytest.param({"tangent_zero_deg": 1e300}, r"tangent at 1e\+300 deg", id="tangent beyond all turns"),
    ],
)
def test_wrong_options_are_refused(folders: Folders, options: dict[str, Any], reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        build_there(folders.shoot("2"), **options)


@pytest.mark.parametrize("wrong", [{"distance_radii": 1e300}, {"tangent_zero_deg": 1e300}, {"threshold": 2.0}], ids=str)
def test_wrong_measures_are_refused_before_a_picture_is_read(wrong: dict[str, float]) -> None:
    with pytest.raises(InputError):
        Settings(**wrong)  # type: ignore[arg-type]  # a float each


def test_a_frame_without_an_angle_is_named(folders: Folders) -> None:
    capture = folders.shoot("2")
    frames = (*capture.frames[:-1], replace(capture.frames[-1], angle_deg=None))
    with pytest.raises(InputError, match=r"frame_0023\.png: has no turntable angle"):
        build(replace(capture, frames=frames))


def test_a_gap_between_angles_is_named(folders: Folders) -> None:
    capture = folders.shoot("2")
    with pytest.raises(InputError, match=r"no frame between 105\.0 and 225\.0 deg"):
        build(replace(capture, frames=capture.frames[:8] + capture.frames[15:]))


def test_too_few_frames_are_refused(folders: Folders) -> None:
    capture = folders.shoot("2")
    with pytest.raises(InputError, match="at least 8"):
        build(replace(capture, frames=capture.frames[::4]))
