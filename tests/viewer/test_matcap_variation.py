"""Decomposed MatCaps that are edited, and that vary over a surface, as the shader draws them."""

import dataclasses
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from litrig.base.errors import InputError
from litrig.base.pictures import read_codes
from processing.matcap.lights.model import Disc, Hung, Picture
from processing.matcap.matcap_exr import write_matcap
from processing.matcap.model import DecomposedMatcap
from processing.matcap.recipe.material import with_filter_size
from processing.matcap.render import shaded
from processing.matcap.silhouette import Silhouette
from processing.matcap.variation import NONE, Variation
from processing.mesh.builtin import sphere
from processing.reference.decomposed_matcap import render_decomposed
from tests.processing.matcap.maps import analytic
from tests.viewer.compare import codes_apart
from tests.viewer.scenes import MESHES, SIZE, with_occlusion
from tests.viewer.test_cli import SMALL, codes, run
from viewer.geometry import mesh_geometry
from viewer.materials.decomposed_matcap import DecomposedMatcapMaterial
from viewer.opened_matcap import towards
from viewer.renderer import Renderer
from viewer.view import Projection, View

F32 = NDArray[np.float32]
VIEW = View(Projection.PERSPECTIVE, yaw_deg=25, pitch_deg=35, fov_deg=50)
MESH = with_occlusion(MESHES["torus"])
RNG = np.random.default_rng(3)
COLOURS = cv2.resize(RNG.random((4, 5, 3), np.float32), (40, 48), interpolation=cv2.INTER_CUBIC).clip(0, 1)
GREY = cv2.resize(RNG.random((4, 3), np.float32), (32, 24), interpolation=cv2.INTER_CUBIC).clip(0, 1)
IDS = RNG.integers(0, 3, (5, 6)).astype(np.float32)
TURNED = dataclasses.replace(
    analytic(64),
    low=dataclasses.replace(
        analytic(64).low, silhouette=Silhouette(30, 0.6, 1.0), light_turn_deg=(20, 50, 0), normal_turn_deg=(0, 0, 70)
    ),
    high=dataclasses.replace(
        analytic(64).high,
        silhouette=Silhouette(60, -0.4, 0.0),
        light_turn_deg=(20, 50, 0),
        lights=(Disc(colour=(1, 0.4, 0.4), direction=(0.2, 0.5, 0.8), size_deg=15),),
        pictures=(Hung(Picture(colour=(1, 1, 1), direction=(0.5, -0.3, 0.8), size_deg=40), np.ones((4, 6, 4), "f4")),),
    ),
)
OTHERS = (analytic(48, slopes=(0.0, 0.2)), dataclasses.replace(TURNED, high=analytic(64).high))


def drawn(
    renderer: Renderer,
    matcap: DecomposedMatcap,
    variation: Variation = NONE,
    others: tuple[DecomposedMatcap, ...] = (),
    *,
    occlusion: tuple[float, float] = (1.0, 1.0),
    light_turn: Rotation | None = None,
    occluded: bool = True,
) -> F32:
    whole = (matcap, *others)
    with renderer.upload(mesh_geometry, MESH) as geometry:
        uploads = [
            renderer.upload(DecomposedMatcapMaterial, one, variation, number) for number, one in enumerate(whole)
        ]
        materials = [upload.__enter__() for upload in uploads]
        looks = [one.look(level=0, occluded=occluded, occlusion=occlusion, light_turn=light_turn) for one in materials]
        picture = renderer.picture(dataclasses.replace(looks[0], others=tuple(looks[1:])), geometry, VIEW, size=SIZE)
        for upload in uploads:
            upload.__exit__(None, None, None)
        return picture


def truth(
    matcap: DecomposedMatcap,
    variation: Variation = NONE,
    others: tuple[DecomposedMatcap, ...] = (),
    *,
    occlusion: tuple[float, float] = (1.0, 1.0),
) -> NDArray[np.float64]:
    return render_decomposed(
        matcap, MESH, VIEW.camera(SIZE), SIZE, occluded=True, occlusion=occlusion, variation=variation, others=others
    )


def test_turns_silhouettes_and_added_lights(renderer: Renderer) -> None:
    assert codes_apart(drawn(renderer, TURNED), truth(TURNED)) <= 2


NEEDLES = RNG.normal(0, 0.3, (30, 30, 3)).astype(np.float32)
LACKING = dataclasses.replace(
    analytic(64),
    low=dataclasses.replace(analytic(64).low, remainder=NEEDLES[:20, :20], light_turn_deg=(0, 0, 50)),
    high=dataclasses.replace(analytic(64).high, remainder=NEEDLES, light_turn_deg=(0.2, 0.4, 0)),
)


