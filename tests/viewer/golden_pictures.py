"""Pictures that are kept, one for every way of drawing, to be looked at by whoever changes them.

`python -m tests.viewer.golden_pictures` draws all of them again, into `tests/viewer/golden`. A new way of drawing
adds a function here.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from litrig.base.pictures import write_codes
from litrig.base.radiometry import decode_srgb
from litrig.base.table_normals import TableNormal
from processing.amc.isotropic import isotropic_matcap
from processing.amc.low_rank import compress
from processing.amc.model import Amc, TangentAngle
from processing.matcap.lights.model import Disc
from processing.matcap.silhouette import Silhouette
from processing.matcap.variation import Variation
from processing.mesh.builtin import cloth, torus
from processing.mesh.fields import painted, turned
from processing.mesh.model import Mesh
from processing.mesh.sewn import skirt
from processing.ptm.basis import PTM, Basis
from processing.reference.display import display_codes, over
from tests.processing.matcap.maps import analytic
from tests.processing.ptm.files.fitted import fitted
from tests.processing.shape import scene
from tests.viewer.analytic import brushed_amc
from tests.viewer.scenes import KEY, lit_and_unlit, split_in_two, with_occlusion
from viewer.flat_picture import FlatView, flat_picture
from viewer.geometry import mesh_geometry
from viewer.key_shadow import KeyShadow
from viewer.look import Look
from viewer.materials.amc import AmcMaterial, Coordinates, amc_picture
from viewer.materials.decomposed_matcap import DecomposedMatcapMaterial
from viewer.materials.low_rank import LowRankMaterial
from viewer.materials.matcap import MatcapMaterial
from viewer.materials.ptm import ptm_mesh_picture
from viewer.materials.ptm_shading import PtmShading, shading_lights
from viewer.materials.shading_buffers import recomposed_picture
from viewer.renderer import F32, Renderer
from viewer.tangent_lines import lines_look, tangent_lines
from viewer.targets import Target
from viewer.view import Projection, View

FOLDER = Path(__file__).parent / "golden"
SIZE, SUPERSAMPLE = (112, 112), 2
BACKGROUND = (0.014, 0.015, 0.018)
VIEW = View(yaw_deg=25, pitch_deg=35)
TORUS, CLOTH, SEWN = torus(96, 48), cloth(120), skirt(24, 60)
ONE_LIGHT = PtmShading(shading_lights(((0.5, 0.4),)))

Drawn = Callable[[Renderer], F32]


def of_amc(amc: Amc, mesh: Mesh = TORUS, view: View = VIEW, coordinates: Coordinates = Coordinates.FRAGMENT) -> Drawn:
    return lambda renderer: amc_picture(
        renderer, amc, mesh, view, size=SIZE, supersample=SUPERSAMPLE, coordinates=coordinates
    )


def of_look(look: Look, renderer: Renderer, mesh: Mesh) -> F32:
    with renderer.upload(mesh_geometry, mesh) as geometry:
        return renderer.picture(look, geometry, VIEW, size=SIZE, supersample=SUPERSAMPLE)


def small(renderer: Renderer) -> F32:
    """Small on screen, so that small levels are read; shown larger."""
    picture = amc_picture(renderer, brushed_amc(64, 64), TORUS, VIEW, size=(28, 28))
    return np.repeat(np.repeat(picture, 4, axis=0), 4, axis=1)


def occluded(renderer: Renderer) -> F32:
    return amc_picture(
        renderer, brushed_amc(32, 30), with_occlusion(CLOTH), VIEW, size=SIZE, supersample=SUPERSAMPLE, occluded=True
    )


def keyed(renderer: Renderer) -> F32:
    lit, unlit = lit_and_unlit()
    with (
        renderer.upload(AmcMaterial, lit) as first,
        renderer.upload(AmcMaterial, unlit) as second,
        renderer.upload(mesh_geometry, CLOTH) as geometry,
        renderer.upload(KeyShadow) as shadow,
    ):
        shadow.cast(renderer, geometry, VIEW, KEY)
        look = first.keyed_look(second, shadow)
        return renderer.picture(look, geometry, VIEW, size=SIZE, supersample=SUPERSAMPLE)


def summed(renderer: Renderer) -> F32:
    low, high = split_in_two(brushed_amc(32, 30))
    low = replace(low, table_normal=TableNormal.CAMERA)
    with renderer.upload(AmcMaterial, low) as first, renderer.upload(AmcMaterial, high) as second:
        return of_look(first.look_with(second), renderer, TORUS)


def low_rank(renderer: Renderer) -> F32:
    with renderer.upload(LowRankMaterial, compress(brushed_amc(32, 30), 6)) as material:
        return of_look(material.look(), renderer, TORUS)


def matcap(renderer: Renderer) -> F32:
    with renderer.upload(MatcapMaterial, isotropic_matcap(brushed_amc(32, 30))) as material:
        return of_look(material.look(), renderer, SEWN)


def decomposed(renderer: Renderer) -> F32:
    with renderer.upload(DecomposedMatcapMaterial, analytic(64)) as material:
        return of_look(material.look(), renderer, CLOTH)


def varied(renderer: Renderer) -> F32:
    """Light that is turned, a silhouette, a painted light, patches of colour, roughness that grows, two materials."""
    plain = analytic(64)
    low = replace(plain.low, silhouette=Silhouette(40, 0.5, 1.0), light_turn_deg=(0, 50, 0))
    painted_on = Disc(colour=(1, 0.9, 0.6), direction=(0.3, 0.7, 0.65), size_deg=14)
    edited = replace(plain, low=low, high=replace(plain.high, light_turn_deg=(0, 50, 0), lights=(painted_on,)))
    blue = replace(plain, low=replace(plain.low, base_colour=(0.1, 0.2, 0.6)))
    row, column = np.mgrid[:6, :12]
    patches = np.where(((row + column) % 2 == 0)[..., None], [1.0, 1, 1], [0.5, 0.9, 0.4]).astype(np.float32)
    growing = np.repeat(np.linspace(0, 1, 16, dtype=np.float32)[:, None], 2, axis=1)
    halves = np.array([[0.0, 0, 0, 1]], np.float32)
    variation = Variation(low_colours=patches, roughness=growing, roughest=(0, 0.2), materials=halves)
    with (
        renderer.upload(DecomposedMatcapMaterial, edited, variation, 0) as first,
        renderer.upload(DecomposedMatcapMaterial, blue, variation, 1) as second,
    ):
        return of_look(replace(first.look(), others=(second.look(),)), renderer, TORUS)


def recomposed(renderer: Renderer) -> F32:
    buffers = scene.buffers()
    picture = recomposed_picture(renderer, buffers, scene.environments(), scene.bumped(buffers.normals))
    return np.concatenate([picture, np.ones_like(picture[..., :1])], axis=-1)


def tangents(renderer: Renderer) -> F32:
    with (
        renderer.upload(AmcMaterial, brushed_amc(32, 30)) as material,
        renderer.upload(mesh_geometry, CLOTH) as geometry,
        renderer.upload(tangent_lines, CLOTH) as lines,
        renderer.upload(Target, SIZE, SUPERSAMPLE) as target,
    ):
        renderer.draw(material.look(), geometry, target, VIEW)
        renderer.draw(lines_look(), lines, target, VIEW, clear=False)
        return target.read()


def ptm(basis: Basis, shading: PtmShading, mesh: Mesh = CLOTH) -> Drawn:
    return lambda renderer: ptm_mesh_picture(
        renderer, fitted(basis, "lrgb"), mesh, VIEW, shading, size=SIZE, supersample=SUPERSAMPLE
    )


def flat(basis: Basis, shading: PtmShading, view: FlatView, *, as_light: bool = False) -> Drawn:
    """Light under a display's eyes: what is drawn as display values is decoded first, so that all end alike."""

    def draw(renderer: Renderer) -> F32:
        values = flat_picture(renderer, fitted(basis, "lrgb"), shading, view, as_light=as_light)
        light = values if as_light else decode_srgb(values)
        return np.concatenate([light, np.ones_like(light[..., :1])], axis=-1)

    return draw


