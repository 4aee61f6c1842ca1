import numpy as np
import pytest

from processing.ptm.basis import PTM, Basis
from processing.ptm.model import Colour, Ptm, Space
from processing.ptm.relighting.brightest import brightest_light
from processing.ptm.relighting.normals import normals_of
from tests.processing.ptm.relighting.materials import angles_deg, lambert, sphere_normals

NORMALS = sphere_normals()
BALL = NORMALS[..., 2] < 0.999


@pytest.mark.parametrize(
    ("basis", "space", "mean_deg"),
    [
        (PTM, "srgb", 3.5),
        (PTM, "linear", 1.0),
        (Basis("ptm", 3), "srgb", 7.5),
        (Basis("ptm", 3), "linear", 6.5),
        (Basis("hsh", 4), "srgb", 3.0),
        (Basis("hsh", 9), "srgb", 2.0),
        (Basis("hsh", 9), "linear", 1.0),
        (Basis("hsh", 16), "srgb", 1.5),
    ],
    ids=str,
)
def test_the_normals_of_a_lambert_sphere(basis: Basis, space: Space, mean_deg: float) -> None:
    found = normals_of(lambert(NORMALS, basis, space))
    assert angles_deg(found, NORMALS)[BALL].mean() < mean_deg
    assert np.linalg.norm(found, axis=-1) == pytest.approx(1, abs=1e-5)


def test_the_brightest_light_is_much_farther_from_the_normal() -> None:
    """Why normals are not taken from the maximum of the fit."""
    sphere = lambert(NORMALS)
    flat = brightest_light(sphere.coefficients[..., 0])
    brightest = np.dstack([flat, np.sqrt(np.maximum(1 - np.sum(flat**2, axis=-1), 0))])
    least = angles_deg(normals_of(sphere), NORMALS)[BALL].mean()
    assert angles_deg(brightest, NORMALS)[BALL].mean() > 3 * least


@pytest.mark.parametrize("colour", ["rgb", "lrgb"])
def test_colour_makes_no_difference(colour: Colour) -> None:
    found = normals_of(lambert(NORMALS, Basis("hsh", 9), colour=colour))
    assert angles_deg(found, NORMALS)[BALL].mean() < 2


def test_black_and_even_pixels_face_the_camera() -> None:
    coefficients = np.zeros((6, 1, 2, 1), np.float32)
    coefficients[5, 0, 1] = 0.5
    found = normals_of(Ptm(coefficients, np.ones((1, 2, 3), np.float32)))
    assert angles_deg(found, np.array([0.0, 0, 1])) == pytest.approx(0, abs=3)
    assert found[0, 0] == pytest.approx([0, 0, 1])


def test_no_normal_faces_away_from_the_camera() -> None:
    """Not even where a fit is below zero all over, leaning to the left."""
    coefficients = np.zeros((6, 1, 1, 1), np.float32)
    coefficients[[3, 5], 0, 0, 0] = [-0.3, -0.5]
    assert normals_of(Ptm(coefficients, None, "linear"))[0, 0] == pytest.approx([-1, 0, 0], abs=0.2)
