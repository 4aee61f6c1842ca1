"""Balls are found among what else lies on a table, and nothing else is taken for one."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.pictures import write_codes
from litrig.base.progress import silent
from litrig.base.radiometry import encode_srgb, to_u8
from processing.outline.circle import Circle
from processing.ptm.lights.survey import find_balls
from processing.stack import Stack
from tests.processing.ptm.lights.mirror_balls import Balls, lamps
from tests.processing.ptm.relief import relief_pictures

LIGHTS = lamps(6)


def stack(folder: Path, pictures: list[NDArray[np.floating]]) -> Stack:
    """Write display values as PNG files."""
    for index, picture in enumerate(pictures):
        write_codes(folder / f"{index:02d}.png", to_u8(picture))
    return Stack(sorted(folder.glob("*.png")))


def shots(scene: Balls) -> list[NDArray[np.floating]]:
    return [encode_srgb(scene.picture(light, index)) for index, light in enumerate(LIGHTS)]


def as_tuple(circle: Circle) -> tuple[float, float, float]:
    return circle.x_px, circle.y_px, circle.radius_px


@pytest.mark.parametrize(
    "scene",
    [
        pytest.param(Balls(), id="on a grey table"),
        pytest.param(Balls(background="black"), id="on velvet"),
        pytest.param(Balls(background="cloth", noise=0.003), id="on dark cloth, with noise"),
        pytest.param(Balls(distance_radii=6.0), id="near the camera"),
        pytest.param(Balls(dark=(2,)), id="in shadow once"),
        pytest.param(Balls(balls=((40.3, 38.8, 21.6), (120, 88, 25))), id="two"),
    ],
)
def test_balls_are_found(scene: Balls, tmp_path: Path) -> None:
    found = sorted(as_tuple(circle) for circle in find_balls(stack(tmp_path, shots(scene)), None, silent))
    assert len(found) == len(scene.balls)
    for circle, truth in zip(found, sorted(scene.outlines()), strict=True):
        assert circle == pytest.approx(truth, abs=0.3)


def test_a_ball_is_found_beside_a_carved_stone(tmp_path: Path) -> None:
    scene = Balls(shape=(160, 90), balls=((44.2, 110.7, 26.3),))
    stones = relief_pictures(LIGHTS, 160)
    pictures = [np.hstack(pair) for pair in zip(stones, shots(scene), strict=True)]
    (found,) = find_balls(stack(tmp_path, pictures), None, silent)
    assert as_tuple(found) == pytest.approx((204.2, 110.7, 26.3), abs=0.3)


def test_a_ball_cut_out_to_its_rim_is_found(tmp_path: Path) -> None:
    scene = Balls(shape=(84, 84), balls=((42, 42, 41.6),))
    rows, columns = np.indices((84, 84)) + 0.5
    disc = (np.hypot(rows - 42, columns - 42) < 41.6)[..., None]
    (found,) = find_balls(stack(tmp_path, [picture * disc for picture in shots(scene)]), None, silent)
    assert as_tuple(found) == pytest.approx((42, 42, 41.6), abs=0.3)


def test_a_stone_alone_holds_no_ball(tmp_path: Path) -> None:
    pictures: list[NDArray[np.floating]] = list(relief_pictures(LIGHTS, 120))
    with pytest.raises(InputError, match=r"no mirror ball found.*--ball X Y R"):
        find_balls(stack(tmp_path, pictures), None, silent)


def test_a_matt_ball_is_none(tmp_path: Path) -> None:
    rows, columns = np.indices((120, 160)) + 0.5
    x, y = (columns - 80) / 42, (60 - rows) / 42
    inside = x**2 + y**2 < 1
    normals = np.stack([x, y, np.sqrt(np.maximum(1 - x**2 - y**2, 0))], axis=-1)
    pictures = [
        encode_srgb(np.where(inside, 0.6 * np.maximum(normals @ light, 0) + 0.02, 0.5)[..., None].repeat(3, -1))
        for light in LIGHTS
    ]
    with pytest.raises(InputError, match=r"no small highlight moves in it"):
        find_balls(stack(tmp_path, list(pictures)), None, silent)


def test_darkness_holds_no_ball(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no round outline"):
        find_balls(stack(tmp_path, [np.zeros((60, 80, 3))] * 4), None, silent)