@pytest.mark.parametrize("variation", [NONE, Variation(roughness=GREY, roughest=(0.0, 0.1))], ids=["plain", "rougher"])
def test_what_the_maps_lack_is_added_where_neither_light_nor_roughness_changed(
    renderer: Renderer, variation: Variation
) -> None:
    picture = drawn(renderer, LACKING, variation)
    assert codes_apart(picture, truth(LACKING, variation)) <= 2
    without = dataclasses.replace(LACKING, low=dataclasses.replace(LACKING.low, remainder=None))
    assert np.abs(picture - truth(without, variation)).max() > 0.1
    led = truth(dataclasses.replace(LACKING, low=dataclasses.replace(without.low, light_turn_deg=(0, 2, 50))))
    tipped = dataclasses.replace(LACKING, low=dataclasses.replace(LACKING.low, light_turn_deg=(0, 2, 50)))
    assert codes_apart(drawn(renderer, tipped), led) <= 2


VARIATIONS = {
    "low colours": Variation(low_colours=COLOURS),
    "high colours": Variation(high_colours=COLOURS),
    "an occlusion map": Variation(openness=GREY),
    "roughness": Variation(roughness=GREY, roughest=(0.33, 0.1)),
    "all": Variation(COLOURS, 1 - COLOURS, GREY, (0.0, 0.06), GREY),
}


@pytest.mark.parametrize("name", VARIATIONS)
def test_what_varies(renderer: Renderer, name: str) -> None:
    picture = drawn(renderer, TURNED, VARIATIONS[name])
    assert codes_apart(picture, truth(TURNED, VARIATIONS[name])) <= 2
    assert np.abs(picture - truth(TURNED)).max() > 0.1


@pytest.mark.parametrize("occlusion", [(1.0, 0.0), (0.0, 1.0)], ids=["low", "high"])
def test_occlusion_of_one_half(renderer: Renderer, occlusion: tuple[float, float]) -> None:
    variation = Variation(openness=GREY)
    picture = drawn(renderer, TURNED, variation, occlusion=occlusion)
    assert codes_apart(picture, truth(TURNED, variation, occlusion=occlusion)) <= 2
    assert np.abs(picture - truth(TURNED, variation)).max() > 0.1


def test_several_materials_on_one_mesh(renderer: Renderer) -> None:
    variation = Variation(low_colours=COLOURS, materials=IDS)
    picture, wanted = drawn(renderer, TURNED, variation, OTHERS), truth(TURNED, variation, OTHERS)
    # Beside the edges of the ids, where a place may be rounded to either side.
    assert np.mean(np.abs(picture - wanted).max(axis=-1) > 0.01) < 0.01
    alone = [truth(one, Variation(low_colours=COLOURS)) for one in (TURNED, *OTHERS)]
    shares = [np.mean(np.abs(picture - one).max(axis=-1)[wanted[..., 3] > 0] < 0.01) for one in alone]
    assert min(shares) > 0.1 and sum(shares) > 0.9


def test_even_roughness_is_the_material_of_that_filter_size() -> None:
    """The chain of blurred maps against the maps blurred at once."""
    ball = sphere(96, 48)
    camera = View(Projection.ORTHOGRAPHIC).camera(SIZE)
    for wanted_size in (0.03, 0.1):
        even = Variation(roughness=np.ones((2, 2), np.float32), roughest=(0.0, wanted_size))
        found = render_decomposed(analytic(64), ball, camera, SIZE, variation=even)
        rougher = dataclasses.replace(analytic(64), high=with_filter_size(analytic(64).high, wanted_size))
        wanted = render_decomposed(rougher, ball, camera, SIZE)
        before = np.abs(render_decomposed(analytic(64), ball, camera, SIZE) - wanted).max()
        assert np.abs(found - wanted).max() < 0.15 * before


def test_light_that_is_led_shows_what_came_from_the_camera_there(renderer: Renderer) -> None:
    lamp = dataclasses.replace(
        analytic(64), high=dataclasses.replace(analytic(64).high, light_turn_deg=(30.0, 0.0, 0.0))
    )
    turn = towards((0.5, 0.3))
    np.testing.assert_allclose(turn.apply([0, 0, 1]), [0.5, 0.3, np.sqrt(1 - 0.34)], atol=1e-12)
    whole = dataclasses.replace(
        lamp,
        low=dataclasses.replace(lamp.low, light_turn_deg=tuple(turn.as_rotvec(degrees=True))),
        high=dataclasses.replace(
            lamp.high,
            light_turn_deg=tuple((turn * Rotation.from_rotvec([30, 0, 0], degrees=True)).as_rotvec(degrees=True)),
        ),
    )
    assert codes_apart(drawn(renderer, lamp, light_turn=turn), truth(whole)) <= 2


