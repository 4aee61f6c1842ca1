"""New materials: their pixels, their ends, their statistics."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from litrig.base.errors import InputError
from processing.ptm.basis import Basis
from processing.ptm.model import Colour
from processing.ptm.synthesis.guidance import Guidance, brightness_ranks
from processing.ptm.synthesis.orthonormal import orthonormal
from processing.ptm.synthesis.quality import copy_sizes, lit, measure, statistics_off, wrap_percentiles
from processing.ptm.synthesis.settings import Join, Synthesis
from processing.ptm.synthesis.synthesize import synthesize
from tests.processing.ptm.synthesis.textures import bits, flat, rough

SMALL = Synthesis(16, 4)


@pytest.mark.parametrize("colour", ["lrgb", "rgb"])
def test_where_blocks_are_cut_every_pixel_is_one_of_the_source_bit_by_bit(colour: Colour) -> None:
    source = rough(48, colour)
    result = synthesize([source], (50, 61), SMALL)
    assert result.material.shape == (50, 61)
    assert result.material.kind == colour
    index, rows, columns = (part[:50, :61] for part in result.canvas.origins())
    assert not index.any()
    np.testing.assert_array_equal(result.material.coefficients, source.coefficients[:, rows, columns])
    if source.colour is not None and result.material.colour is not None:
        np.testing.assert_array_equal(result.material.colour, source.colour[rows, columns])


def test_a_blend_mixes_functions_in_equal_measure() -> None:
    """Beside an overlap pixels keep their bits; in it they lie between the two, as their pictures do."""
    source = rough(48)
    settings = replace(SMALL, join="blend")
    result = synthesize([source], (16, 28), settings)
    (first, second), columns = result.canvas.taken, np.arange(12, 16)
    old = source.coefficients[:, first.source_y : first.source_y + 16, first.source_x + columns]
    new = source.coefficients[:, second.source_y : second.source_y + 16, second.source_x + columns - 12]
    weight = (np.arange(4) + 1)[:, None] / 5
    np.testing.assert_allclose(result.material.coefficients[:, :, columns], old + weight * (new - old), atol=1e-5)
    kept = source.coefficients[:, first.source_y : first.source_y + 16, first.source_x : first.source_x + 12]
    np.testing.assert_array_equal(result.material.coefficients[:, :, :12], kept)


@given(st.integers(1, 40), st.integers(1, 40))
@settings(max_examples=15, deadline=None)
def test_any_size_is_made(height: int, width: int) -> None:
    result = synthesize([rough(20)], (height, width), Synthesis(12, 3)).material
    assert result.shape == (height, width)
    assert np.isfinite(result.coefficients).all()


def test_a_seed_gives_the_same_coefficients_and_another_others() -> None:
    source = rough(48)
    one, again, other = (bits(synthesize([source], (60, 60), replace(SMALL, seed=seed)).material) for seed in (3, 3, 4))
    np.testing.assert_array_equal(one, again)
    assert (one != other).mean() > 0.5


@pytest.mark.parametrize("join", ["cut", "blend"])
@pytest.mark.parametrize("size", [(64, 96), (71, 53)], ids=str)
def test_a_tile_shows_no_seam(join: Join, size: tuple[int, int]) -> None:
    """Held against a synthesis that does not care about its ends, whose seam is plain."""
    source = rough(96, seed=2)
    tile = synthesize([source], size, replace(SMALL, join=join, tileable=True)).material
    plain = synthesize([source], size, replace(SMALL, join=join)).material
    assert max(wrap_percentiles(lit(tile))) <= 95
    assert max(wrap_percentiles(lit(plain))) > 95


def test_every_column_of_a_tile_is_an_ordinary_one() -> None:
    """Also where its blocks meet round the ends, wherever it is made to begin."""
    source = rough(96, seed=3)
    tile = lit(synthesize([source], (72, 72), replace(SMALL, tileable=True)).material)
    steps = np.abs(tile - np.roll(tile, 1, axis=2)).mean(axis=(0, 1))
    ordinary = np.abs(np.diff(lit(source), axis=2)).mean()
    assert steps.max() < 1.8 * ordinary


@pytest.mark.parametrize("colour", ["lrgb", "rgb"])
def test_statistics_under_eight_lights_follow_the_source(colour: Colour) -> None:
    source = rough(128, colour, seed=1)
    brightness, contrast = statistics_off(synthesize([source], (192, 192), Synthesis(24, 5)).material, [source])
    assert brightness < 0.05
    assert contrast < 0.05


def test_copying_is_avoided_and_counted_where_it_is_allowed() -> None:
    source = rough(64)
    avoided, allowed = (
        measure(synthesize([source], (96, 96), replace(SMALL, copies=copies, delta=0.0)), [source], 16)
        for copies in ("avoid", "allow")
    )
    assert avoided.copied == 0
    assert avoided.largest_copy_px <= 16 * 16
    assert allowed.copied > 0.5


def test_the_pieces_of_a_result_add_up() -> None:
    result = synthesize([rough(48)], (50, 50), SMALL)
    assert copy_sizes(result.canvas, (50, 50)).sum() == 50 * 50


def test_several_sources_are_mixed() -> None:
    sources = [rough(48, seed=0), rough(40, seed=5)]
    result = synthesize(sources, (80, 80), SMALL)
    index, rows, columns = (part[:80, :80] for part in result.canvas.origins())
    assert 0.1 < index.mean() < 0.9
    for number, source in enumerate(sources):
        mine = index == number
        np.testing.assert_array_equal(
            result.material.coefficients[:, mine], source.coefficients[:, rows[mine], columns[mine]]
        )


def test_a_guidance_map_says_what_goes_where() -> None:
    sources = [flat(32, 0.2), flat(32, 0.8)]
    target = np.zeros((64, 64), np.float32)
    target[:, 32:] = 1
    guidance = Guidance(target, brightness_ranks(sources, 16))
    material = synthesize(sources, (64, 64), SMALL, guidance=guidance).material
    assert material.coefficients[5, :, :20].max() == np.float32(0.2)
    assert material.coefficients[5, :, 44:].min() == np.float32(0.8)
    reverse = Guidance(1 - target, guidance.sources)
    assert synthesize(sources, (64, 64), SMALL, guidance=reverse).material.coefficients[5, 5, 5, 0] == np.float32(0.8)


@pytest.mark.parametrize("basis", [Basis("ptm", 3), Basis("hsh", 4), Basis("hsh", 9)], ids=str)
def test_other_bases_are_synthesised_too(basis: Basis) -> None:
    material = synthesize([rough(40, "rgb", basis=basis)], (48, 48), SMALL).material
    assert material.basis == basis
    assert np.unique(material.coefficients[1]).size > 100


def test_comparing_over_the_disc_changes_what_is_chosen() -> None:
    source = rough(64)
    square, disc = (synthesize([source], (64, 64), replace(SMALL, domain=over)) for over in ("square", "disc"))
    assert square.canvas.taken != disc.canvas.taken


def test_a_distance_of_textures_is_that_of_their_functions() -> None:
    source = rough(24, "rgb")
    textures = synthesize([source], (8, 8), SMALL).textures
    change = orthonormal(source.basis, "square")
    vectors = np.einsum("st,tyxc->yxcs", change.matrix, source.coefficients.astype(np.float64)).reshape(24, 24, -1)
    mine = np.square(textures.planes[0][3, 4, :18] - textures.planes[0][11, 7, :18]).sum()
    theirs = np.square(vectors[3, 4] - vectors[11, 7]).sum()
    assert mine / textures.distance_unit == pytest.approx(theirs / (4 * 3), rel=1e-4)


def test_colour_counts_as_far_as_it_is_given_weight() -> None:
    source = rough(48)
    grey = replace(source, colour=np.ones_like(source.colour))
    assert source.colour is not None
    ignored = synthesize([source], (64, 64), replace(SMALL, chroma=0.0)).canvas.taken
    assert ignored == synthesize([grey], (64, 64), replace(SMALL, chroma=0.0)).canvas.taken
    assert ignored != synthesize([source], (64, 64), replace(SMALL, chroma=3.0)).canvas.taken


@pytest.mark.parametrize("join", ["cut", "blend"])
def test_a_flat_source_gives_a_flat_result(join: Join) -> None:
    material = synthesize([flat(40)], (50, 50), replace(SMALL, join=join, tileable=True)).material
    np.testing.assert_allclose(material.coefficients[5], 0.5, atol=1e-6)
    np.testing.assert_allclose(material.coefficients[:5], 0, atol=1e-6)


def test_a_source_that_is_one_block_repeats() -> None:
    source = rough(16)
    material = synthesize([source], (40, 40), SMALL).material
    assert set(material.coefficients[5].ravel()) <= set(source.coefficients[5].ravel())


@pytest.mark.parametrize("scale", [2.0**-60, 2.0**50], ids=str)
def test_units_do_not_matter(scale: float) -> None:
    source = rough(40, "rgb")
    scaled = replace(source, coefficients=source.coefficients * np.float32(scale))
    settings = replace(SMALL, delta=0.0)
    taken = [synthesize([one], (48, 48), settings).canvas.taken for one in (source, scaled)]
    assert taken[0] == taken[1]


class TestRefusals:
    def test_a_source_smaller_than_a_block(self) -> None:
        with pytest.raises(InputError, match=r"x\.ptm: 15 × 15 pixels hold no block of 16; choose --block 15 or less"):
            synthesize([rough(15)], (40, 40), SMALL, names=["x.ptm"])

    @pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
    def test_coefficients_that_are_no_numbers(self, value: float) -> None:
        source = rough(20)
        source.coefficients[2, 3, 4] = value
        with pytest.raises(InputError, match=r"source 0: has coefficients that are not finite"):
            synthesize([source], (20, 20), SMALL)

    def test_colours_that_are_no_numbers(self) -> None:
        source = rough(20)
        assert source.colour is not None
        source.colour[1, 2] = np.nan
        with pytest.raises(InputError, match="not finite"):
            synthesize([source], (20, 20), SMALL)

    def test_sources_of_two_kinds(self) -> None:
        with pytest.raises(InputError, match="b: its colour is rgb where a has lrgb; fit both alike to mix them"):
            synthesize([rough(20), rough(20, "rgb")], (20, 20), SMALL, names=["a", "b"])

    def test_a_size_beyond_all_memory(self) -> None:
        with pytest.raises(InputError, match=r"1000000 × 1000000 pixels need .* GiB of memory and this machine has"):
            synthesize([rough(20)], (1_000_000, 1_000_000), SMALL)

    @pytest.mark.parametrize(("block_px", "overlap_px"), [(3, 1), (300, 6), (30, 0), (30, 16)])
    def test_blocks_that_cannot_be_laid(self, block_px: int, overlap_px: int) -> None:
        with pytest.raises(InputError, match="choose"):
            Synthesis(block_px, overlap_px)
