"""Which scenes are rendered, by what, and what their pictures depend on."""

import functools
import hashlib
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path

from firmware_sim.mitsuba.config import MitsubaScene
from firmware_sim.scene.coarse import SCALAR_ECONOMY
from firmware_sim.scene.frame_cache import LIMIT_BYTES, FrameCache, file_bytes
from firmware_sim.scene.pose import Size
from firmware_sim.scene.relevance import Relevance

EVERYTHING = Relevance(turntable=True, arm=True)
SAME_FROM_ALL_SIDES = ("chrome-ball", "white-card")


def relevance_of(scene: object) -> Relevance:
    """Return what the pictures of a scene depend on."""
    if not isinstance(scene, MitsubaScene):
        return EVERYTHING
    return Relevance(turntable=scene.sample not in SAME_FROM_ALL_SIDES, arm=scene.lights != "studio")


def frame_cache(scene: MitsubaScene, variant: str, root: Path) -> FrameCache:
    """Return where the pictures of a scene are kept.

    Parameters
    ----------
    scene : what is rendered
    variant : of mitsuba; each has its own noise
    root : folder of all scenes' pictures
    """
    renderer = f"mitsuba {version('mitsuba')} {variant} {_sources_digest()}"
    return FrameCache(root, scene.model_dump_json(), renderer)


@functools.cache
def _sources_digest() -> str:
    """Return a digest of the code that describes scenes to mitsuba: another one makes other pictures."""
    digest = hashlib.sha256()
    for path in sorted(files("firmware_sim.mitsuba").iterdir(), key=lambda path: path.name):
        if path.name.endswith(".py"):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def is_slow(variant: str) -> bool:
    """Tell whether a variant interprets its scenes, which takes many times longer than compiling them."""
    return variant.startswith("scalar")


def note_on(variant: str) -> str:
    """Return what a person should know about a variant, if anything."""
    if not is_slow(variant):
        return ""
    shrink, most_samples = SCALAR_ECONOMY
    return (
        f"mitsuba renders with {variant}, which is slow: one pixel for {shrink} × {shrink} and at most {most_samples} "
        "paths a pixel; apt-get install libllvm19 gives whole pictures"
    )


def room_for(size: Size) -> int:
    """Return how many pictures of a plan may be rendered ahead; of more, the first would be dropped before use."""
    return LIMIT_BYTES * 4 // 5 // file_bytes(size)
