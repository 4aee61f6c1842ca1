"""Edits of normals, each against what it means."""

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.pictures import write_codes, write_exr
from processing.shape.editing.displace import facet_normals
from processing.shape.editing.edit import edit
from processing.shape.editing.operations import (
    AnyOperation,
    Bump,
    Emboss,
    Factors,
    Noise,
    Painted,
    Recipe,
    Ripple,
    Smooth,
)
from processing.shape.editing.perlin import layered_noise
from processing.shape.editing.tilt import GRAZING, detailed
from processing.shape.model import ShadingBuffers
from tests.processing.shape.scene import BALLS, buffers

BALL = buffers()
SHOWN = BALL.surfaces > 0
Floats = NDArray[np.float32]


def edited(scene: ShadingBuffers, *operations: AnyOperation) -> Floats:
    return edit(scene, Recipe(steps=operations)).normals


def flat(width: int = 120, height: int = 80, n: tuple[float, float, float] = (0, 0, 1)) -> ShadingBuffers:
    """A plane through (0, 0, −5), a pixel a hundredth wide, seen from far away."""
    normal = np.array(n) / np.linalg.norm(n)
    x, y = np.meshgrid((np.arange(width) + 0.5 - width / 2) / 100, -(np.arange(height) + 0.5 - height / 2) / 100)
    z = -5 - (normal[0] * x + normal[1] * y) / normal[2]
    colour = np.full((height, width, 3), 0.5, np.float32)
    ones = np.ones((height, width), np.float32)
    return ShadingBuffers(
        picture=colour,
        coverage=ones,
        diffuse=colour,
        reflection=colour * 0,
        normals=np.broadcast_to(normal.astype(np.float32), colour.shape).copy(),
        positions=np.stack([x, y, z], axis=-1).astype(np.float32),
        surfaces=np.ones((height, width), np.uint32),
        ambient_occlusion=ones,
        reflection_occlusion=ones,
        orthographic=True,
    )


