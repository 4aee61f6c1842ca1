from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.pictures import read_linear
from litrig.base.radiometry import encode_srgb
from processing.ptm.basis import Basis
from processing.ptm.fit import FitSettings, fit, gathered, start_fit
from processing.ptm.model import Space
from processing.ptm.near_lights import NearLights, brighten
from processing.stack import Stack
from tests.processing.ptm.relief import dome

FIRST = Basis("ptm", 3)
HEIGHT, WIDTH, WIDTH_MM = 30, 40, 100.0


def near_positions(distance_mm: float) -> NDArray[np.float64]:
    """Lamps on a dome, but not all as far away."""
    return dome(16, 30) * distance_mm * np.linspace(0.9, 1.1, 16)[:, None]


def matt_board(folder: Path, positions_mm: NDArray[np.float64], space: Space) -> Stack:
    """16-bit pictures of a flat, evenly white, matt board under near lamps: light falls as cos/d²."""
    x = (np.arange(WIDTH) + 0.5 - WIDTH / 2) * WIDTH_MM / WIDTH
    y = (HEIGHT / 2 - np.arange(HEIGHT) - 0.5) * WIDTH_MM / WIDTH
    place = np.stack([*np.meshgrid(x, y), np.zeros((HEIGHT, WIDTH))], axis=-1)
    mean = np.linalg.norm(positions_mm, axis=1).mean()
    paths = []
    for index, position in enumerate(positions_mm):
        way = position - place
        distance = np.linalg.norm(way, axis=-1)
        light = 0.4 * way[..., 2] / distance * (mean / distance) ** 2
        values = encode_srgb(light) if space == "srgb" else light
        paths.append(folder / f"{index:02d}.png")
        assert values.max() < 1
        cv2.imwrite(str(paths[-1]), np.rint(np.repeat(values[..., None], 3, -1) * 65535).astype(np.uint16))
    return Stack(paths)


def test_directions_and_distances_are_those_of_each_pixel() -> None:
    near = NearLights(np.array([[0.0, 0.0, 50.0], [50.0, 0.0, 50.0]]), 100.0)
    right_edge = np.array([(HEIGHT // 2) * WIDTH + WIDTH - 1])
    directions, gains = near.at(right_edge, (HEIGHT, WIDTH))
    way = np.array([[-48.75, 1.25, 50.0], [1.25, 1.25, 50.0]])
    assert directions[:, 0] == pytest.approx(way / np.linalg.norm(way, axis=1, keepdims=True))
    mean = (50 + np.hypot(50, 50)) / 2
    assert gains[:, 0] == pytest.approx(np.sum(way**2, axis=1) / mean**2)


def test_a_matt_board_is_even_again(tmp_path: Path) -> None:
    """A quarter of the light is lost towards the corners; the near fit is flat, and hardly lit from the side."""
    positions = near_positions(150.0)
    stack = matt_board(tmp_path, positions, "srgb")
    near = NearLights(positions, WIDTH_MM)
    basis = Basis("hsh", 4)
    lit = np.array([0.3, -0.2, np.sqrt(1 - 0.13)])
    flat, far = (
        np.tensordot(basis.evaluate(lit), fit(stack, near.central_directions, basis=basis, near=way).coefficients, 1)
        for way in (near, None)
    )
    assert np.ptp(flat) < 0.15 * np.ptp(far)


def test_lights_far_away_are_as_good_as_distant(tmp_path: Path) -> None:
    positions = near_positions(1e7) / np.linspace(0.9, 1.1, 16)[:, None]
    stack = matt_board(tmp_path, positions, "srgb")
    near = NearLights(positions, WIDTH_MM)
    with_near = fit(stack, near.central_directions, colour="rgb", near=near)
    without = fit(stack, near.central_directions, colour="rgb")
    assert with_near.coefficients == pytest.approx(without.coefficients, abs=1e-3)


@pytest.mark.parametrize("space", ["srgb", "linear"])
def test_light_is_multiplied_and_not_its_code(space: Space) -> None:
    light = np.array([[[0.2, 0.1, 0.05]]], np.float32)
    values = encode_srgb(light) if space == "srgb" else light
    doubled = encode_srgb(light * 2) if space == "srgb" else light * 2
    assert brighten(values, np.full((1, 1, 1), 2.0, np.float32), space) == pytest.approx(doubled, abs=1e-5)


def test_brightened_beyond_white_is_not_cut_off() -> None:
    one = np.ones((1, 1, 3), np.float32)
    assert brighten(one, 2 * one[..., :1], "srgb").min() > 1.3


def test_unequal_lamps_are_made_equal(tmp_path: Path) -> None:
    """Lamps that are all as far away, some half as bright."""
    positions = dome(16, 30) * 1e7
    stack = matt_board(tmp_path, positions, "linear")
    lamps = np.where(np.arange(16) % 2, 1.0, 0.5)
    for path, lamp in zip(stack.paths, lamps, strict=True):
        light = read_linear(path) * lamp
        cv2.imwrite(str(path), np.rint(encode_srgb(light) * 65535).astype(np.uint16))
    settings = FitSettings(FIRST, "rgb", "linear", light_gains=np.repeat(1 / lamps[:, None], 3, axis=1))
    equal = gathered(start_fit(stack, dome(16, 30), settings))
    left = fit(stack, dome(16, 30), basis=FIRST, colour="rgb", space="linear")
    assert np.ptp(equal.coefficients, axis=(1, 2)).max() < 1e-3
    assert np.ptp(left.coefficients, axis=(1, 2)).max() < 1e-3
    assert equal.coefficients[:, 0, 0, 0] != pytest.approx(left.coefficients[:, 0, 0, 0], abs=0.01)


@pytest.mark.parametrize(
    ("positions", "width_mm", "reason"),
    [([[0.0, 0.0, 1.0]], 0.0, "no width"), ([[0.0, np.nan, 1.0]], 10.0, "not a number")],
)
def test_impossible_rigs_are_refused(positions: list[list[float]], width_mm: float, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        NearLights(np.array(positions), width_mm)
