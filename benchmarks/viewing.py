"""Drawing an AMC beside the same mesh with a plain MatCap, on whatever rasteriser there is."""

import numpy as np

from benchmarks.measure import Comparison, compare
from processing.amc.mips import mip_chain
from processing.amc.model import Amc, Invariance
from processing.mesh.builtin import builtin_mesh
from viewer.materials.amc import amc_picture
from viewer.renderer import Renderer
from viewer.view import View


def comparisons() -> list[Comparison]:
    """Compare one picture of each, the upload of table and mesh included."""
    anisotropic, isotropic = _amc(64, 2), _amc(1, "isotropic")
    mesh, view, size = builtin_mesh("torus"), View(yaw_deg=20, pitch_deg=35), (512, 512)
    levels, plain = mip_chain(anisotropic), mip_chain(isotropic)
    with Renderer() as renderer:
        picture = amc_picture(renderer, anisotropic, mesh, view, size=size, levels=levels)
        if not 0.1 < float(picture[..., 3].mean()) < 0.9:
            raise AssertionError("the torus is not in the picture")
        return [
            compare(
                f"Picture of 512² of a torus of {len(mesh.triangles)} triangles",
                ("AMC of 128² × 64", lambda: amc_picture(renderer, anisotropic, mesh, view, size=size, levels=levels)),
                (
                    "isotropic MatCap",
                    lambda: amc_picture(renderer, isotropic, mesh, view, size=size, levels=plain),
                ),
            )
        ]


def _amc(depth: int, invariance: Invariance) -> Amc:
    across = (2 * np.arange(128) + 1) / 128 - 1
    angle = np.arange(depth)[:, None, None] * np.pi / depth
    streak = np.exp(-((across * np.cos(angle) + across[:, None] * np.sin(angle)) ** 2) / 0.05)
    slices = np.repeat(streak[..., None], 3, -1).astype(np.float32)
    return Amc(slices, np.ones(slices.shape[:3], np.bool_), invariance)
