import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from processing.ptm.basis import PTM, Basis
from processing.ptm.model import Colour, Ptm
from processing.ptm.relighting.relight import relight
from processing.ptm.relighting.unsharp import sharpen
from tests.processing.ptm.relighting.materials import lambert, sphere_normals

LIGHT = np.array([0.5, -0.2])


@pytest.mark.parametrize("basis", [PTM, Basis("hsh", 9)], ids=str)
@pytest.mark.parametrize("colour", ["rgb", "lrgb"])
def test_it_is_the_unsharp_mask_of_the_picture(basis: Basis, colour: Colour) -> None:
    """The colour of this LRGB material is the same all over, so that the luminance's mask is the picture's."""
    sphere = lambert(sphere_normals(), basis, colour=colour)
    picture = relight(sphere, LIGHT)
    blurred = np.stack([gaussian_filter(channel, 1.5, truncate=6) for channel in np.moveaxis(picture, -1, 0)], axis=-1)
    assert relight(sharpen(sphere, 2, 1.5), LIGHT) == pytest.approx(picture + 2 * (picture - blurred), abs=2e-3)
    assert np.abs(picture - blurred).max() > 0.02


@pytest.mark.parametrize("radius_px", [0.3, 2.0, 40.0])
def test_what_is_even_stays(radius_px: float) -> None:
    """Up to the border, and under a blur that is wider than the picture."""
    even = Ptm(np.full((6, 9, 7, 3), 0.3, np.float32), None)
    assert sharpen(even, 5, radius_px).coefficients == pytest.approx(even.coefficients, abs=1e-5)


def test_a_gain_of_zero_changes_nothing() -> None:
    sphere = lambert(sphere_normals(9))
    assert np.array_equal(sharpen(sphere, 0, 2).coefficients, sphere.coefficients)


def test_an_edge_is_raised_on_its_bright_side_and_lowered_on_its_dark_one() -> None:
    coefficients = np.zeros((6, 9, 12, 1), np.float32)
    coefficients[5, :, :6] = 0.2
    coefficients[5, :, 6:] = 0.6
    row = sharpen(Ptm(coefficients, np.ones((9, 12, 3), np.float32)), 1, 1).coefficients[5, 4, :, 0]
    assert row[5] < 0.15
    assert row[6] > 0.65
    assert row[[0, -1]] == pytest.approx([0.2, 0.6], abs=1e-3)
