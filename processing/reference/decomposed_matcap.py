"""The picture of a decomposed MatCap, in plain NumPy and double precision: what shaders are tested against."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from litrig.base.table_normals import TableNormal, table_normals
from processing.matcap.filter import slope_of
from processing.matcap.lights.bake import baked
from processing.matcap.model import Component, DecomposedMatcap
from processing.matcap.render import component_light, energy, seen
from processing.matcap.variation import NONE, Variation
from processing.mesh.model import Mesh
from processing.paraboloid.chain import blur_chain, chain_side, level_of
from processing.paraboloid.read import lookup
from processing.reference.camera import Camera
from processing.reference.surface import unit, visible_surface
from processing.reference.texels import bilinear

F64 = NDArray[np.float64]


def render_decomposed(
    matcap: DecomposedMatcap,
    mesh: Mesh,
    camera: Camera,
    size: tuple[int, int],
    *,
    occluded: bool = False,
    occlusion: tuple[float, float] = (1.0, 1.0),
    variation: Variation = NONE,
    others: Sequence[DecomposedMatcap] = (),
) -> F64:
    """Draw a mesh with a decomposed MatCap, its maps read at full size (the MatCap paper, section 5).

    Parameters
    ----------
    size : width and height in pixels
    occluded : darken by the mesh's ambient occlusion; the variation's darkens anyhow
    occlusion : how much both do so to the low and the high frequencies, 0 to 1
    variation : what varies over the surface
    others : drawn where the variation's materials are 1, 2 and so on

    Returns
    -------
    picture : (H, W, 4) float64, linear light and coverage 0 or 1; row 0 on top
    """
    surface = visible_surface(mesh, camera, size)
    uvs = surface.seen.interpolate(mesh.uvs.astype(np.float64), mesh.triangles)
    openness = (surface.openness if occluded else np.ones(len(uvs))) * _laid(variation.openness, uvs)[:, 0]
    materials = np.zeros(len(uvs)) if variation.materials is None else _nearest(variation.materials, uvs)
    low_share, high_share = occlusion
    light, covered = np.zeros((len(uvs), 3)), np.zeros(len(uvs), bool)
    for number, one in enumerate((matcap, *others)):
        here = materials == number
        covered |= here
        normals = seen_normals(surface.normals[here], surface.to_eye[here], one.table_normal)
        rough = np.zeros(len(normals))
        if variation.roughness is not None:
            rough = _laid(variation.roughness, uvs[here])[:, 0]
        halves = (
            (one.low, variation.low_colours, variation.roughest[0], low_share),
            (one.high, variation.high_colours, variation.roughest[1], high_share),
        )
        for component, colours, roughest, share in halves:
            more = rough * max(roughest - component.filter_size, 0)
            given = _rough_light(component, normals, more) * _laid(colours, uvs[here])
            light[here] += given * (1 - share + share * openness[here, None])
    picture = surface.picture(light)
    picture[surface.seen.rows[~covered], surface.seen.columns[~covered]] = 0
    return picture


def seen_normals(normals: F64, to_eye: F64, kind: TableNormal) -> F64:
    """Bring normals (N, 3) to the view axis; what then still looks away is taken to the rim."""
    turned = table_normals(normals, to_eye, kind).astype(np.float64)
    on_rim = turned * np.array([1.0, 1.0, 0.0])
    return np.where(turned[:, 2:] < 0, unit(on_rim), turned)


def _rough_light(component: Component, normals: F64, more: F64) -> F64:
    """Return the light (N, 3) of a material whose filter size is larger by `more` (N,) from normal to normal."""
    if not np.any(more):
        return component_light(component, normals)
    whole = baked(component)
    blurs = blur_chain(whole.front, whole.back, float(np.max(more)))
    levels = [(whole.front, whole.back), *((pair[0], pair[1]) for pair in blurs)]
    places = np.minimum(level_of(more, chain_side(whole.front.shape[0])), len(levels) - 1)
    light = np.zeros((len(normals), 3))
    directions = seen(whole, normals, np.array([_rougher_slope(whole, one) for one in more]))
    for number, (front, back) in enumerate(levels):
        share = np.clip(1 - np.abs(places - number), 0, 1)
        used = share > 0
        light[used] += share[used, None] * lookup(front, back, directions[used])
    return light * energy(whole, normals)


def _rougher_slope(component: Component, more: float) -> float:
    changed = component.slope + slope_of(component.filter_size + more) - slope_of(component.filter_size)
    return min(max(changed, 0.0), 1.0)


def _laid(plane: NDArray[np.floating] | None, uvs: F64) -> F64:
    """Read a picture that repeats at texture coordinates (N, 2): (N, C), or (N, 1) ones where there is none."""
    if plane is None:
        return np.ones((len(uvs), 1))
    height, width = plane.shape[:2]
    whole = np.pad(plane.reshape(height, width, -1), ((1, 1), (1, 1), (0, 0)), mode="wrap")
    columns, rows = (uvs[:, 0] % 1 * width + 1) / (width + 2), ((1 - uvs[:, 1]) % 1 * height + 1) / (height + 2)
    return bilinear(whole, columns, rows)


def _nearest(plane: NDArray[np.floating], uvs: F64) -> NDArray[np.floating]:
    height, width = plane.shape
    columns, rows = (uvs[:, 0] % 1 * width).astype(int), ((1 - uvs[:, 1]) % 1 * height).astype(int)
    return np.asarray(plane[np.minimum(rows, height - 1), np.minimum(columns, width - 1)])
