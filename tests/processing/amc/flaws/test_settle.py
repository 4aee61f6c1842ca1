"""Of the values near a mark, those that the rest of the turn contradicts are hidden, and no others."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import ndimage

from processing.amc.flaws.sample_frame import track
from processing.amc.flaws.settle import settle
from tests.processing.amc.flaws.flawed_sphere import Material, Place, clean, disc, line_cut, seen, seen_all, wedge

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

SIZE, NOISE = 48, 0.003
VALID = disc(SIZE)
DARTS = [wedge(angle, 0.25, 0.1) for angle in (0.4, 2.3, 4.6)]
OPPOSITE = [line_cut(angle, 0.0, 0.12, 0.2) for angle in (1.0, 1.0 + np.pi)]


def even(count: int) -> F64:
    return np.asarray(np.arange(count) * 2 * np.pi / count)


def shot(cuts: list[Place], count: int, repeats: int = 2) -> tuple[F32, F32]:
    """Slices with something black in their cuts, and how much of each texel that is, (N, S, S)."""
    light = clean(Material(repeats), SIZE, tuple(even(count)))
    cover = np.max([seen_all(cut, SIZE, even(count)) for cut in cuts], axis=0)
    noise = NOISE * np.random.default_rng(count).standard_normal(light.shape)
    return (light * (1 - cover[..., None]) + noise).astype(np.float32), cover


def settled(cuts: list[Place], count: int, wider_px: int, repeats: int = 2) -> tuple[Mask, F32]:
    slices, cover = shot(cuts, count, repeats)
    there = np.max([seen(cut, SIZE, 0) for cut in cuts], axis=0)
    marks = ndimage.binary_dilation(there > 0, iterations=wider_px) & VALID
    return settle(marks, marks & (there > 0.9), slices, even(count), VALID), cover


@pytest.mark.parametrize(
    ("cuts", "count", "repeats"),
    [
        pytest.param(DARTS, 40, 1, id="darts"),
        pytest.param(DARTS, 40, 2, id="darts in a material that repeats"),
        pytest.param(DARTS, 64, 2, id="more slices than are looked at first"),
        pytest.param(OPPOSITE, 48, 2, id="cuts half a turn apart, that agree with each other"),
    ],
)
def test_marks_settle_on_what_is_cut(cuts: list[Place], count: int, repeats: int) -> None:
    hidden, cover = settled(cuts, count, 2, repeats)
    assert hidden[:, VALID][cover[:, VALID] > 0.15].mean() > 0.98
    assert hidden[:, VALID][cover[:, VALID] == 0].mean() < 0.01


def test_where_marks_meet_about_the_axis_what_was_seen_is_released() -> None:
    slices, _ = shot(DARTS, 40)
    there = np.max([seen(cut, SIZE, 0) for cut in DARTS], axis=0)
    middle = disc(SIZE, 0.1)
    marks = ndimage.binary_dilation(there > 0, iterations=2) | middle
    hidden = settle(marks, there > 0.9, slices, even(40), VALID)
    assert track(marks, even(40))[:, middle].mean() == 1
    assert hidden[:, middle].mean() < 0.02


def test_marks_on_nothing_are_let_go() -> None:
    slices, _ = shot([lambda x, _: 0 * x], 40)
    marks = seen(DARTS[0], SIZE, 0) > 0
    assert settle(marks, marks, slices, even(40), VALID).sum() < 0.02 * 40 * marks.sum()


def test_without_marks_nothing_is_hidden() -> None:
    slices, _ = shot(DARTS, 40)
    assert not settle(np.zeros_like(VALID), np.zeros_like(VALID), slices, even(40), VALID).any()
