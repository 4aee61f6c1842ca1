"""Pictures under other normals, as the processor makes them, beside the reference."""

import dataclasses

import numpy as np
import pytest

from litrig.base.errors import InputError
from processing.reference.recompose import recompose as reference
from processing.shape import harmonics
from processing.shape.model import Environments, ShadingBuffers
from processing.shape.recompose import Recomposer, recompose
from tests.processing.matcap.maps import sharp
from tests.processing.shape.scene import TINT, buffers, bumped, environments

BUFFERS, LIGHT = buffers(), environments()
BUMPED = bumped(BUFFERS.normals)
OPEN = dataclasses.replace(
    BUFFERS,
    ambient_occlusion=np.ones_like(BUFFERS.coverage),
    reflection_occlusion=np.ones_like(BUFFERS.coverage),
)


def bits(picture: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(picture, np.float32).view(np.uint32)


@pytest.mark.parametrize("scene", [BUFFERS, OPEN], ids=["occluded", "open"])
def test_unmodified_normals_give_the_picture_back_bit_for_bit(scene: ShadingBuffers) -> None:
    """Also where it holds more than diffuse and reflected light, −0, or no number at all."""
    emission = np.random.default_rng(0).normal(size=scene.picture.shape).astype(np.float32)
    emission[0, 0], emission[60, 50] = -0.0, np.nan
    lit = dataclasses.replace(scene, picture=np.where(emission == 0, emission, scene.picture + emission))
    np.testing.assert_array_equal(bits(recompose(lit, LIGHT, lit.normals)), bits(lit.picture))
    np.testing.assert_array_equal(bits(reference(lit, LIGHT, lit.normals)), bits(lit.picture))


def test_what_a_picture_has_besides_passes_through_edits() -> None:
    """Emission, and what is seen through a surface."""
    besides = np.random.default_rng(8).uniform(0, 2, BUFFERS.picture.shape).astype(np.float32)
    more = dataclasses.replace(BUFFERS, picture=BUFFERS.picture + besides)
    apart = recompose(more, LIGHT, BUMPED) - recompose(BUFFERS, LIGHT, BUMPED)
    np.testing.assert_allclose(apart, besides, atol=1e-5)


@pytest.mark.parametrize("factors", [(1.0, 1.0), (0.25, 4.0), (0.0, 1.0), (1.5, 0.0)], ids=str)
@pytest.mark.parametrize("strength", [0.001, 0.02, 0.25, 2.0])
def test_kernel_and_reference_agree(factors: tuple[float, float], strength: float) -> None:
    told = {"diffuse_factor": factors[0], "reflection_factor": factors[1]}
    normals = bumped(BUFFERS.normals, strength)
    made, truth = recompose(BUFFERS, LIGHT, normals, **told), reference(BUFFERS, LIGHT, normals, **told)
    np.testing.assert_allclose(made, truth, atol=2e-5)


def test_three_surfaces_that_reflect_each_other_are_edited_one_by_one() -> None:
    """The picture of one shows the others as they were; its own pixels alone change."""
    split = np.where((BUFFERS.surfaces == 7) & (BUFFERS.normals[..., 1] > 0), np.uint32(9), BUFFERS.surfaces)
    scene, light = dataclasses.replace(BUFFERS, surfaces=split), {**LIGHT, 9: LIGHT[2]}
    for number in light:
        here = scene.surfaces == number
        made = recompose(scene, light, np.where(here[..., None], BUMPED, BUFFERS.normals))
        np.testing.assert_array_equal(bits(made)[~here], bits(BUFFERS.picture)[~here])
        assert np.abs(made - BUFFERS.picture)[here].max() > 0.03


def test_factors_are_given_pixel_by_pixel_too() -> None:
    here = BUFFERS.surfaces == 7
    factor = np.where(here, 0.5, 1).astype(np.float32)
    made = recompose(BUFFERS, LIGHT, BUFFERS.normals, diffuse_factor=factor)
    np.testing.assert_array_equal(made[~here], BUFFERS.picture[~here])
    expected = BUFFERS.picture - 0.5 * BUFFERS.coverage[..., None] * BUFFERS.diffuse
    np.testing.assert_allclose(made[here], expected[here], atol=1e-6)
    np.testing.assert_allclose(reference(BUFFERS, LIGHT, BUFFERS.normals, diffuse_factor=factor), made, atol=1e-6)


def coloured() -> tuple[ShadingBuffers, Environments, np.ndarray, np.ndarray]:
    """Light times albedo: the same scene with a colour that varies over it."""
    random = np.random.default_rng(1)
    albedo, mirror = (random.uniform(0.1, 1, BUFFERS.picture.shape).astype(np.float32) for _ in range(2))
    diffuse, reflection = OPEN.diffuse * albedo, OPEN.reflection * mirror
    scene = dataclasses.replace(
        OPEN,
        diffuse=diffuse,
        reflection=reflection,
        picture=diffuse + reflection,
        coverage=np.ones_like(OPEN.coverage),
        albedo=albedo,
        reflection_albedo=mirror,
    )
    light = {
        number: dataclasses.replace(one, diffuse_is_illumination=True, reflection_is_illumination=True)
        for number, one in environments(256).items()
    }
    return scene, light, albedo, mirror


def test_light_is_multiplied_by_albedo_that_varies() -> None:
    """No reference in this truth: the light's own formula under the new normal, times the albedo."""
    scene, light, albedo, mirror = coloured()
    normals = bumped(scene.normals, 0.6)
    made = recompose(scene, light, normals, horizon=0)
    np.testing.assert_allclose(reference(scene, light, normals, horizon=0), made, atol=2e-5)
    for number, one in light.items():
        here = (scene.surfaces == number) & np.any(normals != scene.normals, axis=-1)
        new, eye = normals[here].astype(np.float64), scene.to_eye[here].astype(np.float64)
        change = (harmonics.evaluate(new) - harmonics.evaluate(scene.normals[here])) @ one.diffuse
        r = 2 * np.sum(new * eye, axis=1, keepdims=True) * new - eye
        expected = np.maximum(scene.diffuse[here] + albedo[here] * change, 0) + mirror[here] * sharp(r) * TINT[number]
        np.testing.assert_allclose(np.quantile(np.abs(made[here] - expected), 0.99), 0, atol=0.02)


def test_reflections_stay_where_the_surface_would_hide_what_is_mirrored() -> None:
    eye, n = OPEN.to_eye, BUFFERS.normals
    aside = np.cross(n, np.cross(n, eye)) * -1
    aside /= np.maximum(np.linalg.norm(aside, axis=-1, keepdims=True), 1e-6)
    facing = np.sum(n * eye, axis=-1)
    here = (BUFFERS.surfaces > 0) & (BUFFERS.coverage == 1) & (facing > 0.1) & (facing < 0.98)
    # Away from the eye until the mirrored ray is 5 degrees below the surface.
    tilt = (np.arccos(np.clip(facing, -1, 1)) - np.radians(95)) / 2
    turned = np.cos(tilt)[..., None] * n + np.sin(tilt)[..., None] * aside
    normals = np.where(here[..., None], turned, n).astype(np.float32)
    for make in (recompose, reference):
        mirrored_only = make(OPEN, LIGHT, normals) - make(OPEN, LIGHT, normals, reflection_factor=0)
        np.testing.assert_allclose(mirrored_only[here], OPEN.reflection[here], atol=1e-4)


def test_light_without_its_albedo_is_refused() -> None:
    _, light, _, _ = coloured()
    for make in (recompose, reference):
        with pytest.raises(InputError, match="before its albedo, which the buffers lack"):
            make(BUFFERS, light, BUMPED)


def test_what_is_seen_along_one_direction_is_mirrored_along_it() -> None:
    far = dataclasses.replace(OPEN, orthographic=True, positions=np.zeros_like(OPEN.positions))
    np.testing.assert_allclose(recompose(far, LIGHT, BUMPED), reference(far, LIGHT, BUMPED), atol=2e-5)
    here = (BUFFERS.surfaces == 2) & np.any(BUFFERS.normals != BUMPED, axis=-1) & (BUFFERS.coverage == 1)
    n, new = BUFFERS.normals[here].astype(np.float64), BUMPED[here].astype(np.float64)
    change = (harmonics.evaluate(new) - harmonics.evaluate(n)) @ LIGHT[2].diffuse
    expected = np.maximum(OPEN.diffuse[here] + change, 0) + sharp(2 * new[:, 2:] * new - [0, 0, 1])
    apart = np.abs(recompose(far, environments(256), BUMPED)[here] - expected)
    assert np.quantile(apart, 0.99) < 0.02


def test_negative_shading_gets_no_darker_and_stays_where_it_is_untouched() -> None:
    dark = dataclasses.replace(BUFFERS, diffuse=BUFFERS.diffuse - 3)
    np.testing.assert_array_equal(recompose(dark, LIGHT, dark.normals), dark.picture)
    made = recompose(dark, LIGHT, BUMPED, reflection_factor=0)
    np.testing.assert_allclose(made, reference(dark, LIGHT, BUMPED, reflection_factor=0), atol=2e-5)


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(InputError, match="give at least one"):
        Recomposer(BUFFERS, {})
    with pytest.raises(InputError, match="not square and of one size"):
        Recomposer(BUFFERS, {2: LIGHT[2], 7: environments(8)[7]})
    with pytest.raises(InputError, match="not those of 150 × 120"):
        recompose(BUFFERS, LIGHT, BUMPED[:5])
    with pytest.raises(InputError, match="factors"):
        recompose(BUFFERS, LIGHT, BUMPED, diffuse_factor=np.ones(4, np.float32))
