"""Every way of drawing an AMC is what the NumPy reference says, to two codes of 255."""

import dataclasses

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import ndimage

from litrig.base.errors import InputError
from litrig.base.table_normals import TableNormal
from processing.amc.isotropic import isotropic_matcap
from processing.amc.low_rank import compress
from processing.amc.model import Amc
from processing.mesh.builtin import torus
from processing.mesh.fields import painted, turned
from processing.mesh.grids import join
from processing.mesh.model import Mesh
from processing.reference.amc import Way, render_amc, render_keyed, render_sum
from processing.reference.camera import Camera
from processing.reference.shadow import reaches
from processing.reference.surface import in_view, visible_surface
from tests.viewer.analytic import brushed_amc
from tests.viewer.compare import codes_apart, differ
from tests.viewer.scenes import KEY, MESHES, SIZE, lit_and_unlit, split_in_two, with_occlusion
from viewer.geometry import mesh_geometry
from viewer.key_shadow import KeyShadow
from viewer.materials.amc import AmcMaterial, Coordinates, amc_picture
from viewer.materials.low_rank import LowRankMaterial
from viewer.materials.matcap import MatcapMaterial, plain_table
from viewer.renderer import F32, Renderer
from viewer.tangent_lines import LENGTH, SPACING, lines_look, spread_out, tangent_lines
from viewer.targets import Target
from viewer.view import Projection, View

VIEWS = [View(projection, yaw_deg=25, pitch_deg=35, fov_deg=50) for projection in Projection]
WAYS: dict[Coordinates, Way] = {
    Coordinates.FRAGMENT: "fragment",
    Coordinates.MIXED: "mixed",
    Coordinates.VERTEX: "vertex",
}
both_projections = pytest.mark.parametrize("view", VIEWS, ids=lambda view: str(view.projection))
on_every_mesh = pytest.mark.parametrize(
    ("name", "view"),
    [("torus", VIEWS[1]), ("cloth", VIEWS[0]), ("cloth", VIEWS[1]), ("ribbon", VIEWS[1])],
    ids=["torus", "cloth-orthographic", "cloth", "ribbon"],
)


@on_every_mesh
@pytest.mark.parametrize("coordinates", [Coordinates.MIXED, Coordinates.VERTEX])
def test_coordinates_found_at_vertices(renderer: Renderer, name: str, view: View, coordinates: Coordinates) -> None:
    amc, mesh = brushed_amc(32, 30), MESHES[name]
    drawn = amc_picture(renderer, amc, mesh, view, size=SIZE, level=0, coordinates=coordinates)
    truth = render_amc(amc, mesh, view.camera(SIZE), SIZE, way=WAYS[coordinates])
    assert codes_apart(drawn, truth) <= 2


