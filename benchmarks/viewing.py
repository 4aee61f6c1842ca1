"""Drawing an AMC beside the same mesh with a plain MatCap, on whatever rasteriser there is."""

import time
from collections.abc import Callable
from contextlib import ExitStack

import numpy as np

from benchmarks.measure import Comparison, compare
from processing.amc.isotropic import isotropic_matcap
from processing.amc.low_rank import compress, error_curve
from processing.amc.mips import MipLevel, mip_chain
from processing.amc.model import Amc, Invariance
from processing.mesh.builtin import torus
from processing.mesh.model import Mesh
from viewer.geometry import mesh_geometry
from viewer.look import Look
from viewer.materials.amc import AmcMaterial, amc_picture
from viewer.materials.low_rank import LowRankMaterial
from viewer.materials.matcap import MatcapMaterial
from viewer.renderer import Renderer
from viewer.targets import Target
from viewer.view import View

SIZE = (512, 512)
FRAMES = 8
"""A round, each in another view: one alone is soon over."""
RANKS = (4, 8, 12)
FINE, COARSE = torus(), torus(64, 32)


def comparisons() -> list[Comparison]:
    """Compare frames by the time of the processor, uploads left out, and one picture with all that it takes."""
    anisotropic, isotropic = _amc(64, 2), _amc(1, "isotropic")
    with Renderer() as renderer:
        return [
            _whole_picture(renderer, anisotropic, isotropic),
            *(_frames(renderer, anisotropic, mesh) for mesh in (FINE, COARSE)),
            *(_low_rank(renderer, anisotropic, rank) for rank in RANKS),
        ]


def _whole_picture(renderer: Renderer, anisotropic: Amc, isotropic: Amc) -> Comparison:
    view, levels, plain = View(yaw_deg=20, pitch_deg=35), mip_chain(anisotropic), mip_chain(isotropic)

    def draw(amc: Amc, chain: list[MipLevel]) -> Callable[[], np.ndarray]:
        return lambda: amc_picture(renderer, amc, FINE, view, size=SIZE, levels=chain)

    _check(draw(anisotropic, levels)())
    return compare(
        f"Picture of 512² of a torus of {len(FINE.triangles)} triangles, upload and reading included",
        ("AMC of 128² × 64", draw(anisotropic, levels)),
        ("isotropic AMC", draw(isotropic, plain)),
    )


def _frames(renderer: Renderer, amc: Amc, mesh: Mesh) -> Comparison:
    with ExitStack() as held:
        table = held.enter_context(renderer.upload(AmcMaterial, amc))
        disc = held.enter_context(renderer.upload(MatcapMaterial, isotropic_matcap(amc)))
        return compare(
            f"{FRAMES} frames of 512² of a torus of {len(mesh.triangles)} triangles, CPU time",
            ("AMC of 128² × 64", drawing(held, renderer, table.look(), mesh)),
            ("plain MatCap of 128²", drawing(held, renderer, disc.look(), mesh)),
            goal="≤ 2",
            clock=time.process_time,
        )


def _low_rank(renderer: Renderer, amc: Amc, rank: int) -> Comparison:
    cost = error_curve(amc, [rank])[0]
    memory = cost.stored_bytes / (4 * amc.slices[..., :1].size * 2)  # a volume has four halves a texel
    with ExitStack() as held:
        table = held.enter_context(renderer.upload(AmcMaterial, amc))
        pictures = held.enter_context(renderer.upload(LowRankMaterial, compress(amc, rank)))
        return compare(
            f"The same from {rank} basis pictures: {100 * memory:.0f} % of the memory, {cost.psnr_db:.0f} dB, CPU time",
            (f"low rank {rank}", drawing(held, renderer, pictures.look(), FINE)),
            ("AMC of 128² × 64", drawing(held, renderer, table.look(), FINE)),
            clock=time.process_time,
        )


def drawing(held: ExitStack, renderer: Renderer, look: Look, mesh: Mesh) -> Callable[[], None]:
    geometry = held.enter_context(renderer.upload(mesh_geometry, mesh))
    target = held.enter_context(renderer.upload(Target, SIZE))

    def draw() -> None:
        for number in range(FRAMES):
            renderer.draw(look, geometry, target, View(yaw_deg=20 + number, pitch_deg=35))
        renderer.finish()

    draw()
    _check(target.read())
    return draw


def _check(picture: np.ndarray) -> None:
    if not (0.1 < float(picture[..., 3].mean()) < 0.9 and float(picture[..., :3].std()) > 0.05):
        raise AssertionError("the torus is not in the picture")


def _amc(depth: int, invariance: Invariance) -> Amc:
    across = (2 * np.arange(128) + 1) / 128 - 1
    angle = np.arange(depth)[:, None, None] * np.pi / depth
    streak = np.exp(-((across * np.cos(angle) + across[:, None] * np.sin(angle)) ** 2) / 0.05)
    slices = np.repeat(streak[..., None], 3, -1).astype(np.float32)
    return Amc(slices, np.ones(slices.shape[:3], np.bool_), invariance)
