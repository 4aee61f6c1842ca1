"""Marks turn with the sample, counter-clockwise, and no texel that one touches is forgotten."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing.amc.flaws.sample_frame import track, turn, turn_mask
from tests.processing.amc.flaws.flawed_sphere import disc, seen, wedge

SIZE = 40
DART = wedge(0.7, 0.5, 0.2)


@pytest.mark.parametrize("turn_rad", [0.0, 0.9, -2.5, np.pi / 2])
def test_a_turned_picture_is_the_picture_of_the_turned_sample(turn_rad: float) -> None:
    turned = turn(seen(DART, SIZE, 0).astype(np.float32), turn_rad)
    assert np.abs(turned - seen(DART, SIZE, turn_rad))[disc(SIZE)].mean() < 0.01


def test_a_quarter_turn_takes_the_right_to_the_top() -> None:
    mask = np.zeros((5, 5), bool)
    mask[2, 4] = True
    assert turn_mask(mask, np.pi / 2)[0, 2]
    assert not turn_mask(mask, np.pi / 2)[4, 2]


@given(
    row=st.integers(6, SIZE - 7),
    column=st.integers(6, SIZE - 7),
    turn_rad=st.floats(-7, 7),
    within=st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5)),
)
def test_no_place_of_a_mark_escapes(row: int, column: int, turn_rad: float, within: tuple[float, float]) -> None:
    mask = np.zeros((SIZE, SIZE), bool)
    mask[row, column] = True
    x, y = column + within[0] - (SIZE - 1) / 2, (SIZE - 1) / 2 - row - within[1]
    turned_x, turned_y = np.cos(turn_rad) * x - np.sin(turn_rad) * y, np.sin(turn_rad) * x + np.cos(turn_rad) * y
    there = round((SIZE - 1) / 2 - turned_y), round(turned_x + (SIZE - 1) / 2)
    if all(0 <= index < SIZE for index in there):
        assert turn_mask(mask, turn_rad)[there]


def test_marks_grow_by_a_texel_at_most() -> None:
    mask = np.zeros((SIZE, SIZE), bool)
    mask[10:14, 20:30] = True
    assert all(mask.sum() <= marked.sum() <= 6 * 12 * 1.2 for marked in track(mask, np.linspace(0, 6, 9)))


def test_in_the_samples_frame_marks_stand_still() -> None:
    turns_rad = np.sort(np.random.default_rng(1).uniform(0, 6, 24))
    at_rest = [turn(seen(DART, SIZE, angle).astype(np.float32), -angle) for angle in map(float, turns_rad)]
    assert np.abs(np.mean(at_rest, axis=0) - seen(DART, SIZE, 0))[disc(SIZE)].mean() < 0.01
