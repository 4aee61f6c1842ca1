"""Make the pictures of docs/synthesis.md. Usage: python -m benchmarks.synthesis_figures docs/pictures"""

import sys
import tempfile
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from benchmarks.materials import SAMPLES, fitted
from litrig.base.radiometry import decode_srgb, encode_srgb, to_u8
from processing.mesh.builtin import builtin_mesh
from processing.mesh.model import Mesh
from processing.ptm.model import Ptm
from processing.ptm.relighting.relight import relight
from processing.ptm.synthesis.fill import fill
from processing.ptm.synthesis.settings import Synthesis
from processing.ptm.synthesis.synthesize import synthesize
from viewer.materials.ptm import ptm_mesh_picture
from viewer.materials.ptm_shading import Light, PtmShading, shading_lights
from viewer.renderer import Renderer
from viewer.view import View

F32 = NDArray[np.float32]
SOURCE_PX, TILE_PX = 192, 240
LIGHTS: tuple[Light, ...] = ((-0.6, 0.5), (0.1, 0.1), (0.75, -0.2))
MESHES = {"relief": ("torus", 3), "fabric": ("cloth", 2), "grains": ("pillow", 2)}
OBJECT_PX = 340
LAMP: Light = (-0.55, 0.6)
BACKGROUND = 0.13


def main() -> None:
    folder = Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as place:
        sources = {name: fitted(name, SOURCE_PX, Path(place)) for name in SAMPLES}
    tiles = {
        name: synthesize([source], (TILE_PX, TILE_PX), Synthesis(tileable=True)).material
        for name, source in sources.items()
    }
    _save(folder / "synthesis-lights.jpg", np.concatenate([_lit_row(sources[name], tiles[name]) for name in SAMPLES]))
    _save(folder / "synthesis-objects.jpg", _objects(tiles))
    _save(folder / "synthesis-hole.jpg", np.concatenate([_hole_row(source) for source in sources.values()], axis=1))


def _lit_row(source: Ptm, result: Ptm) -> F32:
    """Put the source under one light beside the result under three, as the paper's figure 3 does."""
    framed = np.ones((TILE_PX, SOURCE_PX + 8, 3), np.float32)
    framed[:SOURCE_PX, :SOURCE_PX] = _under(source, LIGHTS[0])
    return np.concatenate([framed, *(_under(result, light) for light in LIGHTS)], axis=1)


def _hole_row(source: Ptm) -> F32:
    y, x = np.mgrid[:SOURCE_PX, :SOURCE_PX]
    hole = (np.hypot(y - 100, x - 80) < 45) | ((y > 160) & (x > 150))
    before = _under(source, LIGHTS[0]).copy()
    before[hole] = 0
    return np.concatenate([before, _under(fill([source], hole).material, LIGHTS[0])])


def _under(material: Ptm, light: Light) -> F32:
    return np.clip(relight(material, np.array(light)), 0, 1)


def _objects(tiles: dict[str, Ptm]) -> F32:
    """Show conventional textures, reflectance functions, and these with a highlight, as the paper's figure 2 does."""
    rows: list[list[F32]] = [[], [], []]
    view = View(pitch_deg=30, zoom=0.95)
    with Renderer() as renderer:
        for name, tile in tiles.items():
            mesh_name, repeat = MESHES[name]
            mesh = builtin_mesh(mesh_name)
            draw = (renderer, mesh, view, repeat)
            rows[0].append(_baked(*draw, tile))
            for row, highlight in ((1, None), (2, (0.35, 40.0))):
                rows[row].append(_draw(*draw, tile, highlight))
    return np.concatenate([np.concatenate(row, axis=1) for row in rows])


def _draw(
    renderer: Renderer, mesh: Mesh, view: View, repeat: int, ptm: Ptm, highlight: tuple[float, float] | None = None
) -> F32:
    size = (OBJECT_PX, OBJECT_PX)
    shading = PtmShading(shading_lights((LAMP,)), gloss=highlight)
    picture = ptm_mesh_picture(renderer, ptm, mesh, view, shading, size=size, supersample=3, repeat=repeat)
    return _over_background(picture[..., :3], picture[..., 3:])


def _baked(renderer: Renderer, mesh: Mesh, view: View, repeat: int, tile: Ptm) -> F32:
    """Draw what a photograph of the material under one light makes of it: the light baked in, dimmed by n·l."""
    size = (OBJECT_PX, OBJECT_PX)
    still = np.zeros((6, *tile.shape, 3), np.float32)
    still[5] = decode_srgb(_under(tile, LIGHTS[0]))
    texture = Ptm(still, None, "linear")
    picture = ptm_mesh_picture(
        renderer, texture, mesh, view, PtmShading(shading_lights((LAMP,))), size=size, supersample=3, repeat=repeat
    )
    frame = np.zeros((6, 2, 2, 3), np.float32)
    frame[3, ..., 0] = frame[4, ..., 1] = 0.5
    frame[5] = 0.5
    framed = Ptm(frame, None, "linear")
    inside = ptm_mesh_picture(
        renderer, framed, mesh, view, PtmShading(shading_lights((LAMP,))), size=size, supersample=3
    )
    u, v = 2 * inside[..., 0] - 1, 2 * inside[..., 1] - 1
    incidence = np.sqrt(np.clip(1 - u * u - v * v, 0, 1))
    # The photograph's own light stood at an angle, too; a texture of it is made as bright as it would be straight on.
    straight = float(np.sqrt(1 - np.sum(np.square(LIGHTS[0]))))
    return _over_background(picture[..., :3] * (incidence / straight)[..., None], picture[..., 3:])


def _over_background(light: F32, covered: F32) -> F32:
    shown = np.asarray(encode_srgb(np.clip(light, 0, 1)), np.float32)
    return shown * covered + BACKGROUND * (1 - covered)


def _save(path: Path, values: F32) -> None:
    cv2.imwrite(str(path), to_u8(values)[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 74])


if __name__ == "__main__":
    main()