def test_the_three_ways_differ_on_a_coarse_mesh_and_agree_on_a_fine_one(renderer: Renderer) -> None:
    amc, view, apart = brushed_amc(32, 30), VIEWS[0], {}
    for around in (20, 400):
        mesh = torus(around, around // 2)
        every_pixel, *others = (
            amc_picture(renderer, amc, mesh, view, size=SIZE, level=0, coordinates=way) for way in Coordinates
        )
        apart[around] = [float(np.abs(picture - every_pixel).max()) for picture in others]
    mixed, vertex = apart[20]
    assert 0.005 < mixed < vertex / 2, "the paper's more accurate way is more accurate"
    assert max(apart[400]) < 0.001


@pytest.mark.parametrize("coordinates", [Coordinates.MIXED, Coordinates.VERTEX])
def test_interpolated_k_needs_the_trick_even_without_mipmaps(renderer: Renderer, coordinates: Coordinates) -> None:
    """The paper's figure 9: between two vertices on either side of the jump k runs through the whole table."""
    amc, mesh, view = brushed_amc(32, 30, 1), MESHES["torus"], VIEWS[0]
    truth = amc_picture(renderer, amc, mesh, view, size=SIZE, level=0)
    with_trick, without = (
        amc_picture(renderer, amc, mesh, view, size=SIZE, level=0, coordinates=coordinates, seam_trick=trick)
        for trick in (True, False)
    )
    wrong = [np.count_nonzero(np.abs(picture - truth).max(axis=-1) > 0.02) for picture in (with_trick, without)]
    assert wrong[0] == 0
    assert wrong[1] > 40


@on_every_mesh
def test_ambient_occlusion_is_a_factor_on_the_light(renderer: Renderer, name: str, view: View) -> None:
    amc, mesh = brushed_amc(32, 30), with_occlusion(MESHES[name])
    drawn = amc_picture(renderer, amc, mesh, view, size=SIZE, level=0, occluded=True)
    assert codes_apart(drawn, render_amc(amc, mesh, view.camera(SIZE), SIZE, occluded=True)) <= 2
    open_to_all = amc_picture(renderer, amc, mesh, view, size=SIZE, level=0)
    assert differ(drawn, open_to_all) > 20
    assert np.all(drawn[..., :3] <= open_to_all[..., :3])


def test_a_mesh_of_unknown_occlusion_is_open(renderer: Renderer) -> None:
    amc, mesh = brushed_amc(32, 30), MESHES["torus"]
    first, second = (
        amc_picture(renderer, amc, mesh, VIEWS[0], size=SIZE, occluded=occluded) for occluded in (True, False)
    )
    np.testing.assert_array_equal(first, second)


def keyed_picture(renderer: Renderer, lit: Amc, unlit: Amc, mesh: Mesh, view: View) -> F32:
    with (
        renderer.upload(AmcMaterial, lit) as first,
        renderer.upload(AmcMaterial, unlit) as second,
        renderer.upload(mesh_geometry, mesh) as geometry,
        renderer.upload(KeyShadow) as shadow,
    ):
        shadow.cast(renderer, geometry, view, KEY)
        return renderer.picture(first.keyed_look(second, shadow, level=0), geometry, view, size=SIZE)


@on_every_mesh
def test_in_the_shadow_of_the_key_light_the_other_table_shows(renderer: Renderer, name: str, view: View) -> None:
    lit, unlit = lit_and_unlit()
    mesh, camera = MESHES[name], view.camera(SIZE)
    drawn = keyed_picture(renderer, lit, unlit, mesh, view)
    truth = render_keyed(lit, unlit, KEY, mesh, camera, SIZE)
    surface = visible_surface(mesh, camera, SIZE)
    towards = np.array([*KEY, np.sqrt(1 - np.square(KEY).sum())])
    reached = surface.picture(np.repeat(reaches(surface, mesh, camera, towards)[:, None], 3, axis=1))[..., 0] > 0
    covered = truth[..., 3] > 0
    assert 0.03 < reached[covered].mean() < 0.97
    inside = ~ndimage.binary_dilation(reached & covered, iterations=2) | ~ndimage.binary_dilation(
        ~reached & covered, iterations=2
    )
    assert codes_apart(drawn, truth, inside) <= 2
    assert inside[covered].mean() > 0.6, "the border of the shadow is not everything"
    assert differ(drawn, amc_picture(renderer, lit, mesh, view, size=SIZE, level=0)) > 40


def test_a_shadow_falls_where_it_must(renderer: Renderer) -> None:
    """A small square over a large one: its shadow is moved by the light's slope times its height."""

    def square(side: float, z: float) -> Mesh:
        corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32) * side / 2 + [0, 0, z]
        return Mesh(
            positions=corners.astype(np.float32),
            normals=np.tile(np.array([0, 0, 1], np.float32), (4, 1)),
            tangents=np.tile(np.array([1, 0, 0], np.float32), (4, 1)),
            uvs=np.zeros((4, 2), np.float32),
            triangles=np.array([[0, 1, 2], [0, 2, 3]], np.int32),
        )

    lit = Amc(np.full((1, 4, 4, 3), 1.0, np.float32), np.ones((1, 4, 4), bool), "isotropic")
    unlit = dataclasses.replace(lit, slices=np.zeros_like(lit.slices))
    picture = keyed_picture(
        renderer, lit, unlit, join(square(1.3, 0), square(0.2, 0.15)), View(Projection.ORTHOGRAPHIC)
    )
    middle = (np.array(np.nonzero((picture[..., 0] < 0.5) & (picture[..., 3] > 0))).mean(axis=1) + 0.5) - [75, 90]
    # The side of the picture that is shorter shows 2 · 1.06. The shadow lies away from the light, its top part hidden
    # by the square that throws it, if they meet.
    pixels = SIZE[1] / 2.12
    z = np.sqrt(1 - np.square(KEY).sum())
    np.testing.assert_allclose(middle, [0.15 * KEY[1] / z * pixels, -0.15 * KEY[0] / z * pixels], atol=1.0)
    dark = np.count_nonzero((picture[..., 0] < 0.5) & (picture[..., 3] > 0))
    assert dark == pytest.approx((0.2 * pixels) ** 2, rel=0.15)


@pytest.mark.parametrize("key", [(0.8, 0.8), (float("nan"), 0.0)], ids=str)
def test_a_key_light_from_nowhere_is_refused(renderer: Renderer, key: tuple[float, float]) -> None:
    with (
        renderer.upload(mesh_geometry, MESHES["torus"]) as geometry,
        renderer.upload(KeyShadow) as shadow,
        pytest.raises(InputError, match=r"key light: .* is no direction"),
    ):
        shadow.cast(renderer, geometry, VIEWS[0], key)


