import numpy as np
import pytest

from litrig.base.errors import InputError
from processing.matcap.estimate.estimate import estimate_filter_size
from processing.matcap.estimate.regions import Region
from processing.matcap.filter import MATT_FILTER_SIZE, slope_of
from tests.processing.matcap.estimate.primitives import SHAPES, Primitive, Shape, estimated, matcap_of


@pytest.mark.parametrize("shape", SHAPES)
def test_known_variances_are_read_off_8_bits(shape: Shape) -> None:
    primitive = Primitive(shape, theta=0.7, deviation=0.14)
    found = estimated(primitive, size=128)
    goal = 0.01 if primitive.of == "edges" else 0.005
    assert found.filter_size == pytest.approx(primitive.variance, rel=goal)
    assert found.slope == slope_of(found.filter_size)


def test_the_same_light_has_the_same_size_whatever_the_resolution() -> None:
    light = Primitive("spot", theta=0.4, deviation=0.2)
    sizes = [estimated(light, size).filter_size for size in (96, 192)]
    assert sizes[0] == pytest.approx(sizes[1], rel=0.005)


def test_a_light_that_the_rim_cuts_is_not_taken_for_a_narrower_one() -> None:
    light = Primitive("spot", theta=1.0, deviation=0.4)
    assert estimated(light, size=128).filter_size == pytest.approx(light.variance, rel=0.01)


def test_both_sides_of_a_wide_ring_are_not_taken_for_one_light() -> None:
    ring = Primitive("ring", theta=0.4, deviation=0.4)
    found = estimated(ring, size=128)
    assert found.filter_size == pytest.approx(ring.variance, rel=0.01)
    assert "another light is near" in found.remarks[0]


def test_a_region_beside_the_middle_of_a_light_says_the_same() -> None:
    light = Primitive("spot", theta=0.7, deviation=0.2)
    beside = Region.around(0.8, light.phi, 128, 5)
    found = estimate_filter_size(matcap_of(light, size=128), [beside], of="values")
    assert found.filter_size == pytest.approx(light.variance, rel=0.01)


def test_of_many_regions_the_sharpest_decides() -> None:
    lights = [Primitive("spot", 0.6, 0.2), Primitive("spot", 0.9, 0.1, phi=2.8), Primitive("spot", 0.8, 0.15, phi=5)]
    found = estimate_filter_size(matcap_of(*lights, size=96), [light.region(96) for light in lights])
    assert found.chosen == 1
    assert found.filter_size == pytest.approx(0.01, rel=0.02)


@pytest.mark.parametrize("shape", ["spot", "straight edge"])
def test_the_sharpest_light_is_found_by_itself(shape: Shape) -> None:
    sharp, wide = Primitive(shape, 0.8, 0.1), Primitive("spot", 0.5, 0.3, phi=3.8)
    matcap = matcap_of(sharp, size=96) if shape != "spot" else matcap_of(sharp, wide, size=96)
    found = estimate_filter_size(matcap)
    assert found.filter_size == pytest.approx(sharp.variance, rel=0.05)
    chosen = found.regions[found.chosen or 0]
    assert (chosen.of == "edges") == (sharp.of == "edges")
    assert chosen.trusted


def test_the_flank_of_a_spot_is_not_taken_for_an_edge() -> None:
    spot = Primitive("spot", 0.7, 0.2)
    found = estimate_filter_size(matcap_of(spot, size=96))
    assert found.filter_size == pytest.approx(spot.variance, rel=0.05)


def test_a_highlight_on_a_matt_ground_is_found_and_read_above_it() -> None:
    spot = Primitive("spot", 0.7, 0.1)
    along = (2 * np.arange(160) + 1) / 160 - 1
    ground = 0.3 * np.sqrt(np.clip(1 - along**2 - along[:, None] ** 2, 0, None))[..., None]
    found = estimate_filter_size((0.6 * matcap_of(spot, size=160) + ground).astype(np.float32))
    assert found.regions[found.chosen or 0].of == "bumps"
    assert found.filter_size == pytest.approx(spot.variance, rel=0.1)


@pytest.mark.parametrize("brightness", [0.0, 0.5])
def test_where_nothing_stands_out_the_material_is_taken_for_matt(brightness: float) -> None:
    found = estimate_filter_size(np.full((64, 64, 3), brightness, np.float32))
    assert found.filter_size == MATT_FILTER_SIZE
    assert found.chosen is None
    assert "no feature is sharp enough" in found.remarks[0]


def test_noise_alone_is_no_feature() -> None:
    noise = np.random.default_rng(5).normal(0.5, 0.01, (96, 96, 1)).repeat(3, axis=2).clip(0, 1).astype(np.float32)
    assert estimate_filter_size(noise).filter_size == MATT_FILTER_SIZE


def test_a_black_region_is_degenerate() -> None:
    light = Primitive("spot", 0.7, 0.08)
    found = estimate_filter_size(matcap_of(light, size=96), [Region.around(0.7, light.phi + np.pi / 2, 96, 3)])
    assert found.filter_size == MATT_FILTER_SIZE
    assert "degenerate" in found.regions[0].remarks[0]


def test_clipped_light_seems_rougher_and_is_remarked_on() -> None:
    light = Primitive("spot", 0.7, 0.14)
    clipped = np.minimum(2 * matcap_of(light, size=96), 1)
    found = estimate_filter_size(clipped, [light.region(96)], of="values")
    assert found.filter_size > 1.2 * light.variance
    assert "clipped" in found.remarks[0]


def test_an_edge_as_sharp_as_the_pixels_is_a_bound() -> None:
    found = estimate_filter_size(matcap_of(Primitive("straight edge", 0.5, 0.004), size=96))
    assert found.filter_size < 0.03**2
    assert any("as sharp as pixels allow" in remark for remark in found.remarks)


def test_a_quantile_of_the_region_can_be_asked_for() -> None:
    light = Primitive("straight edge", 0.7, 0.2)
    matcap, region = matcap_of(light, size=96), light.region(96)
    least, median = (estimate_filter_size(matcap, [region], of="edges", quantile=quantile) for quantile in (0.0, None))
    assert least.filter_size == least.regions[0].least < median.filter_size


def test_the_papers_rule_finds_a_clean_spot_too() -> None:
    light = Primitive("spot", 0.4, 0.2)
    matcap = matcap_of(light, size=128, bits=False)
    found = estimate_filter_size(matcap, [light.region(128)], of="values", rule="paper", quantile=0.5)
    assert found.filter_size == pytest.approx(light.variance, rel=0.03)


@pytest.mark.parametrize(
    ("region", "reason"),
    [
        (Region(0, 0, 2, 2), "outside the disc"),
        (Region(60, 60, 9, 9), "beyond the 64 × 64 pixels"),
        (Region(3, 3, 0, 4), "no rectangle"),
        (Region(-1, 3, 4, 4), "no rectangle"),
    ],
)
def test_a_region_must_be_on_the_disc(region: Region, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        estimate_filter_size(np.ones((64, 64, 3), np.float32), [region])


@pytest.mark.parametrize("shape", [(64, 32, 3), (64, 64), (8, 8, 3)])
def test_what_is_no_matcap_is_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(InputError, match="no square picture"):
        estimate_filter_size(np.ones(shape, np.float32))


def test_colours_that_are_no_numbers_are_refused() -> None:
    with pytest.raises(InputError, match="no numbers"):
        estimate_filter_size(np.full((32, 32, 3), np.nan, np.float32))
