import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.amc.harmonics import check_angles, fit_harmonics, fitting, folding, reading, unfolding

RANDOM = np.random.default_rng(5)


def series(count: int, texels: tuple[int, ...] = (2, 2, 3)) -> NDArray[np.complex128]:
    """Random harmonics (count + 1, *texels) that fall off."""
    parts = RANDOM.standard_normal((2, count + 1, *texels)) / (1 + np.arange(count + 1))[:, None, None, None]
    harmonics: NDArray[np.complex128] = parts[0] + 1j * parts[1]
    harmonics[0] = harmonics[0].real
    return harmonics


def read(harmonics: NDArray[np.complexfloating], angle_rad: float) -> NDArray[np.float64]:
    return np.asarray(np.einsum("m,m...->...", np.exp(1j * angle_rad * np.arange(len(harmonics))), harmonics).real)


@pytest.mark.parametrize("count", [8, 9, 24, 128])
def test_even_angles_carry_all_their_harmonics(count: int) -> None:
    assert check_angles(0.3 + 2 * np.pi * np.arange(count) / count, "x") == (count - 1) // 2


@pytest.mark.parametrize("jitter", [0.01, 0.1, 0.2])
def test_angles_that_a_turntable_missed_by_little_carry_all(jitter: float) -> None:
    """Whether the quick bound tells so, as for the first, or only the eigenvalues do."""
    missed = jitter * np.random.default_rng(3).uniform(-1, 1, 64)
    assert check_angles(2 * np.pi * (np.arange(64) + missed) / 64, "x") == 31


@given(st.integers(0, 2**32 - 1))
def test_slices_at_uneven_angles_give_the_series_that_made_them(seed: int) -> None:
    angles = 2 * np.pi * (np.arange(16) + 0.7 * np.random.default_rng(seed).uniform(-0.5, 0.5, 16)) / 16
    highest = check_angles(angles, "x")
    truth = series(highest)
    slices = np.stack([read(truth, angle) for angle in angles]).astype(np.float32)
    assert fit_harmonics(slices, angles, highest) == pytest.approx(truth, abs=2e-5)


def even(count: int) -> NDArray[np.float64]:
    return 2 * np.pi * np.arange(count) / count


@given(st.integers(0, 2**32 - 1))
def test_a_series_is_read_at_any_angle(seed: int) -> None:
    random = np.random.default_rng(seed)
    angles = 2 * np.pi * (np.arange(16) + 0.7 * random.uniform(-0.5, 0.5, 16)) / 16
    highest = check_angles(angles, "x")
    truth, wanted = series(highest), random.uniform(-9, 9, 5)
    slices = np.stack([read(truth, angle).ravel() for angle in angles])
    expected = np.stack([read(truth, angle).ravel() for angle in wanted])
    assert reading(fitting(angles, highest), wanted) @ slices == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize("count", [11, 40, 131])
@pytest.mark.parametrize(("depth", "repeats"), [(1, 1), (7, 1), (8, 1), (5, 2), (11, 3), (43, 3)])
def test_an_even_slice_is_the_mean_of_the_copies_it_replaces(depth: int, repeats: int, count: int) -> None:
    truth = series(min(5, (depth - 1) // 2 * repeats))
    slices = folding(count, depth, repeats) @ np.stack([read(truth, angle).ravel() for angle in even(count)])
    for place in range(depth):
        copies = [read(truth, 2 * np.pi * (place / depth + copy) / repeats).ravel() for copy in range(repeats)]
        assert slices[place] == pytest.approx(np.mean(copies, axis=0), abs=1e-5)


@pytest.mark.parametrize("repeats", [1, 2, 3])
def test_stored_slices_are_read_at_any_angle(repeats: int) -> None:
    """Folding and unfolding keep what repeats R times a turn."""
    truth = series(12)
    truth[np.arange(13) % repeats != 0] = 0
    stored = folding(40, 13 if repeats > 1 else 27, repeats) @ np.stack([read(truth, a).ravel() for a in even(40)])
    wanted = np.array([-0.3, 0.0, 1.0, 4.4])
    expected = np.stack([read(truth, angle).ravel() for angle in wanted])
    assert unfolding(wanted, len(stored), repeats) @ stored == pytest.approx(expected, abs=1e-4)


def test_noise_is_neither_smoothed_nor_raised_by_a_shift() -> None:
    """Linear interpolation between slices would lower it by up to a third."""
    noise = RANDOM.standard_normal((128, 120)).astype(np.float32)
    shifted = reading(fitting(even(128) + np.pi / 128, 63), even(127)) @ noise
    assert shifted.std() == pytest.approx(noise.std(), rel=0.02)


def test_averaging_two_copies_lowers_noise_by_the_root_of_two() -> None:
    noise = RANDOM.standard_normal((127, 120)).astype(np.float32)
    folded = folding(127, 63, 2) @ noise
    assert folded.std() == pytest.approx(noise.std() / np.sqrt(2), rel=0.03)


@pytest.mark.parametrize(
    ("angles_deg", "reason"),
    [
        pytest.param(np.arange(7) * 360 / 7, "7 turntable angles.*at least 8", id="too few"),
        pytest.param(np.repeat(np.arange(4) * 90, 5), "4 turntable angles", id="the same four again and again"),
        pytest.param(np.arange(32) * 5.0, r"between 155\.0 and 360\.0 deg", id="half a turn"),
        pytest.param(
            np.delete(np.arange(32) * 11.25, [5, 6, 7]), r"between 45\.0 and 90\.0 deg", id="three are missing"
        ),
    ],
)
def test_angles_that_cannot_carry_a_table_are_refused(angles_deg: NDArray[np.float64], reason: str) -> None:
    with pytest.raises(InputError, match=f"cloth: .*{reason}"):
        check_angles(np.radians(angles_deg), "cloth")


def test_one_missing_frame_costs_harmonics_and_no_more() -> None:
    assert 8 <= check_angles(np.radians(np.delete(np.arange(32) * 11.25, 5)), "x") < 15
