"""An AMC in few pictures: the laws of the best approximation, and what the pictures mean."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.table_normals import TableNormal
from processing.amc.isotropic import isotropic_matcap
from processing.amc.low_rank import compress, error_curve
from processing.amc.model import Amc, TangentAngle
from tests.viewer.analytic import brushed_amc

MEAN = pytest.mark.parametrize("mean_first", [True, False], ids=["mean first", "plain"])


def some_amc(depth: int = 7, size: int = 5, seed: int = 0) -> Amc:
    random = np.random.default_rng(seed)
    slices = random.random((depth, size, size, 3), np.float32)
    valid = np.repeat((random.random((size, size)) > 0.3)[None], depth, axis=0)
    return Amc(slices, valid, 3, TableNormal.VIEW, (1.0, 2.5), "sha256:0a", TangentAngle.SURFACE)


def rank_two(depth: int = 12) -> tuple[Amc, NDArray[np.float32]]:
    """A grey picture that stays, and one that swings once a turn."""
    random = np.random.default_rng(4)
    still, swinging = random.random((2, 6, 6, 3)).astype(np.float32)
    swing = np.cos(2 * np.pi * np.arange(depth) / depth)
    slices = 2 * still + swing[:, None, None, None] * swinging
    return Amc(slices.astype(np.float32), np.ones(slices.shape[:3], bool), 1), still


def psnr_db(amc: Amc, back: Amc) -> float:
    valid = amc.valid.all(axis=0)
    truth = amc.slices[:, valid].astype(np.float64)
    return float(10 * np.log10(truth.max() ** 2 / np.mean((back.slices[:, valid] - truth) ** 2)))


@MEAN
@given(depth=st.integers(1, 9), size=st.integers(2, 6), seed=st.integers(0, 50))
def test_all_pictures_together_are_the_table(mean_first: bool, depth: int, size: int, seed: int) -> None:
    amc = some_amc(depth, size, seed)
    if amc.valid.any():
        back = compress(amc, depth, mean_first=mean_first).expand()
        np.testing.assert_allclose(back.slices, amc.slices, atol=2e-6)


@MEAN
def test_two_pictures_suffice_where_two_made_the_table(mean_first: bool) -> None:
    amc, _ = rank_two()
    np.testing.assert_allclose(compress(amc, 2, mean_first=mean_first).expand().slices, amc.slices, atol=2e-6)


def test_the_first_picture_is_the_isotropic_matcap_and_stays() -> None:
    amc = some_amc()
    low = compress(amc, 3)
    np.testing.assert_allclose(low.pictures[0], isotropic_matcap(amc), atol=1e-6)
    np.testing.assert_array_equal(low.curves[:, 0], 1)


def test_a_swing_comes_out_as_its_curve() -> None:
    amc, still = rank_two()
    low = compress(amc, 2)
    turns = np.arange(12) / 12
    np.testing.assert_allclose(low.curves[:, 1], np.sqrt(2) * np.cos(2 * np.pi * turns), atol=1e-5)
    np.testing.assert_allclose(low.pictures[0], 2 * still, atol=1e-6)


@MEAN
def test_curves_are_orthogonal_with_mean_square_one(mean_first: bool) -> None:
    curves = compress(some_amc(), 7, mean_first=mean_first).curves.astype(np.float64)
    np.testing.assert_allclose(curves.T @ curves / 7, np.eye(7), atol=1e-6)


@MEAN
def test_pictures_come_by_falling_energy_after_the_mean(mean_first: bool) -> None:
    amc = some_amc()
    low = compress(amc, 7, mean_first=mean_first)
    energies = np.sum(low.pictures[:, amc.valid[0]].astype(np.float64) ** 2, axis=(1, 2))
    assert np.all(np.diff(energies[1 if mean_first else 0 :]) <= 1e-6)


@MEAN
def test_the_error_is_known_beforehand(mean_first: bool) -> None:
    amc = brushed_amc(24, 20)
    ranks = [1, 2, 4, 7, 9]
    for error in error_curve(amc, ranks, mean_first=mean_first):
        low = compress(amc, error.rank, mean_first=mean_first)
        assert error.psnr_db == pytest.approx(psnr_db(amc, low.expand()), abs=0.01)
        assert error.stored_bytes == low.pictures.nbytes + low.curves.nbytes


def test_no_pictures_of_the_same_number_come_nearer() -> None:
    """The plain form meets Eckart and Young's bound; taking the mean out first costs little of it."""
    amc = brushed_amc(24, 20)
    valid = amc.valid[0]
    singular = np.linalg.svd(amc.slices[:, valid].reshape(20, -1).astype(np.float64), compute_uv=False)
    for rank in (2, 5, 8):
        best_db = 10 * np.log10(amc.slices[:, valid].max() ** 2 * 20 * valid.sum() * 3 / np.sum(singular[rank:] ** 2))
        ((_, _, plain_db),) = error_curve(amc, [rank], mean_first=False)
        ((_, _, mean_first_db),) = error_curve(amc, [rank])
        assert plain_db == pytest.approx(best_db, abs=1e-6)
        assert best_db - 0.1 < mean_first_db <= best_db + 1e-6


