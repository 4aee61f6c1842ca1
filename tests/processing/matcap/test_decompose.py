from dataclasses import replace

import numpy as np
import pytest

from litrig.base.errors import InputError
from litrig.base.radiometry import encode_srgb
from processing.matcap.decompose import Filter, decompose, fitting_size
from processing.matcap.disc import disc_normals, spread_out
from processing.matcap.model import Component, DecomposedMatcap
from processing.matcap.render import component_light, disc_picture, unwarped
from processing.matcap.render import seen as looks_at
from processing.matcap.separation.separate import separate
from processing.paraboloid.maps import places, texel_directions
from processing.reference.texels import bilinear
from tests.processing.matcap.discs import F64, glossy, hard_edged

FILTERS = (Filter.of_size(0.45), Filter.of_size(0.05))


def drawn(matcap: DecomposedMatcap, size: int) -> F64:
    """The disc by the paper's section 5, written out with angles, and what its maps lack."""
    normals, inside = disc_normals(size)
    picture = np.zeros((size, size, 3))
    for component in (matcap.low, matcap.high):
        light = seen(component, normals[inside])
        if component.remainder is not None:
            light += component.remainder[inside] * np.asarray(component.base_colour)
        picture[inside] += light
    return picture


def seen(component: Component, normals: F64) -> F64:
    angle, azimuth = np.arccos(normals[:, 2]), np.arctan2(normals[:, 1], normals[:, 0])
    turned = angle * (1 + component.slope)
    omega = np.stack([np.sin(turned) * np.cos(azimuth), np.sin(turned) * np.sin(azimuth), np.cos(turned)], axis=1)
    in_front, columns, rows = places(omega)
    front, back = (bilinear(half, columns, rows) for half in (component.front, component.back))
    light: F64 = np.where(in_front[:, None], front, back) * np.asarray(component.base_colour)
    return light


@pytest.mark.parametrize(
    ("size", "slopes"), [(64, (0.62, 0.98)), (96, (0.0, 1.0)), (128, (0.3, 0.95)), (256, (0.5, 1))]
)
def test_an_unedited_picture_of_hard_edges_is_the_input(size: int, slopes: tuple[float, float]) -> None:
    picture = hard_edged(size)
    apart = separate(picture)
    found = decompose(apart.low, apart.high, apart.known, (Filter.of_slope(slopes[0]), Filter.of_slope(slopes[1])))
    inside = disc_normals(size)[1] & apart.known
    np.testing.assert_allclose(drawn(found, size)[inside], picture[inside], atol=2e-5)
    np.testing.assert_allclose(disc_picture(found)[inside], picture[inside], atol=2e-5)


def test_a_bright_and_noisy_picture_comes_back_as_exactly() -> None:
    picture = 30 * hard_edged(96) + np.random.default_rng(2).random((96, 96, 3), np.float32) / 50
    apart = separate(picture)
    found = disc_picture(decompose(apart.low, apart.high, apart.known, FILTERS))
    np.testing.assert_allclose(found[apart.known], picture[apart.known], atol=2e-5)


def test_a_dark_picture_comes_back_in_finer_steps() -> None:
    picture = hard_edged(64) / 1000
    apart = separate(picture)
    found = disc_picture(decompose(apart.low, apart.high, apart.known, FILTERS))
    np.testing.assert_allclose(found[apart.known], picture[apart.known], atol=2e-8)


def test_maps_finer_than_the_picture_lack_less_of_it() -> None:
    apart = separate(glossy(64))
    coarse, fine = (decompose(apart.low, apart.high, apart.known, FILTERS, size=size) for size in (32, 256))
    lacking = []
    for found in (coarse, fine):
        assert found.high.remainder is not None
        lacking.append(np.abs(found.high.remainder).mean())
    assert coarse.high.front.shape == (32, 32, 3) and lacking[0] > 8 * lacking[1] > 0


def test_turned_light_is_nearly_as_sharp_as_the_disc_shows_it() -> None:
    picture = hard_edged(96)
    apart = separate(picture)
    found = decompose(apart.low, apart.high, apart.known, FILTERS)
    turn = (0.0, 60.0, 0.0)
    normals, inside = disc_normals(96)
    shown, wanted, held = np.zeros((2, inside.sum(), 3)), np.zeros((2, inside.sum(), 3)), np.ones(inside.sum(), bool)
    for index, (component, layer) in enumerate(((found.low, apart.low), (found.high, apart.high))):
        turned = replace(component, light_turn_deg=turn)
        shown[index] = component_light(turned, normals[inside])
        source = unwarped(looks_at(turned, normals[inside]), component.slope)
        held &= (source[:, 2] > 0) & (np.hypot(source[:, 0], source[:, 1]) < 1 - 4 / 96)
        disc = spread_out(layer.astype(np.float32), apart.known)
        wanted[index] = bilinear(disc, (1 + source[:, 0]) / 2, (1 - source[:, 1]) / 2)
    off = encode_srgb(shown.sum(axis=0)) - encode_srgb(wanted.sum(axis=0))
    assert held.mean() > 0.6 and np.sqrt((off[held] ** 2).mean()) < 5 / 255
    assert np.median(np.abs(off[held])) < 0.3 / 255


