"""Decomposed MatCaps: drawing beside a plain MatCap, and what it takes to make a material rougher or shinier."""

import dataclasses
import time
from collections.abc import Callable
from contextlib import ExitStack

import numpy as np

from benchmarks.measure import Comparison, compare
from benchmarks.viewing import FINE, FRAMES, drawing
from processing.matcap.model import Component, DecomposedMatcap
from processing.matcap.recipe.material import with_filter_size
from processing.matcap.render import disc_picture
from processing.matcap.variation import NONE, Variation
from processing.paraboloid.maps import texel_directions
from viewer.materials.decomposed_matcap import DecomposedMatcapMaterial
from viewer.materials.matcap import MatcapMaterial
from viewer.renderer import Renderer

SIZE = 256


def comparisons() -> list[Comparison]:
    """Compare frames by the time of the processor, and edits by the clock."""
    whole = decomposed(SIZE)
    patches = np.random.default_rng(1).random((64, 64, 3), np.float32)
    everything = Variation(patches, patches, patches[..., 0], (0.0, 0.3), patches[..., 1])
    with Renderer() as renderer:
        rows = [_frames(renderer, whole, NONE, "alone"), _frames(renderer, whole, everything, "with every texture")]
    return [*rows, *_roughness(whole.high)]


def decomposed(size: int) -> DecomposedMatcap:
    """Make maps of a few lobes of light."""

    def component(sharpness: float, slope: float, filter_size: float) -> Component:
        front, back = (
            sum(
                np.exp(sharpness * (side @ (np.array(at) / np.linalg.norm(at)) - 1))[..., None] * np.array(colour)
                for at, colour in (((-0.5, 0.6, 0.6), (1, 0.9, 0.8)), ((0.7, 0.3, -0.6), (0.3, 0.5, 1)))
            ).astype(np.float32)
            for side in texel_directions(size)
        )
        return Component(front, back, (0.7, 0.6, 0.5), slope, filter_size)

    return DecomposedMatcap(component(2, 0.4, 0.4), component(80, 0.95, 0.02))


def _frames(renderer: Renderer, matcap: DecomposedMatcap, variation: Variation, how: str) -> Comparison:
    with ExitStack() as held:
        ours = held.enter_context(renderer.upload(DecomposedMatcapMaterial, matcap, variation))
        plain = held.enter_context(renderer.upload(MatcapMaterial, disc_picture(matcap, SIZE)))
        return compare(
            f"{FRAMES} frames of 512² of a torus of {len(FINE.triangles)} triangles, CPU time",
            (f"decomposed MatCap of {SIZE}², {how}", drawing(held, renderer, ours.look(), FINE)),
            (f"plain MatCap of {SIZE}²", drawing(held, renderer, plain.look(), FINE)),
            clock=time.process_time,
        )


def _roughness(component: Component) -> list[Comparison]:
    fine = dataclasses.replace(component, filter_size=0.02)

    def to(filter_size: float) -> tuple[str, Callable[[], object]]:
        return f"ν .02 to {filter_size:g}, maps of {SIZE}²", lambda: with_filter_size(fine, filter_size)

    slight = to(0.025)
    return [
        compare("Roughness: a large blur costs no more than a small one", to(0.6), slight, goal="≤ 2"),
        compare("Roughness taken back", to(0.01), slight, rounds=3),
    ]