def test_the_command_takes_them_all(tmp_path: Path) -> None:
    for name, matcap in (("a", TURNED), ("b", OTHERS[0])):
        write_matcap(tmp_path / f"{name}.matcap.exr", matcap)
    for name, plane in (("colours", COLOURS), ("grey", GREY)):
        cv2.imwrite(str(tmp_path / f"{name}.png"), (255 * plane).astype(np.uint8))
    cv2.imwrite(str(tmp_path / "ids.png"), (90 * (IDS > 1)).astype(np.uint8))
    (tmp_path / "x.recipe.toml").write_text('[[steps]]\nop = "rotate"\naxis = "z"\ndegrees = 100\n')
    plain = ["--mesh", "torus", *SMALL]
    run(tmp_path / "a.matcap.exr", "-o", tmp_path / "plain.png", *plain)
    tried: dict[str, list[str | Path | float]] = {
        "recipe": ["--recipe", tmp_path / "x.recipe.toml"],
        "light": ["--light", 0.5, 0.2],
        "low": ["--low-texture", tmp_path / "colours.png"],
        "high": ["--high-texture", tmp_path / "colours.png"],
        "rough": ["--roughness-texture", tmp_path / "grey.png", "--roughest", 0, 18],
        "open": ["--occlusion-map", tmp_path / "grey.png", "--occlusion-of", "low"],
        "ids": ["--material-ids", tmp_path / "ids.png", "--with", tmp_path / "b.matcap.exr"],
    }
    before = codes(tmp_path / "plain.png")
    seen = []
    for name, options in tried.items():
        run(tmp_path / "a.matcap.exr", "-o", tmp_path / f"{name}.png", *plain, *options)
        seen.append(codes(tmp_path / f"{name}.png"))
        assert np.abs(seen[-1].astype(int) - before).max() > 20, name
    assert len({picture.tobytes() for picture in seen}) == len(tried)


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--with", "b.matcap.exr"], "give --material-ids"),
        (["--material-ids", "ids.png"], r"ids\.png: has 2 colours, and MatCaps for 1"),
        (["--material-ids", "ids.jpg"], "must keep their values"),
        (["--material-ids", "ids.png", "--with", "ids.png"], "is no decomposed MatCap by its ending"),
        (["--light", "0", "0", "--light", "0.1", "0"], "give --light once"),
        (["--light", "0.9", "0.9"], "is no direction"),
        (["--specular", "0.4", "30"], "leave out what is for PTMs"),
        (["--occlusion-of", "low"], "give --occlusion or --occlusion-map"),
        (["--roughest", "0", "40"], "give --roughness-texture"),
        (["--low-texture", "none.png"], r"none\.png: no such file"),
    ],
)
def test_what_does_not_go_together_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, options: list[str], reason: str
) -> None:
    monkeypatch.chdir(tmp_path)
    write_matcap(tmp_path / "a.matcap.exr", analytic(8))
    write_matcap(tmp_path / "b.matcap.exr", analytic(8))
    for name in ("ids.png", "ids.jpg"):
        cv2.imwrite(name, np.array([[0, 255]], np.uint8))
    with pytest.raises(InputError, match=reason):
        run("a.matcap.exr", "-o", "x.png", *SMALL, *options)
    assert not (tmp_path / "x.png").exists()


def test_other_materials_take_no_recipe(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "ball.png"), np.zeros((8, 8, 3), np.uint8))
    assert read_codes(tmp_path / "ball.png").shape == (8, 8, 3)
    with pytest.raises(InputError, match=r"ball\.png: is no decomposed MatCap"):
        run(tmp_path / "ball.png", "-o", tmp_path / "x.png", "--recipe", tmp_path / "x.recipe.toml", *SMALL)


def test_the_reference_is_the_disc_s_own_formula() -> None:
    """On a flat picture of normals, with no mesh between."""
    camera = View(Projection.ORTHOGRAPHIC).camera(SIZE)
    ball = sphere(256, 128)
    picture = render_decomposed(TURNED, ball, camera, SIZE)
    rows, columns = np.nonzero(picture[..., 3])
    scale = 2 * 1.06 / min(SIZE)
    x, y = (columns + 0.5 - SIZE[0] / 2) * scale, -(rows + 0.5 - SIZE[1] / 2) * scale
    inside = np.hypot(x, y) < 0.9
    normals = np.stack([x, y, np.sqrt(np.maximum(1 - x * x - y * y, 0))], axis=-1)[inside]
    found = picture[rows[inside], columns[inside], :3]
    assert np.quantile(np.abs(found - shaded(TURNED, normals)), 0.99) < 0.02
