"""How good a result is, in figures: seams, statistics under lights, and what is merely copied."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from litrig.base.directions import direction_from_angles
from processing.ptm.model import Ptm
from processing.ptm.relighting.relight import relight
from processing.ptm.synthesis.canvas import Canvas
from processing.ptm.synthesis.search.rejection import RejectionSearch
from processing.ptm.synthesis.synthesize import Synthesised

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

HELD_OUT = np.array([direction_from_angles(22.5 + 45 * i, (35, 60)[i % 2]) for i in range(8)])
"""Eight lights all round, at two heights, by which results and sources are compared."""


@dataclass(frozen=True)
class Quality:
    """Figures of a result.

    Attributes
    ----------
    seam_energy : squared difference of pixels beside each other across seams, by that of all other such pairs
    wrap_percentile : of the difference across the ends, among those across inner columns and inner rows, the worse of
        both; low is good
    brightness_off, contrast_off : largest relative difference of mean and standard deviation to the sources', over
        `HELD_OUT`
    copied : share of the result in pieces of a source that are larger than a block
    largest_copy_px : pixels in the largest such piece
    rejected : share of neighbourhoods left out after 1, 2, 3 … projections, where the search rejects
    """

    seam_energy: float
    wrap_percentile: float
    brightness_off: float
    contrast_off: float
    copied: float
    largest_copy_px: int
    rejected: tuple[float, ...]

    def facts(self) -> dict[str, Any]:
        """Return them for JSON."""
        return {
            "seam_energy": round(self.seam_energy, 4),
            "wrap_percentile": round(self.wrap_percentile, 2),
            "brightness_off": round(self.brightness_off, 5),
            "contrast_off": round(self.contrast_off, 5),
            "copied": round(self.copied, 5),
            "largest_copy_px": self.largest_copy_px,
            **({"rejected": [round(share, 5) for share in self.rejected]} if self.rejected else {}),
        }


def measure(result: Synthesised, sources: list[Ptm], block_px: int) -> Quality:
    """Measure a result against what it was made from."""
    shape = result.material.shape
    brightness_off, contrast_off = statistics_off(result.material, sources)
    sizes = copy_sizes(result.canvas, shape)
    large = sizes[sizes > block_px**2]
    search = result.search
    tally = search.tally if isinstance(search, RejectionSearch) else None
    return Quality(
        seam_energy(result, shape),
        max(wrap_percentiles(lit(result.material))),
        brightness_off,
        contrast_off,
        float(large.sum()) / (shape[0] * shape[1]),
        int(sizes.max(initial=0)),
        () if tally is None else tuple(tally.rejected(n) for n in range(1, len(tally.left) + 1)),
    )


def seam_energy(result: Synthesised, shape: tuple[int, int]) -> float:
    """Compare squared differences across seams with those elsewhere; 1 where there is no seam."""
    crop = np.s_[: shape[0], : shape[1]]
    values = result.canvas.values[crop][..., : result.textures.compared]
    block = result.canvas.block[crop]
    sums, counts = np.zeros(2), np.zeros(2)
    for axis in (0, 1):
        steps = np.square(np.diff(values, axis=axis)).sum(axis=2, dtype=np.float64)
        across = np.diff(block, axis=axis) != 0
        sums += steps[across].sum(), steps[~across].sum()
        counts += across.sum(), (~across).sum()
    if not counts.all() or sums[1] == 0:
        return 1.0
    seam, other = sums / counts
    return float(seam / other)


def lit(material: Ptm) -> F32:
    """Relight under the held-out lights: luminance (8, H, W)."""
    return np.stack([relight(material, light).mean(axis=-1) for light in HELD_OUT])


def wrap_percentiles(pictures: F32) -> tuple[float, float]:
    """Rank the mean step from the last column to the first, and from the last row to the first, among inner ones.

    Returns
    -------
    columns, rows : percentiles, 0 to 100; 50 where a picture is one pixel wide and has nothing to compare
    """
    ranks = []
    for axis in (2, 1):
        inner = np.abs(np.diff(pictures, axis=axis)).mean(axis=(0, 3 - axis), dtype=np.float64)
        ends = np.take(pictures, 0, axis=axis) - np.take(pictures, -1, axis=axis)
        wrap = float(np.abs(ends).mean(dtype=np.float64))
        ranks.append(float((inner < wrap).mean() * 100) if len(inner) else 50.0)
    return ranks[0], ranks[1]


def statistics_off(material: Ptm, sources: list[Ptm]) -> tuple[float, float]:
    """Return the largest relative differences of mean and of standard deviation under the held-out lights."""
    off = np.zeros(2)
    for light in HELD_OUT:
        result = relight(material, light).mean(axis=-1).ravel().astype(np.float64)
        source = np.concatenate([relight(one, light).mean(axis=-1).ravel() for one in sources]).astype(np.float64)
        for index, (found, wanted) in enumerate([(result.mean(), source.mean()), (result.std(), source.std())]):
            difference = abs(found - wanted)
            off[index] = max(off[index], difference / abs(wanted) if abs(wanted) > 1e-6 else difference)
    return float(off[0]), float(off[1])


def copy_sizes(canvas: Canvas, shape: tuple[int, int]) -> NDArray[np.int64]:
    """Return the sizes of all pieces that lie in the result as they lie in a source, in pixels.

    Neighbouring blocks belong to one piece where the second goes on where the first ended. Pixels outside a hole, on
    which no block was laid, belong to none.
    """
    block = canvas.block[: shape[0], : shape[1]]
    if not canvas.taken:
        return np.zeros(0, np.int64)
    origins = np.array([(t.source, t.source_y - t.y, t.source_x - t.x) for t in canvas.taken])
    pairs = np.concatenate(
        [
            np.stack([block[:, :-1].ravel(), block[:, 1:].ravel()], axis=1),
            np.stack([block[:-1].ravel(), block[1:].ravel()], axis=1),
        ]
    )
    pairs = np.unique(pairs[(pairs >= 0).all(axis=1) & (pairs[:, 0] != pairs[:, 1])], axis=0)
    pairs = pairs[(origins[pairs[:, 0]] == origins[pairs[:, 1]]).all(axis=1)]
    count = len(canvas.taken)
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    _, piece = connected_components(graph, directed=False)
    areas = np.bincount(block[block >= 0].ravel(), minlength=count)
    return np.bincount(piece, areas).astype(np.int64)
