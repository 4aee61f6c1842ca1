"""PTMs as the shader draws them: flat, texel by texel, and on a mesh."""

import numpy as np
import pytest

import viewer.flat_picture
from litrig.base.errors import InputError
from litrig.base.radiometry import decode_srgb, to_u8
from processing.mesh.model import Mesh
from processing.ptm.model import Ptm, Space
from processing.ptm.relighting.relight import relight
from viewer.flat_picture import flat_picture
from viewer.materials.ptm import ptm_mesh_picture
from viewer.materials.ptm_shading import PtmShading, shading_lights
from viewer.renderer import Renderer
from viewer.view import Projection, View

LIGHTS = [(0.0, 0.0), (0.6, -0.3), (-0.8, 0.6), (1.0, 0.0)]


def under(*lights: tuple[float, float]) -> PtmShading:
    return PtmShading(shading_lights(lights))


def some_ptm(kind: str, height: int = 23, width: int = 37, space: Space = "srgb") -> Ptm:
    random = np.random.default_rng(1)
    channels = 1 if kind == "LRGB" else 3
    coefficients = random.uniform(-0.4, 0.4, (6, height, width, channels)).astype(np.float32)
    coefficients[5] += 0.6
    colour = random.uniform(0.2, 1.2, (height, width, 3)).astype(np.float32) if kind == "LRGB" else None
    return Ptm(coefficients, colour, space)


@pytest.mark.parametrize("light", LIGHTS, ids=str)
@pytest.mark.parametrize("kind", ["LRGB", "RGB"])
def test_shader_and_reference_agree(renderer: Renderer, kind: str, light: tuple[float, float]) -> None:
    ptm = some_ptm(kind)
    drawn = flat_picture(renderer, ptm, under(light))
    truth = relight(ptm, np.array(light))
    assert truth.std() > 0.1
    np.testing.assert_allclose(drawn, truth, atol=1e-5)
    assert np.quantile(np.abs(to_u8(drawn).astype(int) - to_u8(truth)), 0.999) <= 1


def test_a_pixel_worked_out_by_hand(renderer: Renderer) -> None:
    coefficients = np.zeros((6, 1, 2, 1), np.float32)
    coefficients[:, 0, 1, 0] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
    ptm = Ptm(coefficients, np.array([[[1, 1, 1], [1, 0.5, 0]]], np.float32))
    luminance = 0.1 * 0.25 + 0.2 * 0.04 + 0.3 * -0.1 + 0.4 * 0.5 + 0.5 * -0.2 + 0.6
    drawn = flat_picture(renderer, ptm, under((0.5, -0.2)))
    np.testing.assert_allclose(drawn[0], np.array([[0, 0, 0], [luminance, luminance / 2, 0]]), atol=1e-6)


def test_values_are_not_cut_off(renderer: Renderer) -> None:
    coefficients = np.zeros((6, 1, 1, 3), np.float32)
    coefficients[5, 0, 0] = [-0.5, 0.5, 2.5]
    np.testing.assert_array_equal(
        flat_picture(renderer, Ptm(coefficients, None), under((0, 0)))[0, 0], [-0.5, 0.5, 2.5]
    )


@pytest.mark.parametrize("kind", ["LRGB", "RGB"])
def test_a_large_ptm_is_drawn_in_bands(renderer: Renderer, monkeypatch: pytest.MonkeyPatch, kind: str) -> None:
    ptm = some_ptm(kind)
    whole = flat_picture(renderer, ptm, under((0.3, 0.2)))
    monkeypatch.setattr(viewer.flat_picture, "BAND_BYTES", 37 * 5 * 4 * 14)
    np.testing.assert_array_equal(flat_picture(renderer, ptm, under((0.3, 0.2))), whole)


@pytest.mark.parametrize("light", [(0.9, 0.9), (1.1, 0.0), (float("nan"), 0.0)], ids=str)
def test_a_light_outside_the_disc_is_refused(renderer: Renderer, light: tuple[float, float]) -> None:
    with pytest.raises(InputError, match="is no direction"):
        flat_picture(renderer, some_ptm("RGB"), under(light))


