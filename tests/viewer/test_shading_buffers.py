"""Shading buffers under changed normals, as the shader recomposes them."""

import dataclasses
from typing import Any

import numpy as np
import pytest

from litrig.base.errors import InputError
from processing.reference.recompose import recompose
from processing.shape import harmonics
from tests.processing.matcap.maps import sharp
from tests.processing.shape.scene import TINT, buffers, bumped, diffuse_coefficients, environments
from tests.viewer.compare import codes_apart
from viewer.geometry import whole_picture
from viewer.materials.shading_buffers import ShadingBuffersMaterial, recomposed_picture
from viewer.renderer import Renderer

BUFFERS, LIGHT = buffers(), environments()
BUMPED = bumped(BUFFERS.normals)


def opaque(picture: np.ndarray) -> np.ndarray:
    return np.concatenate([picture, np.ones_like(picture[..., :1])], axis=-1)


@pytest.mark.parametrize("factors", [(1.0, 1.0), (0.25, 4.0), (0.0, 1.0), (1.5, 0.0)], ids=str)
def test_shader_and_reference_agree(renderer: Renderer, factors: tuple[float, float]) -> None:
    told: dict[str, Any] = {"diffuse_factor": factors[0], "reflection_factor": factors[1]}
    drawn = recomposed_picture(renderer, BUFFERS, LIGHT, BUMPED, **told)
    truth = recompose(BUFFERS, LIGHT, BUMPED, **told)
    assert np.abs(truth - BUFFERS.picture).max() > 0.3
    assert codes_apart(opaque(drawn), opaque(truth)) <= 2


@pytest.mark.parametrize("strength", [0.001, 0.01, 0.05, 2.0])
def test_from_hardly_any_change_to_a_large_one(renderer: Renderer, strength: float) -> None:
    """A little turns reflections over from the picture's own to the environment's."""
    normals = bumped(BUFFERS.normals, strength)
    drawn, truth = recomposed_picture(renderer, BUFFERS, LIGHT, normals), recompose(BUFFERS, LIGHT, normals)
    assert codes_apart(opaque(drawn), opaque(truth)) <= 2


def test_albedo_and_factors_that_vary_are_drawn_alike(renderer: Renderer) -> None:
    random = np.random.default_rng(2)
    albedo, mirror = (random.uniform(0.1, 1, BUFFERS.picture.shape).astype(np.float32) for _ in range(2))
    scene = dataclasses.replace(BUFFERS, albedo=albedo, reflection_albedo=mirror)
    light = {
        2: dataclasses.replace(LIGHT[2], diffuse_is_illumination=True),
        7: dataclasses.replace(LIGHT[7], reflection_is_illumination=True),
    }
    maps = (albedo[..., 0].copy(), mirror[..., 1].copy())
    drawn = recomposed_picture(renderer, scene, light, BUMPED, reflection_factor=2, factor_maps=maps)
    truth = recompose(scene, light, BUMPED, diffuse_factor=maps[0], reflection_factor=2 * maps[1])
    assert codes_apart(opaque(drawn), opaque(truth)) <= 2
    with pytest.raises(InputError, match="the buffers lack"):
        recomposed_picture(renderer, BUFFERS, light, BUMPED)


def test_what_was_negative_gets_no_darker_and_far_views_are_drawn_alike(renderer: Renderer) -> None:
    for scene in (
        dataclasses.replace(BUFFERS, diffuse=BUFFERS.diffuse - 0.5),
        dataclasses.replace(BUFFERS, orthographic=True, positions=np.zeros_like(BUFFERS.positions)),
    ):
        drawn, truth = recomposed_picture(renderer, scene, LIGHT, BUMPED), recompose(scene, LIGHT, BUMPED)
        assert codes_apart(opaque(drawn), opaque(truth)) <= 2


def test_untouched_pixels_keep_their_bits(renderer: Renderer) -> None:
    untouched = np.all(BUFFERS.normals == BUMPED, axis=-1)
    assert 0.3 < untouched.mean() < 0.9
    drawn = recomposed_picture(renderer, BUFFERS, LIGHT, BUMPED)
    np.testing.assert_array_equal(drawn[untouched], BUFFERS.picture[untouched])
    np.testing.assert_array_equal(recomposed_picture(renderer, BUFFERS, LIGHT, BUFFERS.normals), BUFFERS.picture)


