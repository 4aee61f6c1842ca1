"""A ball photographed once gives its lights to another session's frames."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from litrig.base.capture_folder.capture import CapturedFrame
from litrig.base.errors import InputError
from litrig.base.lights import Lights
from processing.ptm.lights.carry import carry, match_frames

BALL, COIN = Path("ball"), Path("coin")


def frames(
    folder: Path, names: Sequence[str], lights: Sequence[tuple[float, float, float]] | None = None
) -> list[CapturedFrame]:
    known = [None] * len(names) if lights is None else [np.array(light) for light in lights]
    return [CapturedFrame(folder / name, light=light) for name, light in zip(names, known, strict=True)]


def test_the_same_names_belong_together_whatever_their_ending_and_order() -> None:
    balls, coins = frames(BALL, ["a.png", "b.png", "c.png"]), frames(COIN, ["c.jpg", "a.jpg"])
    places, rule = match_frames(balls, coins, COIN, BALL)
    assert (places, rule) == ([2, 0], "by file name")


def test_the_same_commanded_light_belongs_together() -> None:
    balls = frames(BALL, ["0.jpg", "1.jpg"], [(0, 0.6, 0.8), (0.6, 0, 0.8)])
    coins = frames(COIN, ["7.jpg", "8.jpg", "9.jpg"], [(0.6, 0, 0.8), (0, 0.6, 0.8), (0.6, 0, 0.8)])
    places, rule = match_frames(balls, coins, COIN, BALL)
    assert (places, rule) == ([1, 0, 1], "by commanded light")


def test_else_the_order_counts() -> None:
    balls, coins = frames(BALL, ["a.png", "b.png"]), frames(COIN, ["1.png", "2.png"])
    assert match_frames(balls, coins, COIN, BALL) == ([0, 1], "by order")


def test_another_number_of_other_names_is_refused() -> None:
    balls, coins = frames(BALL, ["a.png", "b.png"]), frames(COIN, ["1.png", "2.png", "b.png"])
    with pytest.raises(InputError, match=r"coin: its 3 pictures .* the 2 pictures of the ball in ball; give each pair"):
        match_frames(balls, coins, COIN, BALL)


def test_directions_go_where_their_frame_goes_and_gaps_stay_gaps() -> None:
    balls, coins = frames(BALL, ["a.png", "b.png", "c.png"]), frames(COIN, ["c.jpg", "b.jpg", "a.jpg"])
    lights = Lights(("a.png", "c.png"), np.array([[0, 0, 1.0], [0.6, 0, 0.8]]))
    carried = carry(lights, balls, coins, [2, 1, 0])
    assert carried.names == ("c.jpg", "a.jpg")
    np.testing.assert_array_equal(carried.directions, [[0.6, 0, 0.8], [0, 0, 1]])
    with pytest.raises(InputError, match="coin: no ball picture"):
        carry(lights, balls, coins[1:2], [1])