def test_where_a_component_is_brightest_its_light_is_white() -> None:
    apart = separate(glossy(48))
    found = decompose(apart.low, apart.high, apart.known, FILTERS, size=256)
    for component, layer in ((found.low, apart.low), (found.high, apart.high)):
        brightest = np.unravel_index(np.argmax(layer @ [0.2126, 0.7152, 0.0722]), layer.shape[:2])
        np.testing.assert_allclose(component.base_colour, layer[brightest], rtol=0.02)
        assert component.front.max() == pytest.approx(1, abs=0.05)
    assert (found.low.slope, found.high.filter_size) == (FILTERS[0].slope, 0.05)
    assert found.picture_size == 48


def test_corners_hold_what_the_other_map_has_there() -> None:
    apart = separate(glossy(64))
    component = decompose(apart.low, apart.high, apart.known, FILTERS, size=256).high
    for texels, directions in zip((component.front, component.back), texel_directions(256), strict=True):
        behind_seam = np.sign(directions[..., 2]) != np.sign(directions[128, 128, 2])
        in_front, columns, rows = places(directions[behind_seam])
        other = np.where(
            in_front[:, None],
            bilinear(component.front, columns, rows),
            bilinear(component.back, columns, rows),
        )
        assert np.abs(texels[behind_seam] - other).mean() < 0.002


def test_maps_hold_no_light_below_black_and_no_gaps() -> None:
    apart = separate(hard_edged(48))
    found = decompose(apart.low, apart.high, apart.known, (Filter.of_slope(0.1), Filter.of_slope(0.9)), size=128)
    for component in (found.low, found.high):
        for texels in (component.front, component.back):
            assert np.isfinite(texels).all() and texels.min() >= 0


@pytest.mark.parametrize("fill", ["guided", "harmonic"])
def test_a_flat_light_is_flat_behind_as_well(fill: str) -> None:
    low = np.full((48, 48, 3), 0.5)
    found = decompose(low, np.zeros_like(low), None, FILTERS, fill="harmonic" if fill == "harmonic" else "guided")
    for texels in (found.low.front, found.low.back):
        np.testing.assert_allclose(texels, 1, atol=1e-4)
    assert not found.high.front.any() and found.high.base_colour == (1, 1, 1)


def test_a_painted_back_is_seen_in_the_blind_spot_alone() -> None:
    apart = separate(glossy(48))
    painted = np.full((16, 16, 3), 7, np.float32)
    plain, found = (
        decompose(apart.low, apart.high, apart.known, FILTERS, size=96, painted=given).low.back
        for given in (None, (painted, painted))
    )
    angles = np.arccos(texel_directions(96)[1][..., 2])
    in_spot = angles > (1 + FILTERS[0].slope) * np.pi / 2
    assert (found[in_spot] == 7).all()
    np.testing.assert_array_equal(found[~in_spot], plain[~in_spot])


def test_a_channel_that_is_black_at_the_brightest_point_does_no_harm() -> None:
    picture = glossy(48)
    picture[..., 2] = 0
    picture[10:14, 20:24] = (0, 0, 0.2)
    apart = separate(picture)
    found = decompose(apart.low, apart.high, apart.known, FILTERS)
    np.testing.assert_allclose(drawn(found, 48)[apart.known], picture[apart.known], atol=2e-5)


def test_a_black_picture_is_black_light() -> None:
    black = np.zeros((8, 8, 3))
    found = decompose(black, black, None, FILTERS)
    assert not any(half.any() for part in (found.low, found.high) for half in (part.front, part.back))


def test_size_and_slope_go_together() -> None:
    for size in (0.01, 0.2, 0.46):
        assert Filter.of_slope(Filter.of_size(size).slope).size == pytest.approx(size)


def test_maps_are_twice_as_large_as_the_picture_up_to_a_limit() -> None:
    assert [fitting_size(side) for side in (4, 65, 512, 5000)] == [64, 144, 1024, 2048]


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        pytest.param({"high": np.zeros((9, 9, 3))}, "layers of 8 and 9", id="two sizes"),
        pytest.param({"low": np.zeros((8, 9, 3))}, "low layer: 9 × 8", id="not square"),
        pytest.param({"known": np.zeros((8, 8), bool)}, "no pixel", id="nothing known"),
        pytest.param({"filters": (Filter(0.1, 1.2), FILTERS[1])}, "low filter's slope 1.2", id="slope"),
        pytest.param({"size": 4}, "maps of 4", id="size"),
    ],
)
def test_what_cannot_be_taken_apart_is_refused(change: dict[str, object], reason: str) -> None:
    good: dict[str, object] = {
        "low": np.ones((8, 8, 3)),
        "high": np.ones((8, 8, 3)),
        "known": None,
        "filters": FILTERS,
        "size": 16,
    }
    with pytest.raises(InputError, match=reason):
        decompose(**{**good, **change})  # type: ignore[arg-type]
