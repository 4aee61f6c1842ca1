"""The same seed gives the same bits, whatever was rendered before; and weaves repeat as they are named."""

from typing import Literal

import numpy as np
import pytest
from numpy.typing import NDArray

from firmware_sim.mitsuba.config import Invariance, MitsubaScene
from firmware_sim.mitsuba.materials import fabric
from firmware_sim.mitsuba.renderer import MitsubaRenderer
from firmware_sim.mitsuba.scenes import SAMPLE, scene_dict
from firmware_sim.mitsuba.variants import load_mitsuba
from firmware_sim.scene.pose import Pose

SIZE = (64, 64)
STILL = Pose(0.0, 30.0, 50.0, 1.0)
SCENES = [
    pytest.param(MitsubaScene(samples=8), id="brushed metal in the studio"),
    pytest.param(MitsubaScene(samples=8, sample="fabric", lights="lamp"), id="fabric under the lamp"),
    pytest.param(MitsubaScene(samples=8, sample="relief", lights="near-lamp"), id="relief under a near lamp"),
]


@pytest.mark.parametrize("scene", SCENES)
def test_a_pose_gives_the_same_bits_whatever_came_before(variant: str, scene: MitsubaScene) -> None:
    fresh = MitsubaRenderer(scene, variant).render(STILL, SIZE)
    used = MitsubaRenderer(scene, variant)
    other = used.render(Pose(40.0, 200.0, 25.0, 0.5), SIZE)
    used.render(STILL, (32, 48))
    np.testing.assert_array_equal(used.render(STILL, SIZE), fresh)
    assert not np.array_equal(other, fresh)


def test_another_seed_and_another_pose_have_noise_of_their_own(variant: str) -> None:
    card = MitsubaScene(sample="white-card", samples=4)
    first = MitsubaRenderer(card, variant).render(STILL, SIZE)
    other_seed = MitsubaRenderer(card.model_copy(update={"seed": 2}), variant).render(STILL, SIZE)
    other_pose = MitsubaRenderer(card, variant).render(STILL._replace(turntable_deg=5.0), SIZE)
    for other in (other_seed, other_pose):
        correlation = np.corrcoef((first - first.mean()).ravel(), (other - other.mean()).ravel())[0, 1]
        assert abs(correlation) < 0.2


def rms(difference: NDArray[np.float32]) -> float:
    return float(np.sqrt(np.mean(difference.astype(np.float64) ** 2)))


def woven(variant: str, invariance: Invariance, turned_deg: float, seed: int) -> NDArray[np.float32]:
    """Render a sphere whose lobes alone are turned, in the tangent plane; the sphere stays where it is."""
    mitsuba = load_mitsuba(variant)
    scene = MitsubaScene(sample="fabric", invariance=invariance, projection="orthographic", samples=64)
    description = scene_dict(mitsuba, scene, SIZE)
    description[SAMPLE]["bsdf"] = fabric(invariance, turned_deg)
    picture = mitsuba.render(mitsuba.load_dict(description), spp=64, seed=seed)
    return np.array(picture, np.float32)[..., :3]


WEAVES: tuple[Literal[1, 2, 3, 4], ...] = (1, 2, 3, 4)


@pytest.mark.parametrize("invariance", WEAVES)
def test_a_weave_repeats_after_its_share_of_a_turn_and_not_after_half_of_that(
    variant: str, invariance: Literal[1, 2, 3, 4]
) -> None:
    here = woven(variant, invariance, 0, seed=1)
    noise = rms(here - woven(variant, invariance, 0, seed=2))
    repeated = rms(here - woven(variant, invariance, 360 / invariance, seed=3))
    between = rms(here - woven(variant, invariance, 180 / invariance, seed=4))
    assert repeated < 1.15 * noise
    assert between > 1.6 * noise


def test_the_isotropic_sphere_looks_the_same_however_it_is_turned(variant: str) -> None:
    isotropic, twofold = (
        MitsubaRenderer(MitsubaScene(sample="fabric", invariance=invariance), variant)
        for invariance in ("isotropic", 2)
    )
    straight, turned, again = (isotropic.render(STILL._replace(turntable_deg=a), SIZE) for a in (0.0, 50.0, 130.0))
    change = rms(straight - turned)
    assert change < 1.15 * rms(turned - again)
    assert rms(twofold.render(STILL, SIZE) - twofold.render(STILL._replace(turntable_deg=50.0), SIZE)) > 1.5 * change
