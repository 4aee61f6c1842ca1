"""The picture of a decomposed MatCap, in plain NumPy and double precision: what shaders are tested against."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.table_normals import TableNormal, table_normals
from processing.matcap.model import DecomposedMatcap
from processing.matcap.render import shaded
from processing.mesh.model import Mesh
from processing.reference.camera import Camera
from processing.reference.surface import unit, visible_surface

F64 = NDArray[np.float64]


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
    light = shaded(matcap, normals)
    return surface.picture(light * surface.openness[:, None] if occluded else light)


def seen_normals(normals: F64, to_eye: F64, kind: TableNormal) -> F64:
    """Bring normals (N, 3) to the view axis; what then still looks away is taken to the rim."""
    turned = table_normals(normals, to_eye, kind).astype(np.float64)
    on_rim = turned * np.array([1.0, 1.0, 0.0])
    return np.where(turned[:, 2:] < 0, unit(on_rim), turned)