def test_two_tables_of_different_forms_are_refused(renderer: Renderer) -> None:
    lit, _ = lit_and_unlit()
    with (
        renderer.upload(AmcMaterial, lit) as first,
        renderer.upload(AmcMaterial, dataclasses.replace(lit, table_normal=TableNormal.CAMERA)) as second,
        renderer.upload(KeyShadow) as shadow,
        pytest.raises(InputError, match="build both at once with litrig amc build --unlit"),
    ):
        first.keyed_look(second, shadow)


@on_every_mesh
def test_split_tables_add_up_each_with_its_own_normal(renderer: Renderer, name: str, view: View) -> None:
    low, high = split_in_two(brushed_amc(32, 30))
    low = dataclasses.replace(low, table_normal=TableNormal.CAMERA)
    mesh = MESHES[name]
    with (
        renderer.upload(AmcMaterial, low) as first,
        renderer.upload(AmcMaterial, high) as second,
        renderer.upload(mesh_geometry, mesh) as geometry,
    ):
        drawn = renderer.picture(first.look_with(second, level=0), geometry, view, size=SIZE)
    assert codes_apart(drawn, render_sum(low, high, mesh, view.camera(SIZE), SIZE)) <= 2


def low_rank_picture(
    renderer: Renderer, amc: Amc, rank: int, mesh: Mesh, view: View, level: int | None
) -> tuple[F32, F32]:
    """Draw it from its pictures, and multiplied out."""
    low_rank = compress(amc, rank)
    expanded = low_rank.expand()
    with (
        renderer.upload(LowRankMaterial, low_rank) as material,
        renderer.upload(mesh_geometry, mesh) as geometry,
    ):
        drawn = renderer.picture(material.look(level=level), geometry, view, size=SIZE)
    return drawn, amc_picture(renderer, expanded, mesh, view, size=SIZE, level=level)


@on_every_mesh
@pytest.mark.parametrize(("rank", "level"), [(1, 0), (6, 2), (9, 0)])
def test_a_low_rank_table_needs_no_multiplying_out(
    renderer: Renderer, name: str, view: View, rank: int, level: int
) -> None:
    amc = brushed_amc(32, 30)
    drawn, expanded = low_rank_picture(renderer, amc, rank, MESHES[name], view, level)
    assert codes_apart(drawn, np.maximum(expanded, 0)) <= 2
    if rank == 9:
        truth = render_amc(compress(amc, rank).expand(), MESHES[name], view.camera(SIZE), SIZE, level=level)
        assert codes_apart(drawn, np.maximum(truth, 0)) <= 2


def test_a_low_rank_table_is_read_from_the_level_that_the_whole_one_is_read_from(renderer: Renderer) -> None:
    """Nearly: a driver may take short cuts in finding a volume's level, as Mesa's does by a largest component."""
    for depth in (30, 31):
        amc = brushed_amc(64, depth)
        drawn, expanded = low_rank_picture(renderer, amc, 12, MESHES["cloth"], VIEWS[0], None)
        assert codes_apart(drawn, np.maximum(expanded, 0)) <= 4
        finest, _ = low_rank_picture(renderer, amc, 12, MESHES["cloth"], VIEWS[0], 0)
        assert codes_apart(finest, np.maximum(expanded, 0)) > 12


@on_every_mesh
@pytest.mark.parametrize(
    ("kind", "level"), [(TableNormal.RECTIFIED, 0), (TableNormal.VIEW, 2), (TableNormal.CAMERA, 0)]
)
def test_a_plain_matcap_is_an_amc_of_one_slice(
    renderer: Renderer, name: str, view: View, kind: TableNormal, level: int
) -> None:
    disc = isotropic_matcap(brushed_amc(32, 30))
    with (
        renderer.upload(MatcapMaterial, disc, kind) as material,
        renderer.upload(mesh_geometry, MESHES[name]) as geometry,
    ):
        drawn = renderer.picture(material.look(level=level), geometry, view, size=SIZE)
    truth = render_amc(plain_table(disc, kind), MESHES[name], view.camera(SIZE), SIZE, level=level)
    assert codes_apart(drawn, truth) <= 2


def test_what_lies_outside_a_matcaps_disc_is_no_data(renderer: Renderer) -> None:
    disc = isotropic_matcap(brushed_amc(32, 30))
    along = (2 * np.arange(32) + 1) / 32 - 1
    framed = disc.copy()
    framed[np.hypot(along[:, None], along[None, :]) >= 1] = [0, 9, 0]
    pictures = []
    for picture in (disc, framed):
        with (
            renderer.upload(MatcapMaterial, picture) as material,
            renderer.upload(mesh_geometry, MESHES["torus"]) as geometry,
        ):
            pictures += [renderer.picture(material.look(), geometry, VIEWS[0], size=SIZE)]
    assert differ(*pictures) <= 12
    assert pictures[1].max() < 2


