from dataclasses import replace

import numpy as np
import pytest

from litrig.base.errors import InputError
from litrig.base.progress import Progress
from processing.paraboloid.read import lookup
from processing.shape import harmonics
from processing.shape.diffuse.fit import DiffuseOptions
from processing.shape.model import ShadingBuffers
from processing.shape.reconstruct import ReconstructOptions, reconstruct
from processing.shape.reconstruction_sheet import reconstruction_sheet
from processing.shape.reflection.environment import ReflectionOptions
from tests.processing.matcap.maps import sharp
from tests.processing.shape.scene import BALLS, TINT, buffers, diffuse_coefficients

SMALL = ReconstructOptions(reflection=ReflectionOptions(48))


def in_the_open() -> ShadingBuffers:
    """The scene, and nothing in the way."""
    scene = buffers()
    shown = scene.surfaces > 0
    diffuse, reflection = np.zeros_like(scene.diffuse), np.zeros_like(scene.reflection)
    mirrored = 2 * np.sum(scene.normals * scene.to_eye, axis=-1, keepdims=True) * scene.normals - scene.to_eye
    for number in BALLS:
        here = scene.surfaces == number
        diffuse[here] = harmonics.evaluate(scene.normals[here]) @ diffuse_coefficients(number)
        reflection[here] = sharp(mirrored[here].astype(np.float64)) * TINT[number]
    ones = np.ones(shown.shape, np.float32)
    return replace(scene, diffuse=diffuse, reflection=reflection, ambient_occlusion=ones, reflection_occlusion=ones)


OPEN = in_the_open()


def test_each_surface_gets_the_light_that_it_shows() -> None:
    found = reconstruct(OPEN, options=SMALL)
    assert list(found.environments) == sorted(BALLS)
    for number, environment in found.environments.items():
        np.testing.assert_allclose(environment.diffuse, diffuse_coefficients(number), atol=1e-4)
        here = OPEN.surfaces == number
        n, v = OPEN.normals[here], OPEN.to_eye[here]
        mirrored = (2 * np.sum(n * v, axis=-1, keepdims=True) * n - v).astype(np.float64)
        rebuilt = lookup(environment.front, environment.back, mirrored)
        assert np.abs(rebuilt - OPEN.reflection[here]).mean() < 0.01
        assert not environment.diffuse_is_illumination
        assert not environment.reflection_is_illumination
    assert all(0.5 < share < 1 for share in found.coverage.values())


def test_occlusion_leaves_residuals_below_zero_alone() -> None:
    scene = buffers()
    found = reconstruct(scene, [2], SMALL)
    here = scene.surfaces == 2
    fitted = harmonics.evaluate(scene.normals[here]) @ found.environments[2].diffuse.astype(np.float64)
    residual = scene.diffuse[here] - fitted
    assert residual.max() <= 1e-10
    assert residual.min() < -0.1


