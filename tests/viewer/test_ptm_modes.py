"""Every way of showing a PTM, and its kin in other bases, is what NumPy says, flat and on meshes."""

import numpy as np
import pytest

import viewer.flat_picture
from litrig.base.errors import InputError
from litrig.base.radiometry import decode_srgb, encode_srgb, to_u8
from processing.ptm.basis import PTM, TERMS, Basis
from processing.ptm.model import Colour, Ptm, Space
from processing.ptm.relighting.diffuse_gain import gain_diffuse
from processing.ptm.relighting.highlight import Highlight, shade
from processing.ptm.relighting.lights import Lights, lamps
from processing.ptm.relighting.many_lights import relight_by_many
from processing.ptm.relighting.normals import normals_of
from processing.ptm.relighting.relight import relight
from processing.reference.ptm import area_average, render_ptm, render_ptm_normals
from tests.processing.ptm.files.fitted import SIZE as SIDE
from tests.processing.ptm.files.fitted import fitted
from tests.viewer.compare import codes_apart
from tests.viewer.scenes import MESHES, SIZE, with_occlusion
from viewer.flat_picture import FlatView, flat_picture
from viewer.materials.ptm import PtmMaterial, ptm_mesh_picture
from viewer.materials.ptm_shading import MOST_LIGHTS, SOFT_SAMPLES, PtmShading, shading_lights
from viewer.motion import turned_lights
from viewer.renderer import Renderer
from viewer.view import Projection, View

BASES = [Basis(kind, terms) for kind, counts in TERMS.items() for terms in counts]
LIGHT = (0.45, -0.3)
HSH = Basis("hsh", 9)
COLOURED = shading_lights(((0.5, 0.2), (-0.6, -0.4), (0.0, 0.9)), ((0.7, 0.2, 0.1), (0.1, 0.3, 0.9), (0.3, 0.3, 0.3)))
SOFT = shading_lights(((0.5, 0.2), (-0.7, 0.1)), ((0.7, 0.2, 0.1), (0.1, 0.3, 0.9)), 20.0)
every_basis = pytest.mark.parametrize("basis", BASES, ids=str)
every_colour = pytest.mark.parametrize("colour", ["lrgb", "rgb"])
VIEWS = [View(projection, yaw_deg=25, pitch_deg=35, fov_deg=50) for projection in Projection]


def under(*lights: tuple[float, float], **how: object) -> PtmShading:
    return PtmShading(shading_lights(lights), **how)  # type: ignore[arg-type]


def linear(ptm: Ptm) -> Ptm:
    return Ptm(ptm.coefficients, ptm.colour, "linear", basis=ptm.basis)


def agree(drawn: np.ndarray, truth: np.ndarray) -> None:
    assert truth.std() > 0.05
    np.testing.assert_allclose(drawn, truth, atol=2e-5)
    assert np.quantile(np.abs(to_u8(drawn).astype(int) - to_u8(truth)), 0.999) <= 2


@every_basis
@every_colour
@pytest.mark.parametrize("light", [(0.0, 0.0), LIGHT, (-0.6, 0.8)], ids=str)
def test_every_basis_flat(renderer: Renderer, basis: Basis, colour: Colour, light: tuple[float, float]) -> None:
    ptm = fitted(basis, colour)
    agree(flat_picture(renderer, ptm, under(light)), relight(ptm, under(light).lights.directions[0]))


@pytest.mark.parametrize("lights", [COLOURED, SOFT], ids=["coloured", "soft"])
@pytest.mark.parametrize("space", ["srgb", "linear"])
@pytest.mark.parametrize("basis", [PTM, HSH], ids=str)
def test_lights_add_up_as_light(renderer: Renderer, basis: Basis, space: Space, lights: Lights) -> None:
    ptm = fitted(basis, "lrgb")
    ptm = ptm if space == "srgb" else linear(ptm)
    drawn = flat_picture(renderer, ptm, PtmShading(lights), as_light=True)
    agree(encode_srgb(drawn), encode_srgb(relight_by_many(ptm, lights)))


