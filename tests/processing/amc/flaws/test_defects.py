"""What is wrong with the sample is found, and what is right is left alone."""

from dataclasses import dataclass, field

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import ndimage

from processing.amc.flaws.defects import Defects, find_defects
from processing.amc.flaws.still_marks import find_still
from tests.processing.amc.flaws.flawed_sphere import (
    Material,
    Place,
    arc_seam,
    blotches,
    clean,
    disc,
    line_cut,
    seen,
    seen_all,
    weave,
    wedge,
)

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

SIZE = 64
VALID = disc(SIZE)
TEXEL = 2 / SIZE
AROUND = np.ones((3, 3))


def angles(count: int, seed: int = 0) -> F64:
    jitter = np.random.default_rng(seed).uniform(-0.15, 0.15, count)
    return np.asarray((np.arange(count) + jitter) * 2 * np.pi / count + seed)


@dataclass(frozen=True)
class Sample:
    """A covered sphere as it is shot: the material, its texture, one flaw, noise."""

    material: Material = field(default_factory=Material)
    texture: Place | None = None
    flaw: Place | None = None
    looks: str = "dark"
    slices: int = 40
    noise: float = 0.003
    seed: int = 0

    def shoot(self) -> tuple[F32, F64]:
        angles_rad = angles(self.slices, self.seed)
        turns_rad = angles_rad - angles_rad[0]
        light = clean(self.material, SIZE, tuple(angles_rad))
        if self.texture is not None:
            light = light * seen_all(self.texture, SIZE, turns_rad)[..., None]
        if self.flaw is not None:
            cover = seen_all(self.flaw, SIZE, turns_rad)[..., None]
            light = light + cover * (self._within(angles_rad) - light)
        noise = self.noise * np.random.default_rng(self.seed).standard_normal(light.shape)
        return np.maximum(light + noise, 0).astype(np.float32), angles_rad

    def _within(self, angles_rad: F64) -> F32:
        light = clean(self.material, SIZE, tuple(angles_rad))
        if self.looks == "fold":
            return clean(self.material, SIZE, tuple(angles_rad + np.pi / 3))
        return light * np.float32(0.4) if self.looks == "dark" else light + np.float32(0.6 * light.mean())

    def find(self) -> Defects:
        return find_defects(*self.shoot(), VALID)


def recall_and_false(found: Defects, flaw: Place) -> tuple[float, float]:
    """Share of the flaw that is marked, and share of what lies three texels off it that is marked too."""
    seen_there = seen(flaw, SIZE, 0)
    cover, off = (seen_there > 0.5) & VALID, VALID & ~ndimage.binary_dilation(seen_there > 0.02, AROUND, iterations=3)
    return float(found.turning[cover].mean()), float(found.turning[off].mean())


@pytest.mark.parametrize(
    "sample",
    [
        pytest.param(Sample(Material(1, 1.4)), id="fur that leans one way"),
        pytest.param(Sample(Material(2, 1.6, light_seed=3)), id="narrow highlights"),
        pytest.param(Sample(Material(3, 1.2), slices=64), id="three ways"),
        pytest.param(Sample(Material(4, 1.4, light_seed=5), slices=32), id="crossed threads, few slices"),
        pytest.param(Sample(Material(0), noise=0.001), id="isotropic, hardly any noise"),
        pytest.param(Sample(texture=weave(5 * TEXEL, 0.25)), id="woven"),
        pytest.param(Sample(Material(4), texture=blotches(3, 8 * TEXEL, 0.08)), id="felt"),
        pytest.param(Sample(noise=0.02), id="noisy"),
    ],
)
def test_an_even_sample_raises_no_alarm(sample: Sample) -> None:
    found = sample.find()
    assert not found.turning.any()
    assert not found.still.any()
    assert not found.middles.any()


CUT = line_cut(0.4, 0.1, 1.5 * TEXEL, 0.15)


