import numpy as np
import pytest
from numpy.typing import NDArray

from processing.matcap.disc import disc_normals, spread_out
from processing.matcap.unwarping.blind_spot import filled_from_rim, lay_painted, lay_spot, rim_place, spot_radius
from processing.paraboloid.maps import texel_directions

F32 = NDArray[np.float32]
SIZE, SLOPE = 256, 0.5


def disc_of(order: int = 0, fall: float = 0.0) -> F32:
    """A disc whose light over the back map's places is (r/R)^k cos kφ, and rises off the rim by `fall` a radius."""
    normals, inside = disc_normals(SIZE)
    angle = np.arccos(normals[..., 2]) * (1 + SLOPE)
    place = np.tan((np.pi - angle) / 2) / rim_place(SLOPE, SIZE)
    place = np.minimum(place, 2)
    azimuth = np.arctan2(normals[..., 1], normals[..., 0])
    value = 1 + 0.5 * place**order * np.cos(order * azimuth) + fall * (place - 1)
    return spread_out(np.repeat(value[..., None], 3, axis=-1).astype(np.float32), inside)


@pytest.mark.parametrize("order", [0, 1, 2, 5])
def test_without_a_guide_the_spot_is_the_harmonic_function_of_its_rim(order: int) -> None:
    spot = filled_from_rim(disc_of(order=order), SLOPE, guided=False)
    rings, spokes, _ = spot.shape
    place, azimuth = np.linspace(0, 1, rings)[:, None], 2 * np.pi * np.arange(spokes) / spokes
    wanted = 1 + 0.5 * place**order * np.cos(order * azimuth)
    off = np.abs(spot[..., 1] - wanted)
    assert off[:100].max() < 0.02 and off.mean() < 0.007  # pixels of the rim are far apart in the map


@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_the_guided_spot_solves_poissons_equation(order: int) -> None:
    spot = filled_from_rim(disc_of(order=order, fall=0.1), SLOPE, guided=True)[..., 0].astype(np.float64)
    plain = filled_from_rim(disc_of(order=order, fall=0.1), SLOPE, guided=False)[..., 0].astype(np.float64)
    # The laplacian of r² + …, by differences on rings and spokes, of what the guide adds.
    added = spot - plain
    r, dr, turn = np.linspace(0, 1, len(added))[:, None], 1 / (len(added) - 1), 2 * np.pi / added.shape[1]
    radial = np.gradient(r * np.gradient(added, dr, axis=0), dr, axis=0) / np.maximum(r, dr)
    round_ = (np.roll(added, 8, 1) - 2 * added + np.roll(added, -8, 1)) / (8 * turn) ** 2 / np.maximum(r, dr) ** 2
    laplacian = (radial + round_)[30:-4]
    # The derivative at the rim is measured over 8° of the disc.
    expected = 2 * (0.1 + 0.5 * order * np.cos(order * turn * np.arange(added.shape[1])))
    assert np.abs(laplacian - expected).mean() < 0.3 * max(np.abs(expected).mean(), 0.1) + 0.03


def test_what_gets_brighter_towards_the_spot_goes_on_to_its_centre() -> None:
    falling, rising, flat = (
        float(filled_from_rim(disc_of(fall=fall), SLOPE, guided=True)[0, 0, 0]) for fall in (0.3, -0.05, 0.0)
    )
    assert falling < flat - 0.1
    assert rising >= flat


def test_the_spot_meets_its_rim_in_both_maps() -> None:
    slope = 0.02  # the spot reaches nearly to the seam, so that the front map's corners lie in it, too
    normals, inside = disc_normals(SIZE)
    disc = spread_out(np.repeat((1 + normals[..., :1]) / 2, 3, axis=-1).astype(np.float32), inside)
    reach = rim_place(slope, SIZE)
    spot = filled_from_rim(disc, slope, guided=False)
    for behind, directions in zip((False, True), texel_directions(96), strict=True):
        texels = np.full((96, 96, 3), -1, np.float32)
        lay_spot(texels, spot, reach, behind=behind)
        laid = texels[..., 0] >= 0
        place = np.hypot(*np.moveaxis(directions[..., :2], -1, 0)) / (1 - directions[..., 2])
        np.testing.assert_array_equal(laid, place < reach)
        azimuth = np.arctan2(directions[..., 1], directions[..., 0])
        wanted = (1 + place / reach * np.cos(azimuth)) / 2
        np.testing.assert_allclose(texels[laid][:, 0], wanted[laid], atol=0.02)


def test_a_painted_back_map_shows_where_the_disc_does_not() -> None:
    painted = np.zeros((64, 64, 3), np.float32)
    painted[:32] = 1  # the upper half of the back map
    texels = np.full((64, 64, 3), 0.5, np.float32)
    lay_painted(texels, painted, SLOPE, behind=True)
    assert texels[28, 32, 0] == 1 and texels[36, 32, 0] == 0 and texels[2, 32, 0] == 0.5


def test_a_mirror_has_no_blind_spot() -> None:
    assert spot_radius(1.0) == 0
    assert spot_radius(0.0) == pytest.approx(1)