def test_light_before_albedo_is_found_where_there_is_an_albedo() -> None:
    rows, columns = np.indices(OPEN.shape)
    pattern = np.where((rows // 6 + columns // 6) % 2, 0.9, 0.2)[..., None] * np.array([1, 0.8, 0.6])
    albedo = pattern.astype(np.float32)
    painted = replace(
        OPEN,
        diffuse=OPEN.diffuse * albedo,
        reflection=OPEN.reflection * albedo,
        albedo=albedo,
        reflection_albedo=albedo,
    )
    plain, found = (reconstruct(scene, [7], SMALL).environments[7] for scene in (OPEN, painted))
    assert found.diffuse_is_illumination
    assert found.reflection_is_illumination
    np.testing.assert_allclose(found.diffuse, plain.diffuse, atol=1e-4)
    np.testing.assert_allclose(found.front, plain.front, atol=1e-4)
    np.testing.assert_allclose(found.back, plain.back, atol=1e-4)


def test_pixels_that_are_no_numbers_are_left_out_and_told() -> None:
    names = ("diffuse", "reflection", "normals", "positions")
    broken = replace(OPEN, **{name: getattr(OPEN, name).copy() for name in names})
    at = np.argwhere(OPEN.surfaces == 2)
    broken.diffuse[tuple(at[300])] = np.nan
    broken.reflection[tuple(at[400])] = np.inf
    broken.normals[tuple(at[500])] = 0
    broken.normals[tuple(at[600])] = np.inf
    broken.positions[tuple(at[700])] = np.inf
    broken.reflection[tuple(at[700])] = -np.inf
    found = reconstruct(broken, [2], SMALL)
    assert f"surface 2: 5 of {len(at)} pixels hold no numbers or no direction and are left out" in found.remarks
    np.testing.assert_allclose(found.environments[2].diffuse, diffuse_coefficients(2), atol=1e-4)
    assert np.isfinite(found.environments[2].front).all()
    assert reconstruction_sheet(broken, found).any()


def test_one_hot_pixel_lifts_the_diffuse_light_unless_it_is_left_out() -> None:
    hot = replace(OPEN, diffuse=OPEN.diffuse.copy())
    at = tuple(np.argwhere(OPEN.surfaces == 2)[2000])
    hot.diffuse[at] *= 20
    lifted = reconstruct(hot, [2], SMALL).environments[2]
    guarded = reconstruct(hot, [2], replace(SMALL, hot_pixels=2.0))
    assert np.abs(lifted.diffuse - diffuse_coefficients(2)).max() > 1
    np.testing.assert_allclose(guarded.environments[2].diffuse, diffuse_coefficients(2), atol=1e-4)
    assert "surface 2: 1 hot pixels of the diffuse shading are left out" in guarded.remarks


def test_an_object_of_one_pixel_has_its_own_light_everywhere() -> None:
    one = replace(OPEN, surfaces=np.zeros_like(OPEN.surfaces))
    at = tuple(np.argwhere(OPEN.surfaces == 7)[1000])
    one.surfaces[at] = 7
    found = reconstruct(one, options=SMALL).environments[7]
    np.testing.assert_allclose(found.front, np.broadcast_to(OPEN.reflection[at], found.front.shape), atol=1e-5)
    lit = harmonics.evaluate(OPEN.normals[at]) @ found.diffuse
    np.testing.assert_allclose(lit, OPEN.diffuse[at], rtol=1e-5)


def test_constant_and_negative_light_come_back() -> None:
    for level in (0.0, 0.7, -0.5):
        plane = np.full_like(OPEN.diffuse, level)
        found = reconstruct(replace(OPEN, diffuse=plane, reflection=plane), [2], SMALL).environments[2]
        np.testing.assert_allclose(found.front, level, atol=1e-5)
        np.testing.assert_allclose(found.back, level, atol=1e-5)
        np.testing.assert_allclose(found.diffuse[0], level * np.sqrt(4 * np.pi), atol=1e-5)


def test_progress_has_a_step_for_every_surface() -> None:
    steps: list[Progress] = []
    reconstruct(OPEN, options=SMALL, report=steps.append)
    assert [(step.done, step.total) for step in steps] == [(1, 2), (2, 2)]


def test_positions_that_nobody_knows_end_no_patch() -> None:
    nowhere = replace(OPEN, positions=np.broadcast_to(np.array([0, 0, -1], np.float32), OPEN.positions.shape))
    found = reconstruct(replace(nowhere, orthographic=True), [2], SMALL)
    assert found.coverage[2] > 0.5


def test_what_cannot_be_reconstructed_is_refused() -> None:
    nothing = replace(OPEN, surfaces=np.zeros_like(OPEN.surfaces))
    blind = replace(OPEN, diffuse=np.full_like(OPEN.diffuse, np.nan))
    with pytest.raises(InputError, match="only background"):
        reconstruct(nothing)
    with pytest.raises(InputError, match="surface 5: is not seen; choose among 2, 7"):
        reconstruct(OPEN, [5])
    with pytest.raises(InputError, match="surface 2: none of its pixels"):
        reconstruct(blind)
    with pytest.raises(InputError, match=r"hot pixels: 0\.5 times"):
        ReconstructOptions(hot_pixels=0.5)


def test_least_squares_is_an_option() -> None:
    scene = buffers()
    found = reconstruct(scene, [2], replace(SMALL, diffuse=DiffuseOptions("ls")))
    here = scene.surfaces == 2
    residual = scene.diffuse[here] - harmonics.evaluate(scene.normals[here]) @ found.environments[2].diffuse
    assert residual.max() > 0.01