@pytest.mark.parametrize(
    ("sample", "recall"),
    [
        pytest.param(Sample(flaw=CUT), 0.95, id="a dark cut of a texel and a half"),
        pytest.param(Sample(Material(4), flaw=CUT, looks="bright"), 0.95, id="the ground shines through"),
        pytest.param(Sample(Material(1, light_seed=2), flaw=CUT), 0.9, id="a cut in fur"),
        pytest.param(Sample(Material(0), flaw=CUT, looks="bright"), 0.95, id="isotropic"),
        pytest.param(Sample(flaw=line_cut(2, -0.2, 2 * TEXEL), looks="fold"), 0.6, id="a fold, tangent 60 degrees off"),
        pytest.param(Sample(flaw=wedge(2.5, 0.3, 0.3)), 0.9, id="a dart"),
        pytest.param(Sample(flaw=arc_seam(0.6, 0.3, 0.7, 2 * TEXEL)), 0.95, id="a curved seam"),
        pytest.param(Sample(flaw=arc_seam(0.5, 0, 0.5, 2 * TEXEL), looks="fold"), 0.6, id="a curved seam, folded"),
        pytest.param(Sample(flaw=CUT, texture=weave(5 * TEXEL, 0.2)), 0.9, id="a cut in a weave"),
        pytest.param(Sample(Material(3), flaw=CUT, texture=blotches(3, 8 * TEXEL, 0.06)), 0.9, id="a cut in felt"),
    ],
)
def test_a_flaw_is_found_where_it_is(sample: Sample, recall: float) -> None:
    assert sample.flaw is not None
    found = sample.find()
    marked, false = recall_and_false(found, sample.flaw)
    assert marked >= recall
    assert false < 0.01
    assert found.middles[found.turning].any()
    assert not found.middles[~found.turning].any()


def test_a_fold_in_an_isotropic_material_does_no_harm() -> None:
    assert not Sample(Material(0), flaw=CUT, looks="fold").find().turning.any()


def test_the_middles_of_a_dart_lie_within_it() -> None:
    dart = wedge(2.5, 0.4, 0.2)
    found = Sample(flaw=dart).find()
    cover = seen(dart, SIZE, 0)
    assert np.mean(cover[found.middles] > 0) > 0.7 > 0.6 > np.mean(cover[found.turning] > 0), "marks are wider"
    assert found.middles[VALID & (cover == 1)].mean() > 0.9


@pytest.mark.parametrize("kind", [0, 2, 4])
@pytest.mark.parametrize(
    ("height", "width", "brightness"),
    [
        pytest.param(1, 1, 0.3, id="hot"),
        pytest.param(1, 1, -0.2, id="dead"),
        pytest.param(2, 2, 0.15, id="hot, between four texels"),
    ],
)
def test_hot_pixels_stand_still(kind: int, height: int, width: int, brightness: float) -> None:
    slices, angles_rad = Sample(Material(kind), texture=weave(5 * TEXEL, 0.15)).shoot()
    slices[:, 20 : 20 + height, 30 : 30 + width] += np.float32(brightness)
    found = find_defects(np.maximum(slices, 0), angles_rad, VALID)
    assert found.still[20 : 20 + height, 30 : 30 + width].all()
    assert found.still.sum() <= height * width + 2
    assert not found.turning.any()


def test_a_hot_pixel_of_one_channel_is_found() -> None:
    slices, _ = Sample().shoot()
    slices[:, 40, 17, 2] += 0.3
    assert np.argwhere(find_still(slices, VALID)).tolist() == [[40, 17]]


def test_what_shines_in_half_of_the_slices_is_no_hot_pixel() -> None:
    slices, _ = Sample(slices=41).shoot()
    slices[::2, 40, 17] += 0.3
    assert not find_still(slices, VALID).any()


def test_a_cut_and_a_hot_pixel_are_told_apart() -> None:
    slices, angles_rad = Sample(flaw=CUT).shoot()
    slices[:, 45, 20] += 0.4
    found = find_defects(slices, angles_rad, VALID)
    assert np.argwhere(found.still).tolist() == [[45, 20]]
    assert recall_and_false(found, CUT)[0] > 0.9


def test_a_random_campaign_finds_most_and_raises_few_alarms() -> None:
    """Six even samples and as many with one cut of any kind."""
    recalls, falses = [], []
    for seed in (*range(4), *range(8, 12), *range(20, 24)):
        random = np.random.default_rng(seed)
        material = Material(int(random.integers(0, 5)), random.uniform(0.8, 1.5), random.uniform(0.5, 1.2), seed)
        texture = [None, weave(random.uniform(4, 7) * TEXEL, 0.2), blotches(seed, 8 * TEXEL, 0.06)][seed // 2 % 3]
        width, turn_rad, offset = random.uniform(1.5, 3) * TEXEL, random.uniform(0, 6), random.uniform(-0.5, 0.5)
        flaw = [line_cut(turn_rad, offset, width, 0.2), wedge(turn_rad, 0.3, 0.4)][seed // 4 % 2] if seed % 2 else None
        looks = ["dark", "bright"][seed // 8 % 2]
        found = Sample(material, texture, flaw, looks, int(random.choice([32, 48])), 0.003, seed).find()
        marked, false = (np.nan, float(found.turning.mean())) if flaw is None else recall_and_false(found, flaw)
        recalls.append(marked)
        falses.append(false)
    assert np.nanmean(recalls) > 0.93
    assert np.mean(falses) < 0.002
    assert np.mean(np.array(falses)[::2] > 0) <= 1 / 12
