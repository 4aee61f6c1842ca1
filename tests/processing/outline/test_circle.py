from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.outline.circle import Circle, find_circle
from processing.stack import Stack
from tests.processing.amc.brushed_sphere import Scene

ANGLES_DEG = np.linspace(0, 315, 8)


def small(**changes: Any) -> Scene:
    return Scene(**{"circle": (63.3, 57.8, 45.4), "shape": (116, 128)} | changes)


def shoot(scene: Scene, folder: Path, ending: str = ".png") -> Stack:
    return Stack(sorted(scene.shoot(folder, ANGLES_DEG, ending).glob(f"*{ending}")))


@pytest.mark.parametrize(
    ("scene", "ending"),
    [
        pytest.param(Scene(), ".png", id="grey behind"),
        pytest.param(Scene(background="black", noise=0.01), ".jpg", id="dark rim before black"),
        pytest.param(small(background="white"), ".png", id="white behind"),
        pytest.param(small(background="clutter", noise=0.01), ".jpg", id="clutter behind"),
        pytest.param(small(kind="isotropic", background="clutter"), ".png", id="nothing but noise changes"),
        pytest.param(
            Scene(background="black", lights=1, ambient=0, noise=0.003), ".png", id="half the rim in the dark"
        ),
        pytest.param(small(kind="1"), ".png", id="highlights fade before the rim"),
        pytest.param(small(distance_radii=4.0), ".png", id="from four radii"),
        pytest.param(Scene(circle=(61.7, 95.2, 41.3)), ".png", id="small and off the centre"),
        pytest.param(small(background="limb", kind="1"), ".png", id="behind it all is as bright as the rim once is"),
        pytest.param(Scene(background="clutter", dirt=0.2), ".jpg", id="dirty before clutter"),
        pytest.param(small(background="gradient", seams=3), ".png", id="cuts in the cover"),
        pytest.param(small(background="white", blur_px=1.4), ".png", id="out of focus"),
        pytest.param(small(kind="4", background="white", gain=40, noise=0.1), ".exr", id="far brighter than white"),
        pytest.param(
            Scene(circle=(47.1, 46.3, 36.9), shape=(96, 96), background="gradient", noise=0.03),
            ".png",
            id="small, noisy",
        ),
        pytest.param(small(plate="all over"), ".png", id="half a sphere on a printed board that turns along"),
        pytest.param(Scene(plate="round", circle=(95.3, 88.8, 50.4), shape=(180, 190)), ".png", id="on a round board"),
        pytest.param(small(offset_px=2.7, phase_deg=70), ".png", id="mounted off the axis"),
        pytest.param(Scene(circle=(910.3, 230.8, 190.9), shape=(460, 1700), samples=1), ".jpg", id="a large picture"),
    ],
)
def test_the_silhouette_is_found_to_three_tenths_of_a_pixel(scene: Scene, ending: str, tmp_path: Path) -> None:
    found = find_circle(shoot(scene, tmp_path, ending))
    assert (found.x_px, found.y_px, found.radius_px) == pytest.approx(scene.circle, abs=0.3)


def test_pictures_in_falling_order_of_angle_do_as_well(tmp_path: Path) -> None:
    scene = small(offset_px=2.0, background="white")
    paths = sorted(scene.shoot(tmp_path, ANGLES_DEG).glob("*.png"), reverse=True)
    found = find_circle(Stack(paths))
    assert (found.x_px, found.y_px, found.radius_px) == pytest.approx(scene.circle, abs=0.3)


def test_a_print_that_turns_without_a_sphere_is_refused(tmp_path: Path) -> None:
    noise = np.random.default_rng(3).standard_normal((200, 260, 3))
    blots = cv2.GaussianBlur(noise, (0, 0), 8.0)
    for index in range(12):
        turn = cv2.getRotationMatrix2D((130, 100), 30 * index, 1)
        turned = cv2.warpAffine(blots / blots.std(), turn, (260, 200), borderMode=cv2.BORDER_REFLECT)
        cv2.imwrite(str(tmp_path / f"{index:02d}.png"), np.clip(120 + 30 * turned, 0, 255).astype(np.uint8))
    with pytest.raises(InputError, match=r"no (round outline|sphere on the axis).*--circle X Y R"):
        find_circle(Stack(sorted(tmp_path.glob("*.png"))))


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
