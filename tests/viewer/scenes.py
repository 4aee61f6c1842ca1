"""Meshes, and a pair of tables with and without a key light, for pictures that are compared."""

import dataclasses

import numpy as np

from processing.amc.model import Amc
from processing.mesh.builtin import cloth, ribbon, torus
from processing.mesh.model import Mesh
from tests.viewer.analytic import brushed_amc, disc_normals

SIZE = (180, 150)
MESHES = {"torus": torus(96, 48), "cloth": cloth(120), "ribbon": ribbon(200, 12)}
KEY = (-0.85, 0.35)


def with_occlusion(mesh: Mesh) -> Mesh:
    """A mesh that is darker the lower and the farther inside a vertex is: any numbers do, as long as they vary."""
    height = mesh.positions[:, 1] - mesh.positions[:, 1].min()
    occlusion = np.clip(0.15 + 0.85 * height / height.max() * np.linalg.norm(mesh.positions, axis=1), 0, 1)
    return dataclasses.replace(mesh, occlusion=occlusion.astype(np.float32))


def without_key(lit: Amc) -> Amc:
    """The same material with its key light off: what a broad light from KEY gave is gone, the rest is bluish."""
    towards = np.array([*KEY, np.sqrt(1 - np.square(KEY).sum())])
    normals, _ = disc_normals(lit.slices.shape[1])
    given = np.clip(normals @ towards, 0, 1)[None, ..., None]
    rest = lit.slices * (1 - 0.9 * np.sqrt(given)) * np.array([0.45, 0.6, 0.8])
    return dataclasses.replace(lit, slices=rest.astype(np.float32))


def split_in_two(amc: Amc) -> tuple[Amc, Amc]:
    """Two tables whose light is that of one, roughly as diffuse light and gloss."""
    low = np.minimum(amc.slices, amc.slices.mean(axis=0, keepdims=True) * 0.6)
    return dataclasses.replace(amc, slices=low), dataclasses.replace(amc, slices=amc.slices - low)


def lit_and_unlit(size: int = 32, depth: int = 30) -> tuple[Amc, Amc]:
    lit = brushed_amc(size, depth)
    return lit, without_key(lit)
