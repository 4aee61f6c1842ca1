"""Synthesis of 512² from 256² and 512², beside brute force, OpenCV's template matching, and the paper's own minutes.

All find the same blocks. What takes minutes is timed over some of its blocks and reckoned up, which is said.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache, partial
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from benchmarks.materials import fitted as capture_and_fit
from benchmarks.measure import Comparison, compare
from processing.ptm.model import Colour, Ptm
from processing.ptm.synthesis.grow import banned_near, grow
from processing.ptm.synthesis.layout import Edges, known_part, plain_layout
from processing.ptm.synthesis.search.problem import Rule, Target
from processing.ptm.synthesis.search.rejection import RejectionSearch
from processing.ptm.synthesis.settings import SearchKind, Synthesis
from processing.ptm.synthesis.synthesize import prepare, synthesize

F32 = NDArray[np.float32]
SIDE_PX, SOURCES_PX = 512, (256, 512)
PAPER = Synthesis(30, 6, chroma=0.0)
"""Blocks of 30 with an overlap of 6, luminance alone, as in the paper."""
PAPERS_S = (180, 300)
GOALS_S = {256: 1.0, 512: 2.5}
PROBES = 4
REJECTED_PX = 102


def comparisons(folder: Path) -> list[Comparison]:
    """Compare the strategies at both sizes of the source."""
    rows: list[Comparison] = []
    for side in SOURCES_PX:
        source = fitted("relief", side, folder)
        what = f"Synthesis of {SIDE_PX}² from {side}², 484 blocks of 30"
        ours = ("FFT", lambda: make(source, "fft"))  # noqa: B023
        goal = f"≤ {GOALS_S[side]:g} s"
        own = ("FFT, processor time of both cores", ours[1])
        rows.append(_beside(what, own, "its time on the clock", _timed(ours[1]), clock=time.process_time))
        for name, seconds in (
            ("rejection (SVD), its searches reckoned from some", _reckon(source, "svd")),
            ("brute force, reckoned from some blocks", _reckon(source, "brute")),
            ("cv2.matchTemplate, reckoned from some blocks", _template_matching(source)),
        ):
            rows.append(_beside(what, ours, name, seconds, goal))
        rows += [_beside(what, ours, f"the paper's {seconds} s of 2003", float(seconds)) for seconds in PAPERS_S]
    colour = fitted("relief", 256, folder)
    rgb = fitted("relief", 256, folder, "rgb")
    rows.append(
        compare(
            f"Synthesis of {SIDE_PX}² from 256², 484 blocks of 30",
            ("LRGB, colour compared too", lambda: synthesize([colour], (SIDE_PX, SIDE_PX), Synthesis())),
            ("RGB, 18 coefficients", lambda: synthesize([rgb], (SIDE_PX, SIDE_PX), Synthesis())),
            rounds=3,
        )
    )
    return rows


def rejections(folder: Path) -> str:
    """Tell how many neighbourhoods each kind of kernel rejects, beside the paper's 90 % and "around 3"."""
    lines = [
        "| source | kernels | after 1 | 2 | 3 | 8 | 16 | 32 projections | measured a block |",
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for name in ("relief", "fabric", "grains"):
        source = fitted(name, 256, folder)
        kinds: tuple[SearchKind, ...] = ("svd", "dct", "haar", "walsh")
        for kind in kinds:
            search = synthesize([source], (REJECTED_PX, REJECTED_PX), replace(PAPER, search=kind)).search
            assert isinstance(search, RejectionSearch)
            shares = " | ".join(f"{search.tally.rejected(count):.1%}" for count in (1, 2, 3, 8, 16, 32))
            lines.append(f"| {name}, 256² | {kind} | {shares} | {search.tally.measured / search.tally.searches:.0f} |")
    return "\n".join(lines)


@cache
def fitted(name: str, side_px: int, folder: Path, colour: Colour = "lrgb") -> Ptm:
    """Capture and fit each material once."""
    return capture_and_fit(name, side_px, folder, colour)


def make(source: Ptm, search: SearchKind) -> object:
    """Synthesise as the paper does."""
    return synthesize([source], (SIDE_PX, SIDE_PX), replace(PAPER, search=search))


def _beside(
    what: str,
    ours: tuple[str, Callable[[], object]],
    name: str,
    seconds: float,
    goal: str = "",
    clock: Callable[[], float] = time.perf_counter,
) -> Comparison:
    """Compare with a time that is known or was reckoned."""
    ours[1]()
    times = [_timed(ours[1], clock) for _ in range(5)]
    ratios = [one / seconds for one in times]
    middle = float(np.median(times))
    return Comparison(what, ours[0], name, middle / seconds, (min(ratios), max(ratios)), middle, goal)


def _timed(action: Callable[[], object], clock: Callable[[], float] = time.perf_counter) -> float:
    start = clock()
    action()
    return clock() - start


def _targets(source: Ptm) -> list[Target]:
    """Places as they come up in the middle of a synthesis, with left and upper neighbours."""
    parts, _ = prepare([source], ["source"], PAPER)
    layout = plain_layout(54, 30 + 24 * PROBES, 30, 6)
    canvas = grow(parts, layout, PAPER)
    known = known_part(Edges(left=6, top=6), 30)
    nothing = np.zeros((30, 30, 0), np.float32)
    targets = []
    for index in range(1, PROBES + 1):
        place = canvas.window(24, 24 * index, 30)
        banned = banned_near(canvas, parts.candidates, 24, 24 * index, PAPER)
        targets.append(Target(canvas.values[place][..., : parts.compared], known, nothing, banned))
    return targets


def _reckon(source: Ptm, search: SearchKind) -> float:
    """Time some searches and reckon what 483 take."""
    targets = _targets(source)
    parts, _ = prepare([source], ["source"], replace(PAPER, search=search))
    fast, _ = prepare([source], ["source"], PAPER)
    for target in targets:  # warm, and right
        assert np.array_equal(parts.search.matches(target, parts.rule), fast.search.matches(target, fast.rule))
    return _seconds(lambda target: parts.search.matches(target, parts.rule), targets) * 483


def _template_matching(source: Ptm) -> float:
    """Time OpenCV's masked squared differences, plane by plane, since it takes no more than four at once."""
    targets = _targets(source)
    parts, textures = prepare([source], ["source"], PAPER)
    planes = [np.ascontiguousarray(textures.planes[0][..., k]) for k in range(parts.compared)]

    def match(target: Target) -> F32:
        mask = target.known.astype(np.float32)
        total = np.zeros((planes[0].shape[0] - 29, planes[0].shape[1] - 29), np.float32)
        for k, plane in enumerate(planes):
            total += cv2.matchTemplate(plane, np.ascontiguousarray(target.values[..., k]), cv2.TM_SQDIFF, mask=mask)
        return total

    for target in targets:
        nearest = parts.search.matches(replace(target, banned=np.zeros(0, np.int64)), Rule(0.0, 0.0))
        assert int(match(target).argmin()) in nearest
    return _seconds(match, targets) * 483


def _seconds(action: Callable[[Target], object], targets: Sequence[Target]) -> float:
    return float(np.median([_timed(partial(action, target)) for target in targets]))