def test_where_nothing_is_lost_the_error_is_infinitely_small() -> None:
    amc, _ = rank_two()
    exact = Amc((np.rint(amc.slices * 64) / 64).astype(np.float32), amc.valid, 1)
    assert [error.psnr_db for error in error_curve(exact, [12])] == [np.inf]


@given(factor=st.sampled_from([0.25, 2.0, 64.0]))
def test_a_brighter_table_has_the_same_error(factor: float) -> None:
    amc = some_amc()
    brighter = Amc(amc.slices * np.float32(factor), amc.valid, 3)
    ((_, _, before),), ((_, _, after),) = error_curve(amc, [3]), error_curve(brighter, [3])
    assert after == pytest.approx(before, abs=1e-6)


def test_only_what_was_seen_decides() -> None:
    """Whatever stands where no slice saw anything, the curves are the same."""
    amc = some_amc()
    painted = amc.slices.copy()
    painted[:, ~amc.valid[0]] = np.random.default_rng(9).random((7, (~amc.valid[0]).sum(), 3)) * 50
    np.testing.assert_array_equal(compress(Amc(painted, amc.valid, 3), 3).curves, compress(amc, 3).curves)


def test_what_was_dilated_stays_dilated() -> None:
    """A texel past the disc that repeats one inside does so in every picture."""
    amc = some_amc()
    inside, outside = np.argwhere(amc.valid[0])[0], np.argwhere(~amc.valid[0])[0]
    amc.slices[:, *outside] = amc.slices[:, *inside]
    for table in (compress(amc, 3).pictures, compress(amc, 3).expand().slices):
        np.testing.assert_array_equal(table[:, *outside], table[:, *inside])


def test_a_texel_counts_where_every_slice_saw_it() -> None:
    amc = some_amc()
    valid = amc.valid.copy()
    row, column = np.argwhere(valid[0])[0]
    valid[4, row, column] = False
    low = compress(Amc(amc.slices, valid, 3), 2)
    assert not low.valid[row, column]
    assert low.valid.sum() == amc.valid[0].sum() - 1


def test_what_the_table_means_comes_along() -> None:
    amc = some_amc()
    back = compress(amc, 2).expand()
    assert (back.invariance, back.table_normal, back.tangent_angle) == (3, TableNormal.VIEW, TangentAngle.SURFACE)
    assert (back.slice_angles_deg, back.source) == ((1.0, 2.5), "sha256:0a")
    assert back.valid.shape == amc.valid.shape and back.slices.dtype == np.float32


@pytest.mark.parametrize("rank", [0, -1, 8])
def test_a_rank_that_cannot_be_is_refused(rank: int) -> None:
    for call in (lambda: compress(some_amc(), rank), lambda: error_curve(some_amc(), [1, rank])):
        with pytest.raises(InputError, match=f"a rank of {rank}; choose 1 to 7"):
            call()


def test_a_table_that_saw_nothing_is_refused() -> None:
    amc = some_amc()
    with pytest.raises(InputError, match="no texel is valid in every slice"):
        compress(Amc(amc.slices, np.zeros_like(amc.valid), 3), 1)


def test_colours_that_are_no_numbers_are_refused() -> None:
    amc = some_amc()
    row, column = np.argwhere(amc.valid[0])[0]
    amc.slices[2, row, column, 1] = np.nan
    with pytest.raises(InputError, match="no numbers"):
        compress(amc, 1)