def test_where_nothing_is_in_the_way_it_is_the_shading_of_the_new_normals(renderer: Renderer) -> None:
    """No reference in this truth: the light's own formula, under the new normal."""
    normals = bumped(BUFFERS.normals, 0.6)
    ones = np.ones_like(BUFFERS.coverage)
    rays = BUFFERS.positions / np.maximum(np.linalg.norm(BUFFERS.positions, axis=-1, keepdims=True), 1e-9)
    opened = dataclasses.replace(BUFFERS, ambient_occlusion=ones, reflection_occlusion=ones)
    drawn = recomposed_picture(renderer, opened, environments(256), normals, horizon=0)
    for number in TINT:
        here = (BUFFERS.surfaces == number) & (BUFFERS.coverage == 1) & np.any(normals != BUFFERS.normals, axis=-1)
        assert here.sum() > 500
        n, new = BUFFERS.normals[here].astype(np.float64), normals[here].astype(np.float64)
        mirrored = 2 * np.sum(new * -rays[here], axis=-1, keepdims=True) * new + rays[here]
        change = (harmonics.evaluate(new) - harmonics.evaluate(n)) @ diffuse_coefficients(number)
        expected = np.maximum(BUFFERS.diffuse[here] + change, 0) + sharp(mirrored) * TINT[number]
        np.testing.assert_allclose(np.quantile(np.abs(drawn[here] - expected), 0.99), 0, atol=0.02)


def test_a_surface_without_an_environment_stays(renderer: Renderer) -> None:
    drawn = recomposed_picture(renderer, BUFFERS, {7: LIGHT[7]}, BUMPED)
    other = BUFFERS.surfaces != 7
    np.testing.assert_array_equal(drawn[other], BUFFERS.picture[other])
    assert np.abs(drawn - BUFFERS.picture).max() > 0.1


def test_normals_are_changed_without_opening_anything_again(renderer: Renderer) -> None:
    height, width = BUFFERS.shape
    with (
        renderer.upload(ShadingBuffersMaterial, BUFFERS, LIGHT) as material,
        renderer.upload(whole_picture) as everything,
    ):
        for normals in (BUMPED, BUFFERS.normals, BUMPED):
            material.change_normals(normals)
            drawn = renderer.picture(material.look(), everything, size=(width, height))[::-1, :, :3]
            np.testing.assert_array_equal(drawn, recomposed_picture(renderer, BUFFERS, LIGHT, normals))
        with pytest.raises(InputError, match="not those of 150 × 120"):
            material.change_normals(BUMPED[:5])
        with pytest.raises(InputError, match="no numbers"):
            material.change_normals(BUMPED * np.nan)


@pytest.mark.parametrize(
    ("light", "reason"),
    [
        ({}, "give at least one"),
        ({0: LIGHT[2]}, "0 is background"),
        ({2: LIGHT[2], 7: environments(8)[7]}, "not square and of one size"),
        ({2: dataclasses.replace(LIGHT[2], diffuse=np.zeros((4, 3), np.float32))}, "9 coefficients"),
        ({2: dataclasses.replace(LIGHT[2], front=LIGHT[2].front * np.inf)}, "no numbers"),
    ],
    ids=["none", "background", "sizes", "coefficients", "infinite"],
)
def test_environments_that_are_none_are_refused(renderer: Renderer, light: dict, reason: str) -> None:  # type: ignore[type-arg]
    with pytest.raises(InputError, match=reason), renderer.upload(ShadingBuffersMaterial, BUFFERS, light):
        pass


def test_a_picture_larger_than_the_driver_takes_is_refused(renderer: Renderer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("moderngl.Context.info", {"GL_MAX_TEXTURE_SIZE": 100, "GL_MAX_ARRAY_TEXTURE_LAYERS": 256})
    with (
        pytest.raises(InputError, match="150 × 120 pixels, but this graphics driver ends at 100"),
        renderer.upload(ShadingBuffersMaterial, BUFFERS, LIGHT),
    ):
        pass
