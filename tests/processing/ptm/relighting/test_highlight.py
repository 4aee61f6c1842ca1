import numpy as np
import pytest

from processing.ptm.relighting.highlight import Highlight, shade
from processing.ptm.relighting.relight import relight
from tests.processing.ptm.relighting.materials import lambert, sphere_normals

NORMALS = sphere_normals(65)
LIGHT = np.array([-0.6, 0.48, 0.64])
Z = np.array([0.0, 0, 1])


def test_the_highlight_peaks_half_way_between_light_and_camera() -> None:
    lobe = Highlight(NORMALS.astype(np.float32), 0.8, 60).under(LIGHT)
    half = (LIGHT + Z) / np.linalg.norm(LIGHT + Z)
    brightest = NORMALS[np.unravel_index(np.argmax(lobe), lobe.shape)]
    assert brightest == pytest.approx(half, abs=0.03)
    assert lobe.max() == pytest.approx(0.8, rel=0.02)


def test_a_pixel_by_hand() -> None:
    """Light from the right at 60° off the axis, normal at 10° to the right: 20° off the half-way direction."""
    light, normal = (np.array([np.sin(angle), 0, np.cos(angle)]) for angle in np.radians([60, 10]))
    lobe = Highlight(normal[None, None].astype(np.float32), 0.5, 8).under(light)
    assert lobe[0, 0] == pytest.approx(0.5 * np.cos(np.radians(20)) ** 8, rel=1e-5)


def test_it_is_added_to_the_values_and_never_taken_from_them() -> None:
    sphere = lambert(NORMALS)
    away = np.broadcast_to(np.array([1, 0, 0], np.float32), NORMALS.shape)
    assert np.array_equal(shade(sphere, LIGHT, Highlight(away, 0.5, 3)), relight(sphere, LIGHT))
    lobe = Highlight(NORMALS.astype(np.float32), 0.5, 30)
    assert shade(sphere, LIGHT, lobe) - relight(sphere, LIGHT) == pytest.approx(
        np.repeat(lobe.under(LIGHT)[..., None], 3, axis=-1), abs=1e-6
    )
    assert np.array_equal(shade(sphere, LIGHT), relight(sphere, LIGHT))
