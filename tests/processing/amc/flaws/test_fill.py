"""Filled slices make the table that a whole sample would have made."""

import numpy as np
import pytest
from numpy.typing import NDArray

from processing.amc.flaws.fill import fill
from processing.amc.flaws.sample_frame import track
from tests.processing.amc.flaws.flawed_sphere import Material, clean, disc, line_cut, seen, wedge

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

SIZE = 64
VALID = disc(SIZE)
NOISE = 0.005
CUTS = (line_cut(0.4, 0.1, 0.075, 0.15), wedge(2.5, 0.32, 0.05), line_cut(4.4, -0.2, 0.075))
BLACK, FOLDED = "black", "tangent turned by 60 degrees"


def uneven(count: int) -> F64:
    jitter = np.random.default_rng(3).uniform(-0.1, 0.1, count)
    return np.asarray((np.arange(count) + jitter) * 2 * np.pi / count, np.float64)


def shot(material: Material, angles_rad: F64, noise: float = NOISE) -> F32:
    light = clean(material, SIZE, tuple(angles_rad))
    return (light + noise * np.random.default_rng(5).standard_normal(light.shape)).astype(np.float32)


def cover() -> F64:
    return np.asarray(np.max([seen(cut, SIZE, 0) for cut in CUTS], axis=0))


def damaged(slices: F32, material: Material, angles_rad: F64, marked: Mask, content: str) -> F32:
    within = 0 if content == BLACK else clean(material, SIZE, tuple(angles_rad + np.pi / 3))
    return np.where(marked[..., None], within, slices).astype(np.float32)


def table(slices: F32, angles_rad: F64, repeats: int) -> F32:
    """Even slices by least squares over all harmonics that the material may have."""
    orders = np.arange(repeats, (len(slices) - 1) // 2 + 1, repeats)

    def waves(at_rad: F64) -> F64:
        turns = orders * at_rad[:, None]
        return np.asarray(np.hstack([np.ones((len(at_rad), 1)), np.cos(turns), np.sin(turns)]))

    even_rad = np.arange(len(slices) // repeats) * 2 * np.pi / len(slices)
    return np.asarray(np.tensordot(waves(even_rad) @ np.linalg.pinv(waves(angles_rad)), slices, 1), np.float32)


def psnr_db(found: F32, truth: F32, where: Mask = VALID) -> float:
    return float(10 * np.log10(float(truth[:, where].max()) ** 2 / np.mean((found - truth)[:, where] ** 2)))


def test_the_cuts_cover_eight_per_cent() -> None:
    assert cover()[VALID].mean() == pytest.approx(0.08, abs=0.005)


@pytest.mark.parametrize("content", [BLACK, FOLDED])
@pytest.mark.parametrize("repeats", [1, 2])
@pytest.mark.parametrize("count", [32, 64])
def test_three_cuts_cost_less_than_a_decibel(count: int, repeats: int, content: str) -> None:
    """Every texel that a cut touches is marked, a sixth of all values: 0.75 dB are lost for want of shots alone."""
    material, angles_rad = Material(2), uneven(count)
    whole = shot(material, angles_rad)
    marked = track(cover() > 0, angles_rad - angles_rad[0])
    cut = damaged(whole, material, angles_rad, marked, content)
    truth = clean(material, SIZE, tuple(np.arange(count // repeats) * 2 * np.pi / count))
    before, hurt, mended = (
        psnr_db(table(one, angles_rad, repeats), truth) for one in (whole, cut, fill(cut, marked, angles_rad, VALID))
    )
    assert hurt < before - 10
    assert mended > before - 1


@pytest.mark.parametrize("repeats", [0, 1, 3, 4])
def test_other_materials_are_filled_to_a_few_times_the_noise(repeats: int) -> None:
    material, angles_rad = Material(repeats), uneven(48)
    whole, truth = shot(material, angles_rad), clean(material, SIZE, tuple(angles_rad))
    marked = track(cover() > 0, angles_rad - angles_rad[0])
    filled = fill(damaged(whole, material, angles_rad, marked, BLACK), marked, angles_rad, VALID)
    error = np.sqrt(np.mean((filled - truth)[marked & VALID] ** 2))
    assert error < 2 * NOISE


def test_what_is_not_marked_comes_back_bit_for_bit_and_the_input_stays() -> None:
    angles_rad = uneven(16)
    slices = shot(Material(), angles_rad)
    before = slices.copy()
    marked = track(cover() > 0, angles_rad - angles_rad[0])
    filled = fill(slices, marked, angles_rad, VALID)
    untouched = ~(marked & VALID)
    assert np.array_equal(filled[untouched], before[untouched])
    assert np.array_equal(slices, before)
    assert fill(slices, np.zeros_like(marked), angles_rad, VALID) is not slices


def test_what_lies_under_a_mark_does_not_matter() -> None:
    angles_rad = uneven(32)
    slices = shot(Material(), angles_rad)
    marked = track(cover() > 0, angles_rad - angles_rad[0])
    first, second = (
        fill(np.where(marked[..., None], value, slices).astype(np.float32), marked, angles_rad, VALID)
        for value in (0.0, 50.0)
    )
    assert np.abs(first - second)[marked & VALID].max() < 0.02


@pytest.mark.parametrize("size", [1, 2, 4])
def test_a_hot_pixel_is_filled_from_its_neighbours(size: int) -> None:
    material, angles_rad = Material(), uneven(32)
    slices, truth = shot(material, angles_rad, 0.001), clean(material, SIZE, tuple(angles_rad))
    marked = np.zeros(slices.shape[:3], bool)
    marked[:, 20 : 20 + size, 30 : 30 + size] = True
    slices[marked] = 5
    filled = fill(slices, marked, angles_rad, VALID)
    assert np.sqrt(np.mean((filled - truth)[marked] ** 2)) < 0.004 * size
    assert np.all((filled[marked] > 0) & (filled[marked] < truth.max()))


def test_a_place_that_is_hidden_for_the_whole_turn_is_filled_smoothly() -> None:
    """A button on the turntable's axis: seven texels across, in every slice."""
    material, angles_rad = Material(), uneven(24)
    slices, truth = shot(material, angles_rad, 0.001), clean(material, SIZE, tuple(angles_rad))
    button = disc(SIZE, 0.11)
    marked = np.broadcast_to(button, slices.shape[:3]).copy()
    slices[marked] = 0
    assert psnr_db(fill(slices, marked, angles_rad, VALID), truth, button) > 27


def test_a_copy_half_a_turn_away_is_used_without_being_told() -> None:
    """A dart hides over a quarter of the turn; a material that repeats showed the same half a turn before."""
    angles_rad = np.arange(32) * 2 * np.pi / 32
    marked = track(seen(wedge(1.0, 1.5, 0.0), SIZE, 0) > 0, angles_rad)
    error = {}
    for repeats in (1, 2):
        material = Material(repeats)
        filled = fill(shot(material, angles_rad), marked, angles_rad, VALID)
        error[repeats] = float(np.std((filled - clean(material, SIZE, tuple(angles_rad)))[marked & VALID]))
    assert error[2] < 0.5 * error[1]


def test_nothing_left_to_see_is_left_as_it_is() -> None:
    slices = shot(Material(), uneven(8))
    everything = np.ones(slices.shape[:3], bool)
    assert np.array_equal(fill(slices, everything, uneven(8), VALID), slices)