@pytest.mark.parametrize(
    ("disc", "reason"),
    [
        pytest.param(np.zeros((8, 9, 3), np.float32), "no square picture", id="not square"),
        pytest.param(np.zeros((0, 0, 3), np.float32), "no square picture", id="no texel"),
        pytest.param(np.full((8, 8, 3), np.nan, np.float32), "no numbers", id="no numbers"),
        pytest.param(np.zeros((20_000, 20_000, 3), np.float16), "graphics driver ends at", id="too large"),
    ],
)
def test_impossible_matcaps_are_refused(renderer: Renderer, disc: F32, reason: str) -> None:
    with pytest.raises(InputError, match=reason), renderer.upload(MatcapMaterial, disc):
        pass


@both_projections
def test_a_grain_turned_or_painted_is_drawn_as_the_reference_does(renderer: Renderer, view: View) -> None:
    amc, straight = brushed_amc(32, 30), MESHES["torus"]
    angles = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    swirl = np.broadcast_to(np.stack([np.cos(angles), np.sin(angles)], axis=-1)[None], (4, 16, 2)).astype(np.float32)
    before = amc_picture(renderer, amc, straight, view, size=SIZE, level=0)
    for mesh in (turned(straight, 40), painted(straight, swirl)):
        drawn = amc_picture(renderer, amc, mesh, view, size=SIZE, level=0)
        assert codes_apart(drawn, render_amc(amc, mesh, view.camera(SIZE), SIZE)) <= 2
        assert differ(drawn, before) > 40


@both_projections
def test_tangent_lines_lie_along_the_grain(renderer: Renderer, view: View) -> None:
    """Every strip, found by its own colour, is long in the direction that its tangent has on the screen."""
    mesh = turned(MESHES["torus"], 30)
    size = (720, 600)
    with (
        renderer.upload(mesh_geometry, mesh) as geometry,
        renderer.upload(MatcapMaterial, np.zeros((4, 4, 3), np.float32)) as black,
        renderer.upload(tangent_lines, mesh) as lines,
        renderer.upload(Target, size) as target,
    ):
        renderer.draw(black.look(), geometry, target, view)
        renderer.draw(lines_look((1.0, 1.0, 1.0)), lines, target, view, clear=False)
        shown = target.read()[..., 0] > 0.5
    camera = view.camera(size)
    chosen = spread_out(mesh.positions, SPACING)
    ends = [mesh.positions[chosen] + side * LENGTH / 2 * mesh.tangents[chosen] for side in (-1, 1)]
    start, end = (on_screen(points, camera, size) for points in ends)
    components, count = ndimage.label(shown)
    turns_deg, shifts_px = [], []
    for number, place in enumerate(ndimage.find_objects(components), 1):
        rows, columns = np.nonzero(components[place] == number)
        if len(rows) < 20:
            continue
        pixels = np.stack([columns + place[1].start + 0.5, rows + place[0].start + 0.5], axis=1)
        middle = pixels.mean(axis=0)
        nearest = np.argmin(np.linalg.norm((start + end) / 2 - middle, axis=1))
        spread, directions = np.linalg.eigh(np.cov((pixels - middle).T))
        along = end[nearest] - start[nearest]
        if spread[1] < 9 * spread[0] or np.linalg.norm(along) < 12:
            continue  # two that touch, or one half hidden
        shifts_px.append(np.linalg.norm((start[nearest] + end[nearest]) / 2 - middle))
        cosine = abs(directions[:, 1] @ along) / np.linalg.norm(along)
        turns_deg.append(np.degrees(np.arccos(min(1, cosine))))
    assert count > 100 and len(turns_deg) > 60
    assert np.median(turns_deg) < 1 and np.quantile(turns_deg, 0.9) < 5
    assert np.median(shifts_px) < 1


def test_lines_stand_evenly_and_each_at_a_vertex() -> None:
    random = np.random.default_rng(4)
    positions = random.uniform(-1, 1, (5000, 3)).astype(np.float32)
    chosen = spread_out(positions, 0.5)
    assert len(np.unique(chosen)) == len(chosen) == 64
    assert len(np.unique(np.floor(positions[chosen] / 0.5), axis=0)) == 64


def on_screen(points: NDArray[np.float32], camera: Camera, size: tuple[int, int]) -> NDArray[np.float64]:
    """Return columns and rows (N, 2) of points in the object's frame."""
    clip = np.concatenate([in_view(points, camera), np.ones((len(points), 1))], axis=1) @ camera.clip_from_view.T
    places = clip[:, :2] / clip[:, 3:]
    return np.stack([(places[:, 0] + 1) / 2 * size[0], (1 - places[:, 1]) / 2 * size[1]], axis=1)