@every_colour
@pytest.mark.parametrize("gain", [0.0, 0.5, 2.5])
def test_diffuse_gain(renderer: Renderer, colour: Colour, gain: float) -> None:
    ptm = fitted(PTM, colour)
    truth = relight(gain_diffuse(ptm, gain), np.array(LIGHT))
    assert np.abs(truth - relight(ptm, np.array(LIGHT))).max() > 0.1
    agree(flat_picture(renderer, ptm, under(LIGHT, diffuse_gain=gain)), truth)


@pytest.mark.parametrize("basis", [PTM, Basis("ptm", 3), HSH], ids=str)
def test_a_highlight_is_added_to_the_values(renderer: Renderer, basis: Basis) -> None:
    ptm = fitted(basis, "rgb")
    lights = lamps([LIGHT])
    truth = shade(ptm, lights.directions[0], Highlight(normals_of(ptm), 0.6, 25.0))
    assert np.abs(truth - relight(ptm, lights.directions[0])).max() > 0.3
    agree(flat_picture(renderer, ptm, under(LIGHT, gloss=(0.6, 25.0))), truth)


def test_gain_and_highlight_under_many_lights(renderer: Renderer) -> None:
    ptm = fitted(PTM, "lrgb")
    truth = relight_by_many(gain_diffuse(ptm, 1.8), COLOURED, Highlight(normals_of(ptm), 0.3, 40.0))
    shading = PtmShading(COLOURED, 1.8, (0.3, 40.0))
    agree(encode_srgb(flat_picture(renderer, ptm, shading, as_light=True)), encode_srgb(truth))


@every_basis
def test_normals_are_shown_as_colours(renderer: Renderer, basis: Basis) -> None:
    ptm = fitted(basis, "rgb")
    drawn = flat_picture(renderer, ptm, under(LIGHT, view="normals"))
    agree(drawn, 0.5 + 0.5 * normals_of(ptm))


@pytest.mark.parametrize("as_light", [False, True], ids=["values", "light"])
def test_magnified_texels_are_squares(renderer: Renderer, as_light: bool) -> None:
    ptm = fitted(HSH, "lrgb")
    flat = FlatView((5, 40, 7, 9), 6.0)
    drawn = flat_picture(renderer, ptm, under(LIGHT), flat, as_light=as_light)
    whole = flat_picture(renderer, ptm, under(LIGHT), as_light=as_light)
    assert drawn.shape == (54, 42, 3)
    np.testing.assert_array_equal(drawn, np.kron(whole[40:49, 5:12], np.ones((6, 6, 1))))


def test_a_zoom_that_is_no_whole_number_takes_the_nearest_texel(renderer: Renderer) -> None:
    ptm = fitted(PTM, "rgb")
    drawn = flat_picture(renderer, ptm, under(LIGHT), FlatView((0, 0, 10, 10), 2.5))
    nearest = np.floor((np.arange(25) + 0.5) / 2.5).astype(int)
    whole = flat_picture(renderer, ptm, under(LIGHT))
    np.testing.assert_array_equal(drawn, whole[nearest[:, None], nearest[None]])


@pytest.mark.parametrize("zoom", [0.5, 0.37, 0.05])
@pytest.mark.parametrize("how", ["display values", "linear values", "light", "normals"])
def test_shrunk_it_is_the_mean_light_of_what_a_pixel_covers(renderer: Renderer, zoom: float, how: str) -> None:
    ptm = fitted(PTM, "lrgb")
    ptm = linear(ptm) if how == "linear values" else ptm
    shading = under(LIGHT, view="normals" if how == "normals" else "lit")
    drawn = flat_picture(renderer, ptm, shading, FlatView(None, zoom), as_light=how == "light")
    side = round(SIDE * zoom)
    whole = flat_picture(renderer, ptm, shading, as_light=how == "light")
    if how == "display values":
        truth = encode_srgb(area_average(decode_srgb(whole), (side, side)))
        np.testing.assert_allclose(np.clip(drawn, 0, 1), truth, atol=1e-4)
    else:
        np.testing.assert_allclose(drawn, area_average(whole, (side, side)), atol=1e-4)
    assert drawn.std() > 0.01


