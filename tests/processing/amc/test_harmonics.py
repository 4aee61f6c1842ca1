import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.amc.harmonics import check_angles, even_slices, fit_harmonics, warp_harmonics

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


@given(st.integers(0, 2**32 - 1))
def test_slices_at_uneven_angles_give_the_series_that_made_them(seed: int) -> None:
    angles = 2 * np.pi * (np.arange(16) + 0.7 * np.random.default_rng(seed).uniform(-0.5, 0.5, 16)) / 16
    highest = check_angles(angles, "x")
    truth = series(highest)
    slices = np.stack([read(truth, angle) for angle in angles]).astype(np.float32)
    assert fit_harmonics(slices, angles, highest) == pytest.approx(truth, abs=2e-5)


@pytest.mark.parametrize(
    ("depth", "repeats"), [(1, 1), (7, 1), (8, 1), (5, 2), (11, 3), (43, 3)], ids=lambda value: str(value)
)
def test_an_even_slice_is_the_mean_of_the_copies_it_replaces(depth: int, repeats: int) -> None:
    truth = series(min(5, (depth - 1) // 2 * repeats))
    slices = even_slices(truth.astype(np.complex64), depth, repeats)
    for place in range(depth):
        copies = [read(truth, 2 * np.pi * (place / depth + copy) / repeats) for copy in range(repeats)]
        assert slices[place] == pytest.approx(np.mean(copies, axis=0), abs=1e-5)


def test_noise_is_neither_smoothed_nor_raised_by_a_shift() -> None:
    """Linear interpolation between slices would lower it by up to a third."""
    noise = RANDOM.standard_normal((128, 40, 3)).astype(np.float32)
    angles = 2 * np.pi * (np.arange(128) + 0.5) / 128
    shifted = even_slices(fit_harmonics(noise, angles, 63), 127, 1)
    assert shifted.std() == pytest.approx(noise.std(), rel=0.02)


def test_averaging_two_copies_lowers_noise_by_the_root_of_two() -> None:
    noise = RANDOM.standard_normal((128, 40, 3)).astype(np.float32)
    folded = even_slices(fit_harmonics(noise, 2 * np.pi * np.arange(128) / 128, 63), 63, 2)
    assert folded.std() == pytest.approx(noise.std() / np.sqrt(2), rel=0.03)


def test_a_normal_that_stays_keeps_its_series() -> None:
    truth = series(9).astype(np.complex64)
    same = np.full((2, 2), 0.4)
    assert warp_harmonics(truth, same, same, np.full((2, 2), 1.2)) == pytest.approx(truth, abs=1e-5)


def test_a_tangent_turns_with_its_normal() -> None:
    """Against the turn of a vector about the horizontal axis across the normal's azimuth, by hand."""
    azimuth, tilt, table_tilt = 0.7, 0.9, 0.8
    truth = series(2, (1, 1, 3)).astype(np.complex64)
    harmonics = np.zeros((20, 1, 1, 3), np.complex64)
    harmonics[:3] = truth
    full = np.ones((1, 1))
    warped = warp_harmonics(harmonics, np.cos(tilt) * full, np.cos(table_tilt) * full, azimuth * full)
    normal = np.array([np.sin(tilt) * np.cos(azimuth), np.sin(tilt) * np.sin(azimuth), np.cos(tilt)])
    axis = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    turn = table_tilt - tilt
    for tau in np.linspace(0, 2 * np.pi, 7):
        tangent = np.cross([-np.sin(tau), np.cos(tau), 0.0], normal)
        turned = (
            np.cos(turn) * tangent
            + np.sin(turn) * np.cross(axis, tangent)
            + (1 - np.cos(turn)) * axis * (axis @ tangent)
        )
        assert read(warped, np.arctan2(turned[1], turned[0])) == pytest.approx(read(truth, tau), abs=2e-4)


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
