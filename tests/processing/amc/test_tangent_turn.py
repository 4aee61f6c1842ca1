"""Against the turn of a vector about the horizontal axis across the normal's azimuth, by hand."""

import numpy as np
import pytest
from numpy.typing import NDArray

from processing.amc.table import Series, even_angles, make_table, read_back
from processing.amc.tangent_turn import TangentTurn

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


def test_a_normal_that_stays_keeps_its_slices() -> None:
    slices = light(SERIES.angles_rad).astype(np.float32)
    assert SERIES.turned(slices, turn_of(TILTS), SERIES.angles_rad) == pytest.approx(slices, abs=1e-5)


def test_a_table_is_read_back_as_the_slices_that_made_it() -> None:
    turn = turn_of()
    slices = light(SERIES.angles_rad).astype(np.float32) + 1.5
    square = TangentTurn(*(part.reshape(2, 2) for part in (turn.normal_z, turn.turned_z, turn.azimuth_rad)))
    table = make_table(slices.reshape(48, 2, 2, 3).copy(), np.ones((2, 2), bool), SERIES, square, 47, 1)
    assert read_back(table.reshape(47, 4, 3), turn, 1, SERIES.angles_rad) == pytest.approx(slices, abs=2e-3)


def test_a_table_of_no_more_slices_takes_their_place() -> None:
    slices = np.ones((48, 4, 4, 3), np.float32)
    turn = TangentTurn(np.ones((4, 4)), np.ones((4, 4)), np.zeros((4, 4)))
    valid = np.ones((4, 4), bool)
    assert np.shares_memory(make_table(slices, valid, SERIES, turn, 24, 2), slices)
    assert make_table(slices, valid, SERIES, turn, 60, 2).shape == (60, 4, 4, 3)