@pytest.mark.parametrize("zoom", [0.37, 1.0, 3.3])
def test_bands_join_without_a_seam(renderer: Renderer, monkeypatch: pytest.MonkeyPatch, zoom: float) -> None:
    ptm, flat, shading = fitted(PTM, "lrgb"), FlatView((3, 2, 50, 60), zoom), under(LIGHT, gloss=(0.2, 9.0))
    whole = flat_picture(renderer, ptm, shading, flat)
    monkeypatch.setattr(viewer.flat_picture, "BAND_BYTES", 50 * 4 * 14 * 7)
    np.testing.assert_allclose(flat_picture(renderer, ptm, shading, flat), whole, atol=1e-6)


MODES: dict[str, PtmShading] = {
    "one light": under(LIGHT),
    "coloured": PtmShading(COLOURED),
    "soft": PtmShading(SOFT),
    "gain": under(LIGHT, diffuse_gain=2.0),
    "highlight": under(LIGHT, gloss=(0.5, 20.0)),
    "all": PtmShading(COLOURED, 1.5, (0.3, 30.0)),
}


@pytest.mark.parametrize(
    ("name", "view"), [("torus", VIEWS[0]), ("cloth", VIEWS[1]), ("ribbon", VIEWS[1])], ids=lambda value: str(value)[:9]
)
@pytest.mark.parametrize("mode", MODES)
def test_every_mode_on_a_mesh(renderer: Renderer, name: str, view: View, mode: str) -> None:
    ptm, mesh, shading = fitted(PTM, "lrgb"), MESHES[name], MODES[mode]
    drawn = ptm_mesh_picture(renderer, ptm, mesh, view, shading, size=SIZE, level=0)
    truth = render_ptm(
        *(ptm, mesh, view.camera(SIZE), SIZE, shading.lights),
        diffuse_gain=shading.diffuse_gain,
        gloss=shading.gloss,
    )
    assert codes_apart(drawn, truth) <= 2


@every_basis
@every_colour
def test_every_basis_on_a_mesh(renderer: Renderer, basis: Basis, colour: Colour) -> None:
    ptm, mesh, shading = fitted(basis, colour), with_occlusion(MESHES["cloth"]), under((0.3, 0.5))
    drawn = ptm_mesh_picture(renderer, ptm, mesh, VIEWS[0], shading, size=SIZE, level=0, occluded=True)
    truth = render_ptm(ptm, mesh, VIEWS[0].camera(SIZE), SIZE, shading.lights, occluded=True)
    assert codes_apart(drawn, truth) <= 2


@pytest.mark.parametrize("name", MESHES)
def test_normals_on_a_mesh(renderer: Renderer, name: str) -> None:
    ptm = fitted(PTM, "rgb")
    drawn = ptm_mesh_picture(renderer, ptm, MESHES[name], VIEWS[0], under(LIGHT, view="normals"), size=SIZE, level=0)
    assert codes_apart(drawn, render_ptm_normals(ptm, MESHES[name], VIEWS[0].camera(SIZE), SIZE)) <= 2


def test_small_on_screen_it_is_read_from_smaller_copies(renderer: Renderer) -> None:
    """At full size a fine pattern would shimmer; its smaller copies are its mean."""
    coefficients = np.zeros((6, 256, 256, 3), np.float32)
    coefficients[5] = np.indices((256, 256)).sum(axis=0)[..., None] % 2
    ptm = Ptm(coefficients, None, "linear")
    fitting, full = (
        ptm_mesh_picture(renderer, ptm, MESHES["cloth"], VIEWS[0], under((0.0, 0.0)), size=(60, 50), level=level)
        for level in (None, 0)
    )
    covered = fitting[..., 3] > 0
    assert fitting[covered][:, 0].std() < 0.2 * full[covered][:, 0].std()