def square() -> Mesh:
    """A flat square that fills the picture of an orthographic view, upright and facing the camera."""
    side = 1.06
    positions = np.array([[-side, -side, 0], [side, -side, 0], [side, side, 0], [-side, side, 0]], np.float32)
    return Mesh(
        positions=positions,
        normals=np.tile(np.array([0, 0, 1], np.float32), (4, 1)),
        tangents=np.tile(np.array([1, 0, 0], np.float32), (4, 1)),
        uvs=np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32),
        triangles=np.array([[0, 1, 2], [0, 2, 3]], np.int32),
    )


@pytest.mark.parametrize("space", ["srgb", "linear"])
@pytest.mark.parametrize("kind", ["LRGB", "RGB"])
def test_on_a_square_that_fills_the_picture_it_is_the_flat_picture(renderer: Renderer, kind: str, space: Space) -> None:
    ptm = some_ptm(kind, 32, 32, space)
    light = (0.5, -0.4)
    drawn = ptm_mesh_picture(renderer, ptm, square(), View(Projection.ORTHOGRAPHIC), under(light), size=(32, 32))
    flat = np.maximum(relight(ptm, np.array(light)), 0)
    np.testing.assert_allclose(drawn[..., :3], decode_srgb(flat) if space == "srgb" else flat, atol=2e-4)
    np.testing.assert_array_equal(drawn[..., 3], 1)


@pytest.mark.parametrize(
    ("yaw_deg", "pitch_deg", "light", "in_surface"),
    [
        pytest.param(0, 0, (0.6, 0.0), (0.6, 0.0), id="facing the camera"),
        pytest.param(30, 0, (0.5, 0.0), (0.0, 0.0), id="turned to the light, which then falls straight"),
        pytest.param(0, 30, (0.0, -0.5), (0.0, 0.0), id="tipped to the light"),
        pytest.param(180, 0, (0.3, 0.2), (-0.3, 0.2), id="from behind: mirrored, and so is the light"),
    ],
)
def test_the_light_turns_against_the_surface(
    renderer: Renderer,
    yaw_deg: float,
    pitch_deg: float,
    light: tuple[float, float],
    in_surface: tuple[float, float],
) -> None:
    coefficients = np.zeros((6, 8, 8, 3), np.float32)
    coefficients[3, ..., 0], coefficients[4, ..., 1] = 0.4, 0.4
    coefficients[5] = 0.5
    ptm = Ptm(coefficients, None, "linear")
    view = View(Projection.ORTHOGRAPHIC, yaw_deg, pitch_deg)
    middle = ptm_mesh_picture(renderer, ptm, square(), view, under(light), size=(33, 33))[16, 16]
    np.testing.assert_allclose(middle, [0.5 + 0.4 * in_surface[0], 0.5 + 0.4 * in_surface[1], 0.5, 1], atol=1e-4)


def test_a_repeated_picture_begins_anew(renderer: Renderer) -> None:
    ptm, view = some_ptm("LRGB", 16, 16, "linear"), View(Projection.ORTHOGRAPHIC)
    drawn = ptm_mesh_picture(renderer, ptm, square(), view, under((0.5, -0.4)), size=(32, 32), repeat=2)
    flat = np.maximum(relight(ptm, np.array([0.5, -0.4])), 0)
    np.testing.assert_allclose(drawn[..., :3], np.tile(flat, (2, 2, 1)), atol=2e-4)


def test_what_faces_away_from_the_light_is_dark(renderer: Renderer) -> None:
    ptm = Ptm(np.ones((6, 4, 4, 3), np.float32), None, "linear")
    view = View(Projection.ORTHOGRAPHIC, yaw_deg=60)
    middle = ptm_mesh_picture(renderer, ptm, square(), view, under((-0.95, 0.0)), size=(33, 33))[16, 16]
    np.testing.assert_array_equal(middle, [0, 0, 0, 1])