@pytest.fixture(scope="module")
def slope_png(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Heights that rise to the right: 0 to 1 over the width."""
    path = tmp_path_factory.mktemp("heights") / "slope.png"
    row = np.round((np.arange(64) + 0.5) / 64 * 65535).astype(np.uint16)
    write_codes(path, np.repeat(np.tile(row, (32, 1))[..., None], 3, axis=-1))
    return path


def all_operations(slope: Path) -> list[AnyOperation]:
    return [
        Emboss(beta=0.3),
        Bump(heights=slope, height=9, size=60, repeat=True),
        Bump(heights=slope, height=0.2, size=0.5, at=(45, 55), across="positions"),
        Bump(heights=slope, height=0.05, size=0.5, at=(45, 55), across="positions", displace=True),
        Noise(height=4, scale=10),
        Noise(height=0.1, scale=0.2, across="positions"),
        Ripple(at=(45, 55), height=3, wavelength=9, fade=30),
        Ripple(at=(45, 55), height=0.05, wavelength=0.15, fade=0.4, across="positions"),
        Ripple(at=(45, 55), height=0.02, wavelength=0.3, fade=0.4, across="positions", displace=True),
        Smooth(radius=2),
    ]


def test_edited_normals_are_unit_and_face_the_eye(slope_png: Path) -> None:
    for operation in all_operations(slope_png):
        normals = edited(BALL, operation)
        changed = np.any(normals != BALL.normals, axis=-1)
        assert changed.any() and not changed[~SHOWN].any()
        np.testing.assert_allclose(np.linalg.norm(normals[SHOWN], axis=-1), 1, atol=1e-5)
        assert np.sum(normals * BALL.to_eye, axis=-1)[changed].min() > GRAZING - 1e-5


def test_strength_masks_and_surfaces_say_where_and_how_far(slope_png: Path, tmp_path: Path) -> None:
    mask = np.zeros((*BALL.shape, 3), np.uint8)
    mask[:60] = 255
    write_codes(tmp_path / "mask.png", mask)
    for operation in all_operations(slope_png):
        nothing = operation.model_copy(update={"strength": 0.0})
        np.testing.assert_array_equal(edited(BALL, nothing), BALL.normals)
        here = edited(BALL, operation.model_copy(update={"surfaces": (2,), "mask": tmp_path / "mask.png"}))
        outside = (BALL.surfaces != 2) | (np.arange(120) > 60)[:, None]  # displaced neighbours turn along the rim
        np.testing.assert_array_equal(here[outside], BALL.normals[outside])
        inside = (BALL.surfaces == 2) & (np.arange(120) < 58)[:, None]
        if not getattr(operation, "displace", False):
            np.testing.assert_array_equal(here[inside], edited(BALL, operation)[inside])
        half = edited(BALL, operation.model_copy(update={"strength": 0.5}))
        way = (
            np.linalg.norm(half - BALL.normals, axis=-1),
            np.linalg.norm(edited(BALL, operation) - BALL.normals, axis=-1),
        )
        assert 0.3 < way[0].sum() / way[1].sum() < 0.7


def test_embossing_scales_what_faces_the_camera() -> None:
    found = edited(BALL, Emboss(beta=0.5))
    wanted = BALL.normals * np.array([1, 1, 0.5])
    wanted /= np.maximum(np.linalg.norm(wanted, axis=-1, keepdims=True), 1e-9)
    facing = SHOWN & (np.sum(wanted * BALL.to_eye, axis=-1) > 0.05)
    np.testing.assert_allclose(found[facing], wanted[facing], atol=1e-6)
    np.testing.assert_array_equal(edited(BALL, Emboss(beta=1)), BALL.normals)


@pytest.mark.parametrize("turn_deg", [0, 90, 210])
@pytest.mark.parametrize("across", ["screen", "positions"])
def test_a_slope_tilts_by_its_angle_and_turns_with_its_picture(slope_png: Path, turn_deg: float, across: Any) -> None:
    """It rises by 20 over 80 pixels, or 0.2 over 0.8: normals lean to the low side by arctan ¼."""
    unit = 1 if across == "screen" else 0.01
    bump = Bump(heights=slope_png, height=20 * unit, size=80 * unit, at=(60, 40), turn_deg=turn_deg, across=across)
    found = edited(flat(), bump)[40, 60]
    angle = np.radians(turn_deg)
    wanted = np.array([-0.25 * np.cos(angle), -0.25 * np.sin(angle), 1]) / np.hypot(0.25, 1)
    np.testing.assert_allclose(found, wanted, atol=2e-3)
    np.testing.assert_array_equal(edited(flat(), bump)[0, 0], [0, 0, 1])


@pytest.mark.parametrize("across", ["screen", "positions"])
def test_what_rises_upwards_leans_down(tmp_path: Path, across: Any) -> None:
    column = np.round((31.5 - np.arange(32)) / 32 * 65535).astype(np.uint16)
    write_codes(tmp_path / "up.png", np.repeat(np.tile(column[:, None], (1, 64))[..., None], 3, axis=-1))
    unit = 1 if across == "screen" else 0.01
    bump = Bump(heights=tmp_path / "up.png", height=10 * unit, size=80 * unit, at=(60, 40), across=across)
    wanted = np.array([0, -0.25, 1]) / np.hypot(0.25, 1)
    np.testing.assert_allclose(edited(flat(), bump)[40, 60], wanted, atol=2e-3)


@pytest.mark.parametrize("across", ["screen", "positions"])
def test_a_decal_stands_upright(tmp_path: Path, across: Any) -> None:
    dot = np.zeros((32, 64, 3), np.uint8)
    dot[4:10, 6:16] = 255
    write_codes(tmp_path / "dot.png", dot)
    unit = 1 if across == "screen" else 0.01
    bump = Bump(heights=tmp_path / "dot.png", height=10 * unit, size=80 * unit, at=(60, 40), across=across)
    rows, columns = np.nonzero(edited(flat(), bump)[..., 2] < 0.99)
    assert columns.min() >= 20 and columns.max() < 45 and rows.min() >= 20 and rows.max() < 36


def test_a_relief_on_the_screen_is_drawn_out_along_a_slope(slope_png: Path) -> None:
    """Where the surface turns away by 26.6°, a length on the screen is 1/cos of that on it, and less steep."""
    slanted = flat(n=(0.5, 0, 1))
    found = edited(slanted, Bump(heights=slope_png, height=20, size=80, at=(60, 40)))[40, 60]
    tilt = np.degrees(np.arccos(np.sum(found * slanted.normals[0, 0])))
    np.testing.assert_allclose(tilt, np.degrees(np.arctan(0.25 / np.hypot(0.5, 1))), atol=0.1)
    assert found[0] < slanted.normals[0, 0, 0] and found[1] == 0


def test_a_decal_lies_on_a_slanted_surface_as_on_a_flat_one(slope_png: Path) -> None:
    slanted = flat(n=(0.5, 0, 1))
    bump = Bump(heights=slope_png, height=0.2, size=0.8, at=(60, 40), across="positions")
    tilt = np.degrees(np.arccos(np.sum(edited(slanted, bump)[40, 60] * slanted.normals[0, 0])))
    np.testing.assert_allclose(tilt, np.degrees(np.arctan(0.25)), atol=0.1)


def test_displaced_positions_turn_normals_as_the_relief_does() -> None:
    """Two ways to the same surface: by the gradient, and by positions moved along the normals."""
    wave = Ripple(at=(45, 55), height=0.004, wavelength=0.25, fade=0.5, across="positions")
    moved = edit(BALL, Recipe(steps=(wave.model_copy(update={"displace": True}),)))
    tilted = edited(BALL, wave)
    inner = np.linalg.norm((BALL.positions - np.array(BALLS[2][0])) / 0.8 - BALL.normals, axis=-1) < 1e-3
    inner &= (BALL.normals[..., 2] > 0.6) & (
        np.hypot(*np.indices(BALL.shape)[::-1] - np.array([45, 55])[:, None, None]) > 6
    )
    assert inner.sum() > 1500
    apart = np.linalg.norm(moved.normals - tilted, axis=-1)[inner]
    assert np.linalg.norm(tilted - BALL.normals, axis=-1)[inner].mean() > 0.02
    assert apart.mean() < 0.006
    assert 0.003 < np.linalg.norm(moved.positions - BALL.positions, axis=-1).max() <= 0.004


def test_facets_of_a_sphere_are_its_normals() -> None:
    facets = facet_normals(BALL.positions, BALL.surfaces)
    inner = BALL.normals[..., 2] > 0.7
    np.testing.assert_allclose(facets[inner], BALL.normals[inner], atol=0.03)


def test_noise_has_the_gradient_that_it_says() -> None:
    points = np.random.default_rng(5).uniform(-20, 20, (400, 3))
    step = 1e-2
    values = layered_noise(points.astype(np.float32), 3, 9)
    for axis in range(3):
        either = [layered_noise((points + sign * step * np.eye(3)[axis]).astype(np.float32), 3, 9) for sign in (-1, 1)]
        slope = (either[1][:, 0] - either[0][:, 0]) / (2 * step)
        np.testing.assert_allclose(values[:, 1 + axis], slope, atol=0.02)
    assert 0.15 < values[:, 0].std() < 0.5
    assert not np.array_equal(values, layered_noise(points.astype(np.float32), 3, 10))


def test_ripples_stand_around_their_middle_and_fade() -> None:
    scene = flat()
    found = edited(scene, Ripple(at=(60.5, 40.5), height=1, wavelength=10, fade=15))
    np.testing.assert_allclose(found[40, 70, :2], found[40, 50, :2] * [-1, 1], atol=1e-6)
    np.testing.assert_allclose(found[30, 60, 1], found[40, 70, 0], atol=1e-6)
    assert abs(found[40, 70, 0]) > 3 * abs(found[40, 100, 0])


def test_smoothing_takes_noise_away_and_stops_at_depth() -> None:
    scene = flat()
    step = dataclasses.replace(
        scene,
        positions=scene.positions
        + np.where(np.arange(120) < 60, 0, 3)[None, :, None] * np.array([0, 0, 1], np.float32),
    )
    left, right = np.array([-0.6, 0, 0.8], np.float32), np.array([0.6, 0, 0.8], np.float32)
    clean = np.where((np.arange(120) < 60)[None, :, None], left, right) + np.zeros((80, 1, 1), np.float32)
    noisy = clean + np.random.default_rng(1).normal(0, 0.1, clean.shape)
    noisy = (noisy / np.linalg.norm(noisy, axis=-1, keepdims=True)).astype(np.float32)
    step = dataclasses.replace(step, normals=noisy)
    found = edited(step, Smooth(radius=4, depth_radius=0.5))
    assert np.linalg.norm(found - clean, axis=-1)[:, 56:64].max() < 0.1
    assert np.linalg.norm(found - clean, axis=-1).mean() < np.linalg.norm(noisy - clean, axis=-1).mean() / 5
    through = edited(dataclasses.replace(scene, normals=noisy), Smooth(radius=4))
    assert np.linalg.norm(through - clean, axis=-1)[:, 56:64].max() > 0.3
    apart = dataclasses.replace(
        scene, normals=noisy, surfaces=np.where(np.arange(120) < 60, 1, 2)[None].repeat(80, 0).astype(np.uint32)
    )
    assert np.linalg.norm(edited(apart, Smooth(radius=4)) - clean, axis=-1)[:, 56:64].max() < 0.1


def test_painted_normals_come_from_exr_and_png_of_either_hand(tmp_path: Path) -> None:
    wanted = edited(BALL, Noise(height=2, scale=12))
    write_exr(
        tmp_path / "n.exr",
        {f"normal.{axis}": wanted[..., k].copy() for k, axis in enumerate("XYZ")},
        {"litrig.kind": "normals"},
    )
    np.testing.assert_allclose(edited(BALL, Painted(file=tmp_path / "n.exr")), wanted, atol=2e-7)
    for green, sign in (("up", 1), ("down", -1)):
        codes = np.round((wanted * np.array([1, sign, 1]) + 1) / 2 * 65535).astype(np.uint16)
        codes[10:14] = 0  # nothing painted there
        write_codes(tmp_path / "n.png", codes)
        found = edited(BALL, Painted(file=tmp_path / "n.png", green=green))
        kept = np.arange(120)[:, None] * np.ones(150)
        here = SHOWN & ((kept < 10) | (kept > 13))
        np.testing.assert_allclose(found[here], wanted[here], atol=1e-4)
        np.testing.assert_array_equal(found[10:14], BALL.normals[10:14])


def test_detail_turns_with_the_surface_and_neutral_grey_is_none(tmp_path: Path) -> None:
    codes = np.full((*BALL.shape, 3), (128, 128, 255), np.uint8)
    write_codes(tmp_path / "d.png", codes)
    np.testing.assert_allclose(edited(BALL, Painted(file=tmp_path / "d.png", space="surface")), BALL.normals, atol=1e-6)
    random = np.random.default_rng(0).normal(size=(2, 50, 1, 3))
    n, m = (random / np.linalg.norm(random, axis=-1, keepdims=True)).astype(np.float32)
    turned = detailed(n, m)
    np.testing.assert_allclose(np.sum(turned * n, axis=-1), m[..., 2], atol=1e-5)
    axis = np.cross([0, 0, 1], n)
    np.testing.assert_allclose(np.sum(turned * axis, axis=-1), np.sum(m * axis, axis=-1), atol=1e-5)


def test_factors_are_scaled_where_they_are_said() -> None:
    found = edit(BALL, Recipe(steps=(Factors(diffuse=0.5, surfaces=(2,)), Factors(diffuse=2, reflection=4))))
    np.testing.assert_array_equal(found.diffuse_factor, np.select([BALL.surfaces == 2, SHOWN], [1, 2], 1))
    np.testing.assert_array_equal(found.reflection_factor, np.where(SHOWN, 4, 1))
    np.testing.assert_array_equal(found.normals, BALL.normals)


REFUSED: list[tuple[AnyOperation, str]] = [
    (Emboss(beta=0.5, surfaces=(3,)), "step 1, emboss: no surface 3 in the picture; there are 2, 7"),
    (Ripple(at=(500, 5), height=1, wavelength=5, fade=5), "outside the picture of 150 × 120"),
    (Ripple(at=(1, 1), height=1, wavelength=5, fade=5, across="positions"), "shows no surface"),
    (Emboss(beta=0.5, mask=Path("no.png")), "no such file"),
]


@pytest.mark.parametrize(("operation", "reason"), REFUSED, ids=range(len(REFUSED)))
def test_what_cannot_be_done_is_said(operation: AnyOperation, reason: str) -> None:
    with pytest.raises(InputError, match=reason) as caught:
        edited(BALL, operation)
    assert "\n" not in str(caught.value)


def test_masks_and_normals_of_another_size_are_refused(tmp_path: Path) -> None:
    write_codes(tmp_path / "m.png", np.zeros((4, 5, 3), np.uint8))
    for operation in (Emboss(beta=0.5, mask=tmp_path / "m.png"), Painted(file=tmp_path / "m.png")):
        with pytest.raises(InputError, match="of 5 × 4 pixels for a picture of 150 × 120"):
            edited(BALL, operation)


def test_without_positions_nothing_lies_in_the_scene() -> None:
    blind = dataclasses.replace(
        BALL, orthographic=True, positions=np.broadcast_to(np.array([0, 0, -1], np.float32), BALL.positions.shape)
    )
    with pytest.raises(InputError, match="the buffers have none"):
        edited(blind, Noise(height=1, scale=5, across="positions"))


def test_a_frame_may_lack_a_surface() -> None:
    found = edit(BALL, Recipe(steps=(Emboss(beta=0.5, surfaces=(3,)),)), is_frame=True)
    np.testing.assert_array_equal(found.normals, BALL.normals)


@pytest.mark.parametrize("height", [1e15, 1e30])
def test_giant_heights_leave_unit_normals_that_face_the_eye(height: float) -> None:
    made = edited(BALL, Noise(height=height, scale=5))[SHOWN]
    np.testing.assert_allclose(np.linalg.norm(made, axis=-1), 1, atol=1e-5)
    assert np.all(np.sum(made * BALL.to_eye[SHOWN], axis=-1) > 0.9 * GRAZING)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("displace", [False, True])
def test_where_an_edit_leads_beyond_all_numbers_normals_are_kept_and_it_is_said(displace: bool) -> None:
    told: list[str] = []
    noise = Noise(height=1e38, scale=1e-30, across="positions", displace=displace)
    made = edit(BALL, Recipe(steps=(noise,)), told.append)
    assert np.isfinite(made.normals).all() and np.isfinite(made.positions).all()
    assert len(told) == 1 and "noise leads beyond all numbers" in told[0]


def test_painted_normals_that_look_away_are_counted_and_giant_ones_refused(tmp_path: Path) -> None:
    told: list[str] = []
    for name, factor in (("away", -1.0), ("giant", 1e20)):
        write_exr(
            tmp_path / f"{name}.exr",
            {axis: np.ascontiguousarray(BALL.normals[..., k] * np.float32(factor)) for k, axis in enumerate("XYZ")},
            {},
        )
    edit(BALL, Recipe(steps=(Painted(file=tmp_path / "away.exr"),)), told.append)
    assert len(told) == 1 and "away.exr has normals that look away from the camera in" in told[0]
    with pytest.raises(InputError, match="holds no numbers"):
        edit(BALL, Recipe(steps=(Painted(file=tmp_path / "giant.exr"),)))