def test_turned_lights_go_round_at_their_height() -> None:
    turned = turned_lights(COLOURED, 90)
    np.testing.assert_allclose(turned.directions[:, 2], COLOURED.directions[:, 2])
    np.testing.assert_allclose(turned.directions[0, :2], [-0.2, 0.5], atol=1e-12)
    np.testing.assert_array_equal(turned.colours, COLOURED.colours)


@pytest.mark.parametrize(
    ("shading", "reason"),
    [
        pytest.param(lambda: under((0.8, 0.8)), "is no direction", id="a light below"),
        pytest.param(lambda: under((float("nan"), 0)), "is no direction", id="a light nowhere"),
        pytest.param(
            lambda: shading_lights(((0, 0),), ((1, 1, 1), (1, 1, 1))), "1 of them and 2 colours", id="a colour too many"
        ),
        pytest.param(lambda: shading_lights(((0, 0),), ((1, -1, 1),)), "a colour below 0", id="a dark colour"),
        pytest.param(
            lambda: shading_lights(((0, 0),), (), 91), r"softness of 91 deg is outside 0\.\.90", id="softness"
        ),
        pytest.param(lambda: PtmShading(lamps([(0, 0)] * (MOST_LIGHTS + 1))), "65 are outside 1..64", id="many lights"),
        pytest.param(lambda: under(LIGHT, diffuse_gain=-1), "is no gain", id="a negative gain"),
        pytest.param(lambda: under(LIGHT, gloss=(0.3, 0)), "an exponent above 0", id="a flat highlight"),
    ],
)
def test_shading_that_cannot_be_is_refused(shading: object, reason: str) -> None:
    with pytest.raises(InputError, match=reason) as caught:
        shading()  # type: ignore[operator]
    assert "\n" not in str(caught.value)


def test_so_are_gain_without_second_derivatives_and_a_level_that_is_not_there(renderer: Renderer) -> None:
    shading = under(LIGHT, diffuse_gain=2.0)
    with pytest.raises(InputError, match="is a HSH of 9 terms, and diffuse gain"):
        flat_picture(renderer, fitted(HSH, "rgb"), shading)
    with renderer.upload(PtmMaterial, fitted(HSH, "rgb"), smooth=True) as material:
        with pytest.raises(InputError, match="second derivatives"):
            material.mesh_look(shading)
        with pytest.raises(InputError, match="no mip level 7; there are 0 to 6"):
            material.mesh_look(under(LIGHT), level=7)


@pytest.mark.parametrize(
    ("flat", "reason"),
    [
        (FlatView((60, 0, 5, 5)), "5 × 5 texels at 60, 0 are not within the PTM's 64 × 64"),
        (FlatView((-1, 0, 5, 5)), "not within"),
        (FlatView((0, 0, 0, 5)), "not within"),
        (FlatView(None, 1e9), "zoom less"),
        (FlatView(None, float("nan")), "shows nothing"),
    ],
    ids=str,
)
def test_a_window_or_zoom_that_cannot_be_is_refused(renderer: Renderer, flat: FlatView, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        flat_picture(renderer, fitted(PTM, "rgb"), under(LIGHT), flat)


def test_a_soft_light_is_a_disc_of_lights_around_it() -> None:
    assert len(SOFT.directions) == 2 * SOFT_SAMPLES
    first = SOFT.directions[:SOFT_SAMPLES]
    middle = lamps([(0.5, 0.2)]).directions[0]
    off_deg = np.degrees(np.arccos(first @ middle))
    assert 17 < off_deg.max() <= 20
    # Spread evenly, a quarter lies within half the radius.
    assert np.mean(off_deg < 10) == pytest.approx(0.25, abs=0.05)
    np.testing.assert_allclose(first.mean(axis=0) / np.linalg.norm(first.mean(axis=0)), middle, atol=0.02)
    np.testing.assert_allclose(SOFT.colours[:SOFT_SAMPLES].sum(axis=0), [0.7, 0.2, 0.1])
