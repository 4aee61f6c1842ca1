"""The camera sees what the configuration promises: place, radius, turn."""

from typing import Literal

import numpy as np
import pytest
from numpy.typing import NDArray

from firmware_sim.mitsuba.config import MitsubaScene
from firmware_sim.mitsuba.renderer import MitsubaRenderer, Surface
from firmware_sim.scene.pose import Pose

HEIGHT, WIDTH = 96, 128
SIZE = (HEIGHT, WIDTH)
STILL = Pose(0.0, 0.0, 90.0, 0.0)
Projection = Literal["perspective", "orthographic"]


def surface(scene: MitsubaScene, variant: str, angle_deg: float = 0.0) -> Surface:
    return MitsubaRenderer(scene, variant).aovs(STILL._replace(turntable_deg=angle_deg), SIZE)


@pytest.mark.parametrize(
    ("projection", "distance_radii"),
    [("orthographic", 8.0), ("perspective", 3.0), ("perspective", 8.0), ("perspective", 40.0)],
)
def test_the_silhouette_is_where_and_as_large_as_promised(
    variant: str, projection: Projection, distance_radii: float
) -> None:
    scene = MitsubaScene(
        projection=projection, distance_radii=distance_radii, centre_x_px=350, centre_y_px=215, radius_px=180
    )
    valid = surface(scene, variant).valid
    rows, columns = np.mgrid[0:HEIGHT, 0:WIDTH] + 0.5
    assert (valid * columns).sum() / valid.sum() == pytest.approx(350 / 5, abs=0.15)
    assert (valid * rows).sum() / valid.sum() == pytest.approx(215 / 5, abs=0.15)
    # Pixels that the outline crosses do not count as the sphere's: about half a pixel all around.
    assert np.sqrt(valid.sum() / np.pi) == pytest.approx(180 / 5 - 0.6, abs=0.3)


def test_normals_are_those_of_the_view_frame(variant: str) -> None:
    seen = surface(MitsubaScene(projection="orthographic"), variant)
    rows, columns = np.mgrid[0:HEIGHT, 0:WIDTH] + 0.5
    x, y = (columns - 324.3 / 5) / 36, (238.6 / 5 - rows) / 36
    within = seen.valid & (np.hypot(x, y) < 0.9)
    np.testing.assert_allclose(seen.normals[within][:, 0], x[within], atol=0.01)
    np.testing.assert_allclose(seen.normals[within][:, 1], y[within], atol=0.01)
    assert np.all(seen.normals[within][:, 2] > 0)


@pytest.mark.parametrize("projection", ["orthographic", "perspective"])
@pytest.mark.parametrize("angle_deg", [0.0, 25.0, 100.0, 190.0])
def test_the_brushing_turns_counter_clockwise_with_the_table(
    variant: str, projection: Projection, angle_deg: float
) -> None:
    seen = surface(MitsubaScene(projection=projection, tangent_zero_deg=10), variant, angle_deg)
    where = seen.valid & (np.hypot(seen.tangents[..., 0], seen.tangents[..., 1]) > 0.3)
    in_picture = np.degrees(np.arctan2(seen.tangents[where][:, 1], seen.tangents[where][:, 0]))
    off_deg = (in_picture - angle_deg - 10 + 180) % 360 - 180
    assert np.abs(off_deg).max() < 0.1


def test_a_turned_sphere_is_the_picture_of_one_that_was_brushed_so(variant: str) -> None:
    turned = MitsubaRenderer(MitsubaScene(samples=256), variant).render(STILL._replace(turntable_deg=60.0), SIZE)
    brushed = MitsubaRenderer(MitsubaScene(samples=256, tangent_zero_deg=60), variant).render(STILL, SIZE)
    straight = MitsubaRenderer(MitsubaScene(samples=256), variant).render(STILL, SIZE)
    assert rms(turned - brushed) < 0.25 * rms(turned - straight)


def test_the_slab_turns_counter_clockwise_too(variant: str) -> None:
    slab = MitsubaScene(
        sample="relief", lights="lamp", projection="orthographic", samples=16, centre_x_px=320, centre_y_px=240
    )
    renderer = MitsubaRenderer(slab, variant)
    straight = renderer.aovs(STILL, (96, 96)).normals
    turned = renderer.aovs(STILL._replace(turntable_deg=90.0), (96, 96)).normals
    counter_clockwise, clockwise = np.rot90(straight), np.rot90(straight, -1)
    assert rms(turned[..., 2] - counter_clockwise[..., 2]) < 0.4 * rms(turned[..., 2] - clockwise[..., 2])
    # What leaned to the right now leans up.
    assert rms(turned[..., 1] - counter_clockwise[..., 0]) < 0.4 * rms(turned[..., 1] + counter_clockwise[..., 0])


def rms(difference: NDArray[np.float32]) -> float:
    return float(np.sqrt(np.mean(difference.astype(np.float64) ** 2)))
