"""The picture of a decomposed MatCap, in plain NumPy and double precision: what shaders are tested against."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.table_normals import TableNormal, table_normals
from processing.matcap.model import Component, DecomposedMatcap
from processing.mesh.model import Mesh
from processing.paraboloid.maps import places
from processing.reference.camera import Camera
from processing.reference.surface import unit, visible_surface
from processing.reference.texels import bilinear

F64 = NDArray[np.float64]
_VIEW_AXIS = np.array([0.0, 0.0, 1.0])


def render_decomposed(
    matcap: DecomposedMatcap, mesh: Mesh, camera: Camera, size: tuple[int, int], *, occluded: bool = False
) -> F64:
    """Draw a mesh with a decomposed MatCap, its maps read at full size (the MatCap paper, section 5).

    Parameters
    ----------
    size : width and height in pixels
    occluded : darken by the mesh's ambient occlusion

    Returns
    -------
    picture : (H, W, 4) float64, linear light and coverage 0 or 1; row 0 on top
    """
    surface = visible_surface(mesh, camera, size)
    normals = seen_normals(surface.normals, surface.to_eye, matcap.table_normal)
    light = shaded(matcap.low, normals) + shaded(matcap.high, normals)
    return surface.picture(light * surface.openness[:, None] if occluded else light)


def seen_normals(normals: F64, to_eye: F64, kind: TableNormal) -> F64:
    """Bring normals (N, 3) to the view axis; what then still looks away is taken to the rim."""
    turned = table_normals(normals, to_eye, kind).astype(np.float64)
    on_rim = turned * np.array([1.0, 1.0, 0.0])
    return np.where(turned[:, 2:] < 0, unit(on_rim), turned)


def shaded(component: Component, normals: F64) -> F64:
    """Look unit normals (N, 3) up: ω = rot(u, μθ) n about u = e₂ × n/|e₂ × n|, times the base colour."""
    axes = np.cross(_VIEW_AXIS, normals)
    length = np.linalg.norm(axes, axis=1, keepdims=True)
    # Along the view axis any u will do: θ is 0 there.
    axes = np.where(length > 0, axes / np.where(length > 0, length, 1), [1.0, 0.0, 0.0])
    angles = component.slope * np.arccos(np.clip(normals @ _VIEW_AXIS, -1, 1))[:, None]
    omega = normals * np.cos(angles) + np.cross(axes, normals) * np.sin(angles)  # Rodrigues; u is orthogonal to n
    light: F64 = lookup(component.front, component.back, omega) * np.asarray(component.base_colour)
    return light


def lookup(front: NDArray[np.floating], back: NDArray[np.floating], directions: F64) -> F64:
    """Read a dual paraboloid map (S, S, 3) each at unit directions (N, 3), bilinearly."""
    in_front, columns, rows = places(directions)
    return np.where(in_front[:, None], bilinear(front, columns, rows), bilinear(back, columns, rows))
