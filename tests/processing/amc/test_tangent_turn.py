"""Against the turn of a vector about the horizontal axis across the normal's azimuth, by hand."""

import numpy as np
import pytest
from numpy.typing import NDArray

from processing.amc.table import Series, even_angles, make_table, read_back
from processing.amc.tangent_turn import TangentTurn
from processing.room import Room

F64 = NDArray[np.float64]
AZIMUTHS = np.array([0.7, -2.0, 3.1, 0.0])
TILTS = np.array([0.9, 0.3, 1.2, 0.6])
TABLE_TILTS = np.array([0.8, 0.35, 1.1, 0.6])
SERIES = Series(even_angles(48), 23)


def turn_of(table_tilts: F64 = TABLE_TILTS) -> TangentTurn:
    return TangentTurn(np.cos(TILTS), np.cos(table_tilts), AZIMUTHS)


def light(tau: F64) -> F64:
    """What every texel shows while its tangent's picture has angle τ; (…, 4, 3)."""
    waves = np.stack([np.cos(tau), np.sin(2 * tau), 0.3 * np.cos(5 * tau - 1)], axis=-1)
    return np.asarray(np.broadcast_to(waves[..., None, :], (*tau.shape, 4, 3)))


def turned_angle(tau: float, texel: int, table_tilts: F64) -> float:
    azimuth, tilt = AZIMUTHS[texel], TILTS[texel]
    normal = np.array([np.sin(tilt) * np.cos(azimuth), np.sin(tilt) * np.sin(azimuth), np.cos(tilt)])
    axis = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    turn = table_tilts[texel] - tilt
    tangent = np.cross([-np.sin(tau), np.cos(tau), 0.0], normal)
    turned = (
        np.cos(turn) * tangent + np.sin(turn) * np.cross(axis, tangent) + (1 - np.cos(turn)) * axis * (axis @ tangent)
    )
    return float(np.arctan2(turned[1], turned[0]))


@pytest.mark.parametrize("table_tilts", [TABLE_TILTS, np.zeros(4)], ids=["perspective", "upright"])
def test_a_tangent_turns_with_its_normal(table_tilts: F64) -> None:
    turn = turn_of(table_tilts)
    slices = light(SERIES.angles_rad).astype(np.float32)
    for texel in range(4):
        for tau in np.linspace(0, 2 * np.pi, 7):
            read = SERIES.turned(slices, turn, np.array([turned_angle(tau, texel, table_tilts)]))
            assert read[0, texel] == pytest.approx(light(np.array(tau))[texel], abs=2e-4)


def test_the_upright_turn_is_that_on_to_z() -> None:
    assert np.all(turn_of().upright.turned_z == turn_of(np.zeros(4)).turned_z)


@pytest.mark.parametrize("table_tilts", [TABLE_TILTS, TILTS], ids=["turned", "kept"])
def test_what_repeats_at_half_a_turn_is_read_from_half_a_turn(table_tilts: F64) -> None:
    """The rest is left out, by a reading of half the samples as by leaving it out of a full one."""
    wanted = np.pi * np.arange(24) / 24
    slices = (light(SERIES.angles_rad) + 0.3 * np.cos(4 * SERIES.angles_rad - 1)[:, None, None]).astype(np.float32)
    whole = SERIES.turned(slices, turn_of(table_tilts), np.concatenate([wanted, wanted + np.pi]))
    halves = SERIES.turned(slices, turn_of(table_tilts), wanted, 2)
    assert halves == pytest.approx((whole[:24] + whole[24:]) / 2, abs=1e-4)
    assert np.ptp(halves[..., 1], axis=0).min() > 0.5


@pytest.mark.parametrize("repeats", [2, 3, 4])
def test_a_folded_table_holds_what_repeats(repeats: int) -> None:
    turn = TangentTurn(*(part.reshape(2, 2) for part in (turn_of().normal_z, turn_of().turned_z, AZIMUTHS)))
    slices = (light(SERIES.angles_rad) + 1.5).astype(np.float32)
    even = SERIES.turned(slices, turn.flat, even_angles(360))
    copies = [np.roll(even, 360 // repeats * copy, axis=0) for copy in range(repeats)]
    depth = 20
    table = make_table(Room(slices.reshape(48, 2, 2, 3).copy()), SERIES, turn, depth, repeats).reshape(depth, 4, 3)
    wanted = np.mean(copies, axis=0)[np.round(360 * np.arange(depth) / (repeats * depth)).astype(int)]
    steps = np.flatnonzero(360 * np.arange(depth) % (repeats * depth) == 0)
    assert table[steps] == pytest.approx(wanted[steps], abs=2e-3)


def test_a_normal_that_stays_keeps_its_slices() -> None:
    slices = light(SERIES.angles_rad).astype(np.float32)
    assert SERIES.turned(slices, turn_of(TILTS), SERIES.angles_rad) == pytest.approx(slices, abs=1e-5)


def test_a_table_is_read_back_as_the_slices_that_made_it() -> None:
    turn = turn_of()
    slices = light(SERIES.angles_rad).astype(np.float32) + 1.5
    square = TangentTurn(*(part.reshape(2, 2) for part in (turn.normal_z, turn.turned_z, turn.azimuth_rad)))
    table = make_table(Room(slices.reshape(48, 2, 2, 3).copy()), SERIES, square, 47, 1)
    assert read_back(table.reshape(47, 4, 3), turn, 1, SERIES.angles_rad) == pytest.approx(slices, abs=2e-3)


def test_a_table_of_no_more_slices_takes_their_place() -> None:
    slices = np.ones((48, 4, 4, 3), np.float32)
    turn = TangentTurn(np.ones((4, 4)), np.ones((4, 4)), np.zeros((4, 4)))
    assert np.shares_memory(make_table(Room(slices), SERIES, turn, 24, 2), slices)
    assert make_table(Room(slices), SERIES, turn, 60, 2).shape == (60, 4, 4, 3)
