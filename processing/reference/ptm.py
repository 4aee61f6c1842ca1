"""The picture of a PTM on a mesh, in plain NumPy and double precision: what shaders are tested against."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.radiometry import decode_srgb
from processing.mesh.model import Mesh
from processing.ptm.model import Ptm
from processing.ptm.relighting.brightest import brightest_light
from processing.ptm.relighting.lights import Lights
from processing.ptm.relighting.normals import normals_of
from processing.reference.camera import Camera
from processing.reference.surface import Surface, in_view, unit, visible_surface
from processing.reference.texels import bilinear

F64 = NDArray[np.float64]


def render_ptm(
    ptm: Ptm,
    mesh: Mesh,
    camera: Camera,
    size: tuple[int, int],
    lights: Lights,
    *,
    diffuse_gain: float = 1.0,
    gloss: tuple[float, float] | None = None,
    occluded: bool = False,
) -> F64:
    """Draw a mesh with a PTM laid on it by its texture coordinates, read at full size.

    At every point the lights are brought into the frame of tangent, bitangent and normal, in which the picture was
    taken. Coefficients, normals and brightest lights are interpolated between texels before anything is made of them.

    Parameters
    ----------
    size : width and height in pixels
    lights : view frame; they cast no shadows, but reach no surface that faces away from them
    diffuse_gain : g of f(l₀) + ∇f(l₀)·(l − l₀) + g·½(l − l₀)ᵀH(l − l₀), l₀ each texel's brightest light
    gloss : strength and exponent of a Blinn–Phong lobe, added to the values in the PTM's own space
    occluded : darken by the mesh's ambient occlusion

    Returns
    -------
    picture : (H, W, 4) float64, linear light and coverage 0 or 1; row 0 on top
    """
    surface = visible_surface(mesh, camera, size)
    columns, rows = _places(mesh, surface)
    frames = _frames(mesh, camera, surface)
    coefficients = np.stack([bilinear(plane, columns, rows) for plane in ptm.coefficients])
    colour = None if ptm.colour is None else bilinear(ptm.colour, columns, rows)
    brightest = normals = None
    if diffuse_gain != 1:
        brightest = bilinear(brightest_light(ptm.coefficients.mean(axis=-1)), columns, rows)
    if gloss is not None:
        normals = unit(bilinear(normals_of(ptm), columns, rows))
    to_eye = np.einsum("nij,nj->ni", frames, surface.to_eye)
    light = np.zeros((len(columns), 3))
    for direction, light_colour in zip(lights.directions, lights.colours, strict=True):
        towards = frames @ direction
        values = _values(ptm, coefficients, towards)
        if brightest is not None:
            away = towards[:, :2] - brightest
            values += (diffuse_gain - 1) * _half_bend(coefficients, away)
        values = values if colour is None else values * colour
        if gloss is not None and normals is not None:
            half = unit(towards + to_eye)
            values += gloss[0] * np.maximum(np.sum(normals * half, axis=1), 0)[:, None] ** gloss[1]
        values = np.maximum(values, 0)
        linear = decode_srgb(values).astype(np.float64) if ptm.space == "srgb" else values
        light += np.where(towards[:, 2:] > 0, linear * light_colour, 0)
    return surface.picture(light * surface.openness[:, None] if occluded else light)


def render_ptm_normals(ptm: Ptm, mesh: Mesh, camera: Camera, size: tuple[int, int]) -> F64:
    """Draw the normals of a PTM on a mesh, view frame: linear light that a display shows as ½ + ½n; as `render_ptm`."""
    surface = visible_surface(mesh, camera, size)
    normals = unit(bilinear(normals_of(ptm), *_places(mesh, surface)))
    turned = np.einsum("nij,ni->nj", _frames(mesh, camera, surface), normals)
    return surface.picture(decode_srgb(0.5 + 0.5 * turned).astype(np.float64))


def _places(mesh: Mesh, surface: Surface) -> tuple[F64, F64]:
    uvs = surface.seen.interpolate(mesh.uvs.astype(np.float64), mesh.triangles)
    return uvs[:, 0], 1 - uvs[:, 1]


def _frames(mesh: Mesh, camera: Camera, surface: Surface) -> F64:
    """Return tangent, bitangent and normal in rows, (N, 3, 3). Seen from behind, the picture is mirrored."""
    outside = surface.seen.interpolate(in_view(mesh.normals, camera), mesh.triangles)
    sides = np.where(np.sum(outside * surface.normals, axis=1) > 0, 1.0, -1.0)
    across = np.cross(surface.normals, surface.tangents) * sides[:, None]
    return np.stack([surface.tangents, across, surface.normals], axis=1)


def _values(ptm: Ptm, coefficients: F64, towards: F64) -> F64:
    """Evaluate (T, N, C) at a light of its own for each point (N, 3)."""
    values: F64 = np.einsum("nt,tnc->nc", ptm.basis.evaluate(towards), coefficients)
    return values


def _half_bend(coefficients: F64, away: F64) -> F64:
    """Return ½ aᵀHa, (N, C), of polynomials (6, N, C) at a distance (N, 2)."""
    u, v = away[:, :1], away[:, 1:]
    bend: F64 = coefficients[0] * u * u + coefficients[1] * v * v + coefficients[2] * u * v
    return bend


def area_average(picture: NDArray[np.floating], size: tuple[int, int]) -> F64:
    """Shrink linear light (H, W, C) to `size`, width and height: each pixel is the mean of the area that it covers."""
    average: F64 = np.einsum(
        "yh,xw,hwc->yxc", _coverage(picture.shape[0], size[1]), _coverage(picture.shape[1], size[0]), picture
    )
    return average


def _coverage(texels: int, pixels: int) -> F64:
    """Return the share of each texel in each pixel, (pixels, texels)."""
    edges = np.arange(pixels + 1) * texels / pixels
    low = np.maximum(edges[:-1, None], np.arange(texels))
    high = np.minimum(edges[1:, None], np.arange(texels) + 1)
    return np.asarray(np.maximum(high - low, 0) * pixels / texels, np.float64)
