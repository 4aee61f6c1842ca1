"""Texture goes, the material stays."""

import numpy as np
import pytest
from numpy.typing import NDArray

from processing.amc.flaws.weave import average_weave, weave_texture
from tests.processing.amc.flaws.flawed_sphere import Material, Place, blotches, clean, disc, seen, seen_all, weave

F32 = NDArray[np.float32]

SIZE, NOISE = 64, 0.003
VALID = disc(SIZE)
TEXEL = 2 / SIZE
ANGLES_RAD = (np.arange(40) + np.random.default_rng(1).uniform(-0.1, 0.1, 40)) * 2 * np.pi / 40 + 2


def shot(material: Material, texture: Place | None) -> tuple[F32, F32]:
    """Slices with their noise, and the truth without texture."""
    truth = clean(material, SIZE, tuple(ANGLES_RAD))
    factor = 1 if texture is None else seen_all(texture, SIZE, ANGLES_RAD - ANGLES_RAD[0])[..., None]
    noise = NOISE * np.random.default_rng(2).standard_normal(truth.shape)
    return (truth * factor + noise).astype(np.float32), truth


def psnr_db(found: F32, truth: F32) -> float:
    return float(10 * np.log10(truth[:, VALID].max() ** 2 / np.mean((found - truth)[:, VALID] ** 2)))


@pytest.mark.parametrize("repeats", [0, 1, 2, 3, 4])
@pytest.mark.parametrize(
    ("texture", "gain_db"),
    [
        pytest.param(weave(5 * TEXEL, 0.25), 10, id="weave"),
        pytest.param(weave(7 * TEXEL, 0.15), 8, id="coarse weave"),
        pytest.param(blotches(1, 6 * TEXEL, 0.08), 3, id="felt"),
    ],
)
def test_texture_is_taken_out(repeats: int, texture: Place, gain_db: float) -> None:
    slices, truth = shot(Material(repeats, 1.2), texture)
    assert psnr_db(average_weave(slices, ANGLES_RAD, VALID), truth) > psnr_db(slices, truth) + gain_db


@pytest.mark.parametrize("repeats", [0, 1, 2, 3, 4])
def test_without_texture_hardly_more_than_the_noise_changes(repeats: int) -> None:
    slices, _ = shot(Material(repeats, 1.2), None)
    change = average_weave(slices, ANGLES_RAD, VALID) - slices
    assert np.sqrt(np.mean(change[:, VALID] ** 2)) < 1.5 * NOISE


def test_anisotropy_survives() -> None:
    """How the slices differ from their mean is the material's anisotropy; a blur over the turn would shrink it."""
    slices, truth = shot(Material(2, 1.4), weave(5 * TEXEL, 0.25))
    averaged = average_weave(slices, ANGLES_RAD, VALID)
    kept, true = ((one - one.mean(axis=0))[:, VALID].ravel() for one in (averaged, truth))
    assert float(kept @ true / (true @ true)) == pytest.approx(1, abs=0.02)


def test_the_texture_is_the_one_that_was_put_in() -> None:
    slices, _ = shot(Material(2), weave(5 * TEXEL, 0.2))
    found = weave_texture(slices, ANGLES_RAD - ANGLES_RAD[0], VALID).mean(axis=-1)
    true = np.log(seen(weave(5 * TEXEL, 0.2), SIZE, 0))
    inner = disc(SIZE, 0.9)
    assert np.corrcoef(found[inner], true[inner])[0, 1] > 0.97
    assert np.std(found[inner]) == pytest.approx(np.std(true[inner]), rel=0.1)


def test_what_was_not_seen_comes_back_as_it_was() -> None:
    slices, _ = shot(Material(2), weave(5 * TEXEL, 0.2))
    before = slices.copy()
    averaged = average_weave(slices, ANGLES_RAD, VALID)
    assert np.array_equal(averaged[:, ~VALID], before[:, ~VALID])
    assert np.array_equal(slices, before)
