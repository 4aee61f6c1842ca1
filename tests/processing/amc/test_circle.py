from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.amc.circle import Circle, find_circle
from processing.stack import Stack
from tests.processing.amc.brushed_sphere import Scene

ANGLES_DEG = np.linspace(0, 315, 8)


def shoot(scene: Scene, folder: Path, ending: str = ".png") -> Stack:
    return Stack(sorted(scene.shoot(folder, ANGLES_DEG, ending).glob(f"*{ending}")))


@pytest.mark.parametrize(
    ("scene", "ending"),
    [
        pytest.param(Scene(), ".png", id="grey behind"),
        pytest.param(Scene(background="black", noise=0.01), ".jpg", id="dark rim before black"),
        pytest.param(Scene(background="white"), ".png", id="white behind"),
        pytest.param(Scene(background="clutter", noise=0.01), ".jpg", id="clutter behind"),
        pytest.param(Scene(kind="isotropic", background="clutter"), ".png", id="nothing but noise changes"),
        pytest.param(
            Scene(background="black", lights=1, ambient=0, noise=0.003), ".png", id="half the rim in the dark"
        ),
        pytest.param(Scene(kind="1"), ".png", id="highlights fade before the rim"),
        pytest.param(Scene(distance_radii=4.0), ".png", id="from four radii"),
        pytest.param(Scene(circle=(61.7, 95.2, 41.3)), ".png", id="small and off the centre"),
        pytest.param(Scene(circle=(910.3, 230.8, 190.9), shape=(460, 1700), samples=1), ".jpg", id="a large picture"),
    ],
)
def test_the_silhouette_is_found_to_three_tenths_of_a_pixel(scene: Scene, ending: str, tmp_path: Path) -> None:
    found = find_circle(shoot(scene, tmp_path, ending))
    assert (found.x_px, found.y_px, found.radius_px) == pytest.approx(scene.circle, abs=0.3)


def checkers() -> NDArray[np.int64]:
    rows, columns = np.indices((120, 160))
    return 80 + 90 * ((rows // 13 + columns // 17) % 2)


@pytest.mark.parametrize("behind", [np.full((120, 160), 90), checkers()], ids=["noise alone", "checkers"])
def test_a_picture_without_a_sphere_says_what_to_do(behind: NDArray[np.int64], tmp_path: Path) -> None:
    random = np.random.default_rng(1)
    for index in range(8):
        codes = (behind[..., None] + random.integers(-8, 8, (120, 160, 3))).astype(np.uint8)
        cv2.imwrite(str(tmp_path / f"{index}.png"), codes)
    with pytest.raises(InputError, match=r"no round outline.*--circle X Y R"):
        find_circle(Stack(sorted(tmp_path.glob("*.png"))))


@pytest.mark.parametrize(
    "circle",
    [
        pytest.param(Circle(30, 50, 31.5), id="left"),
        pytest.param(Circle(75, 50, 31.5), id="right"),
        pytest.param(Circle(50, 25, 31.5), id="top"),
        pytest.param(Circle(50, 55, 31.5), id="bottom"),
        pytest.param(Circle(50, 50, 80), id="all around"),
        pytest.param(Circle(float("nan"), 50, 10), id="nowhere"),
    ],
)
def test_a_sphere_cut_by_the_border_is_refused(circle: Circle) -> None:
    with pytest.raises(InputError, match=r"shots: .*cut by the border"):
        circle.inside((80, 100), "shots")


@pytest.mark.parametrize("radius_px", [0, -5, 0.01, 3.9])
def test_a_circle_too_small_for_a_table_is_refused(radius_px: float) -> None:
    with pytest.raises(InputError, match=f"radius {radius_px} px.*4 or more"):
        Circle(50, 50, radius_px).inside((100, 100), "shots")


def test_an_absurd_circle_is_refused_in_a_few_words() -> None:
    with pytest.raises(InputError, match=r"radius 1e\+300 px") as caught:
        Circle(50, 50, 1e300).inside((100, 100), "shots")
    assert len(str(caught.value)) < 300


def test_a_sphere_that_is_all_seen_is_kept() -> None:
    circle = Circle(50, 40, 39.9)
    assert circle.inside((80, 100), "shots") is circle
