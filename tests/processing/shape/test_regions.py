"""An extended wavy wall under light that changes along it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from litrig.base.errors import FormatError, InputError
from processing.reference.recompose import recompose as in_numpy
from processing.shape import harmonics
from processing.shape.env_exr import read_environments, write_environments
from processing.shape.extended.blend import recompose_regions, region_weights
from processing.shape.extended.divide import divide
from processing.shape.model import Region, ShadingBuffers
from processing.shape.recompose import recompose
from processing.shape.reconstruct import ReconstructOptions, reconstruct
from processing.shape.reflection.environment import ReflectionOptions
from tests.processing.matcap.maps import sharp
from tests.processing.shape.scene import buffers, bumped, diffuse_coefficients, environments

SMALL = ReconstructOptions(reflection=ReflectionOptions(32))


def wall(height: int = 40, width: int = 160) -> ShadingBuffers:
    rows, columns = np.indices((height, width)).astype(np.float64)
    tilted = np.stack([np.sin(columns / 3), np.cos(rows / 3), np.full((height, width), 0.9)], axis=-1)
    normals = tilted / np.linalg.norm(tilted, axis=-1, keepdims=True)
    positions = np.stack(
        [(columns - width / 2) / 20, (height / 2 - rows) / 20, np.full((height, width), -9.0)], axis=-1
    )
    to_eye = -positions / np.linalg.norm(positions, axis=-1, keepdims=True)
    mirrored = 2 * np.sum(normals * to_eye, axis=-1, keepdims=True) * normals - to_eye
    brightness = (0.3 + columns / width)[..., None]
    diffuse = harmonics.evaluate(normals) @ diffuse_coefficients(2) * brightness
    reflection = (sharp(mirrored) + 0.2) * brightness
    ones = np.ones((height, width), np.float32)
    d, r, n, p = (plane.astype(np.float32) for plane in (diffuse, reflection, normals, positions))
    return ShadingBuffers(d + r, ones, d, r, n, p, np.full((height, width), 4, np.uint32), ones, ones)


WALL = wall()


def test_weights_add_up_to_one_and_the_nearest_counts_most() -> None:
    centres = np.array([[0, 0, 0], [1, 0, 0], [5, 0, 0]], np.float32)
    weights = region_weights(centres, 0.5, np.array([[0.1, 0, 0], [0.5, 3, 0], [900, 0, 0]]))
    np.testing.assert_allclose(weights.sum(axis=1), 1)
    assert weights[0].argmax() == 0
    assert weights[1, 0] == pytest.approx(weights[1, 1])
    np.testing.assert_allclose(weights[2], [0, 0, 1])


def test_light_that_changes_along_a_surface_is_found_in_regions() -> None:
    """Shading that is rebuilt at the same normals is what the light was there."""
    errors = []
    for count in (1, 6):
        found = reconstruct(WALL, options=replace(SMALL, regions=count)).environments[4]
        parts = [region.environment for region in found.regions] or [found]
        weights = np.ones((*WALL.shape, 1))
        if found.regions:
            centres = np.stack([region.centre for region in found.regions])
            weights = region_weights(centres, found.falloff, WALL.positions)
        basis = harmonics.evaluate(WALL.normals)
        rebuilt = sum(weights[..., k, None] * (basis @ part.diffuse) for k, part in enumerate(parts))
        errors.append(np.abs(rebuilt - WALL.diffuse).mean())
        assert len(found.regions) == (count if count > 1 else 0)
    assert errors[1] < 0.35 * errors[0]


def test_edited_normals_get_the_light_of_their_place() -> None:
    """Turned to the normal of a pixel far away, a pixel is still lit as at its own place."""
    found = reconstruct(WALL, options=replace(SMALL, regions=6)).environments
    whole = reconstruct(WALL, options=SMALL).environments
    turned = np.roll(WALL.normals, 5, axis=1)
    brightness = 0.3 + np.arange(WALL.shape[1])[:, None] / WALL.shape[1]
    truth = harmonics.evaluate(turned) @ diffuse_coefficients(2) * brightness
    black = WALL.diffuse + WALL.reflection - WALL.picture
    blended = recompose_regions(recompose, WALL, found, turned, reflection_factor=0.0) + black
    same = recompose(WALL, whole, turned, reflection_factor=0.0) + black
    assert np.abs(blended - truth).mean() < 0.7 * np.abs(same - truth).mean()


def test_what_is_not_edited_keeps_its_bits() -> None:
    found = reconstruct(WALL, options=replace(SMALL, regions=3)).environments
    np.testing.assert_array_equal(recompose_regions(recompose, WALL, found, WALL.normals), WALL.picture)
    np.testing.assert_array_equal(recompose_regions(in_numpy, WALL, found, WALL.normals), WALL.picture)


def test_regions_of_one_light_are_as_none_and_other_surfaces_are_shaded_once() -> None:
    scene, light = buffers(), environments(32)
    regions = tuple(Region(np.array([x, 0, -4], np.float32), light[2]) for x in (-1, -0.5, 0))
    divided = {2: replace(light[2], regions=regions, falloff=0.3), 7: light[7]}
    normals = bumped(scene.normals)
    for shade in (recompose, in_numpy):
        expected = shade(scene, light, normals)
        np.testing.assert_allclose(recompose_regions(shade, scene, divided, normals), expected, atol=1e-6)


def test_numpy_and_the_processor_blend_alike() -> None:
    found = reconstruct(WALL, options=replace(SMALL, regions=3)).environments
    turned = np.roll(WALL.normals, 4, axis=0)
    one, other = (recompose_regions(shade, WALL, found, turned) for shade in (recompose, in_numpy))
    np.testing.assert_allclose(one, other, atol=2e-4)


def test_regions_are_written_and_read_bit_by_bit(tmp_path: Path) -> None:
    found = reconstruct(WALL, options=replace(SMALL, regions=2)).environments
    both = {4: found[4], 9: replace(found[4], regions=(), falloff=0.0)}
    write_environments(tmp_path / "x.env.exr", both)
    read = read_environments(tmp_path / "x.env.exr")
    assert not read[9].regions
    assert read[4].falloff == found[4].falloff
    for one, other in zip(read[4].regions, found[4].regions, strict=True):
        np.testing.assert_array_equal(one.centre, other.centre)
        for name in ("diffuse", "front", "back"):
            np.testing.assert_array_equal(getattr(one.environment, name), getattr(other.environment, name))


def test_a_falloff_of_nothing_is_not_written(tmp_path: Path) -> None:
    light = environments(8)
    flat = {2: replace(light[2], regions=(Region(np.zeros(3, np.float32), light[7]),))}
    with pytest.raises((InputError, FormatError), match="falloff"):
        write_environments(tmp_path / "x.env.exr", flat)


def test_places_that_cannot_be_divided_are_refused() -> None:
    with pytest.raises(InputError, match="cannot be divided into 3"):
        divide(np.zeros((100, 3), np.float32), 3)
    nowhere = replace(WALL, positions=np.broadcast_to(np.array([0, 0, -1], np.float32), (*WALL.shape, 3)))
    with pytest.raises(InputError, match="surface 4: has no positions"):
        reconstruct(replace(nowhere, orthographic=True), options=replace(SMALL, regions=2))
    with pytest.raises(InputError, match="regions: 0"):
        ReconstructOptions(regions=0)
