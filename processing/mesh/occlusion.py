"""Ambient occlusion at the vertices by casting rays (the AMC paper, section 6.1, figure 7)."""

import math

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError, MissingToolError
from processing.mesh.model import Mesh
from processing.mesh.rows import unique_rows

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

RAYS = 256
"""From each vertex; by so many steps openness is told."""
_LIFT = 1e-4
"""By so much a ray starts above the surface, in radii of the mesh, so that it does not hit where it comes from."""
_RAYS_AT_ONCE = 1 << 21
_GOLDEN = (math.sqrt(5) - 1) / 2


def ambient_occlusion(mesh: Mesh, *, rays: int = RAYS, reach: float = math.inf) -> F32:
    """Return how open the surface is at each vertex: 1 = open, 0 = closed.

    It is the share of the cosine-weighted half space over the vertex, on the side of its normal, from which nothing of
    the mesh keeps the light: A = 1/π ∫ V(ω) (n·ω) dω. The directions are the same everywhere but for the turn that
    takes their pole to the normal, so that the same mesh gives the same numbers, and neighbours differ little.

    Parameters
    ----------
    rays : directions for each vertex, spread by the sunflower's spiral over the disc below the half sphere, which
        weighs them by the cosine
    reach : what is farther away does not count, in radii of the mesh

    Returns
    -------
    occlusion : (V,) float32

    Raises
    ------
    InputError
        The number of rays or the reach is none.
    MissingToolError
        The ray caster is not there for this kind of computer.
    """
    if rays < 1 or not reach > 0:
        raise InputError(f"mesh: {rays} rays of reach {reach:g} tell nothing; give at least one, of a length")
    casts = _Caster(mesh)
    # Where vertices differ in their texture coordinates alone they see the same.
    different, numbers = unique_rows(np.concatenate([mesh.positions, mesh.normals], axis=1))
    directions = cosine_directions(rays).astype(np.float32)
    openness = np.zeros(len(different), np.float32)
    step = max(1, _RAYS_AT_ONCE // rays)
    for start in range(0, len(different), step):
        some = different[start : start + step]
        frames = frames_about(some[:, 3:]).astype(np.float32)
        along = (directions @ frames.transpose(0, 2, 1)).reshape(-1, 3)
        origins = np.repeat((some[:, :3] + some[:, 3:] * _LIFT).astype(np.float32), rays, axis=0)
        hidden = casts(origins, along, reach).reshape(-1, rays)
        openness[start : start + step] = 1 - hidden.mean(axis=1)
    return openness[numbers]


def cosine_directions(count: int) -> F64:
    """Return unit vectors (count, 3) about z, as many to a solid angle as the cosine there: Malley's method."""
    number = np.arange(count)
    radius = np.sqrt((number + 0.5) / count)
    turn = number * (math.tau * _GOLDEN)
    return np.stack([radius * np.cos(turn), radius * np.sin(turn), np.sqrt(1 - radius**2)], axis=1)


def frames_about(normals: F64) -> F64:
    """Return rotations (V, 3, 3) that take z to unit normals (V, 3), smooth in the normal on either side of z = 0."""
    up = np.where(normals[:, 2] < 0, -1.0, 1.0)
    x, y, z = normals.T
    share = -1 / (up + z)
    across = x * y * share
    first = np.stack([1 + up * x * x * share, up * across, -up * x], axis=1)
    second = np.stack([across, up + y * y * share, -y], axis=1)
    return np.stack([first, second, normals], axis=2)


class _Caster:
    """Tells which rays hit a mesh, by Embree."""

    def __init__(self, mesh: Mesh) -> None:
        try:
            from embreex.mesh_construction import TriangleMesh
            from embreex.rtcore_scene import EmbreeScene
        except ImportError as error:
            raise MissingToolError(
                f"ambient occlusion needs the library embreex, which is not here ({error}); "
                "pip install embreex, or leave it out"
            ) from error
        self._scene = EmbreeScene()
        self._triangles = TriangleMesh(self._scene, mesh.positions[mesh.triangles].astype(np.float32))

    def __call__(self, origins: F32, directions: F32, reach: float) -> NDArray[np.bool_]:
        """Tell for each ray (R,) whether it hits anything within its reach."""
        reaches = np.full(len(origins), min(reach, 1e30), np.float32)
        hits: NDArray[np.bool_] = np.asarray(self._scene.run(origins, directions, dists=reaches, query="OCCLUDED")) >= 0
        return hits