def swirl() -> F32:
    angles = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=-1).astype(np.float32)
    return np.repeat(directions[None], 4, axis=0)


PICTURES: dict[str, Drawn] = {
    "amc-perspective": of_amc(brushed_amc(32, 30)),
    "amc-orthographic": of_amc(brushed_amc(32, 30), CLOTH, replace(VIEW, projection=Projection.ORTHOGRAPHIC)),
    "amc-repeats-3": of_amc(brushed_amc(32, 30, 3)),
    "amc-small-levels": small,
    "amc-normal-view": of_amc(brushed_amc(32, 30, 2, TableNormal.VIEW), view=replace(VIEW, fov_deg=60)),
    "amc-normal-camera": of_amc(brushed_amc(32, 30, 2, TableNormal.CAMERA), view=replace(VIEW, fov_deg=60)),
    "amc-angle-in-surface": of_amc(replace(brushed_amc(32, 30, 4), tangent_angle=TangentAngle.SURFACE)),
    "amc-k-at-vertices": of_amc(brushed_amc(32, 30), torus(28, 14), coordinates=Coordinates.MIXED),
    "amc-all-at-vertices": of_amc(brushed_amc(32, 30), torus(28, 14), coordinates=Coordinates.VERTEX),
    "amc-occluded": occluded,
    "amc-key-shadow": keyed,
    "amc-tangents": tangents,
    "amc-turned": of_amc(brushed_amc(32, 30), turned(TORUS, 90)),
    "amc-painted": of_amc(brushed_amc(32, 30), painted(TORUS, swirl())),
    "amc-sewn": of_amc(brushed_amc(32, 30), SEWN),
    "amc-low-rank": low_rank,
    "amc-split": summed,
    "matcap-sewn": matcap,
    "matcap-decomposed": decomposed,
    "matcap-varied": varied,
    "shading-buffers": recomposed,
    "ptm": ptm(PTM, ONE_LIGHT),
    "ptm-lights": ptm(PTM, PtmShading(shading_lights(((0.7, 0.2), (-0.6, 0.4)), ((1, 0.5, 0.2), (0.1, 0.3, 0.9)), 12))),
    "ptm-gain": ptm(PTM, replace(ONE_LIGHT, diffuse_gain=2.5)),
    "ptm-highlight": ptm(PTM, replace(ONE_LIGHT, gloss=(0.5, 20))),
    "ptm-normals": ptm(PTM, replace(ONE_LIGHT, view="normals")),
    "hsh": ptm(Basis("hsh", 16), ONE_LIGHT, TORUS),
    "ptm-flat": flat(PTM, ONE_LIGHT, FlatView(None, 1.75)),
    "hsh-flat-lights": flat(
        Basis("hsh", 9), PtmShading(shading_lights(((0.7, 0.2), (-0.6, 0.4)))), FlatView(None, 1.75), as_light=True
    ),
    "ptm-texels": flat(PTM, ONE_LIGHT, FlatView((20, 20, 16, 16), 7)),
    "ptm-shrunk": flat(PTM, ONE_LIGHT, FlatView(None, 0.5)),
    "ptm-flat-normals": flat(PTM, replace(ONE_LIGHT, view="normals"), FlatView(None, 1.75)),
}


def drawn_codes(renderer: Renderer, name: str) -> np.ndarray:
    """Draw one over a dark background, as codes (H, W, 3)."""
    return display_codes(over(PICTURES[name](renderer), BACKGROUND))[..., :3]


def main() -> None:
    FOLDER.mkdir(exist_ok=True)
    with Renderer() as renderer:
        for name in PICTURES:
            write_codes(FOLDER / f"{name}.png", drawn_codes(renderer, name))


if __name__ == "__main__":
    main()
