"""Separating MatCaps of 400² and 800², three channels, beside the 2 s and 6 s of the paper on a graphics card."""

import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.measure import Comparison
from litrig.base.radiometry import decode_srgb_codes, encode_srgb, to_u8
from processing.matcap.decompose import Filter, decompose
from processing.matcap.disc import disc_normals
from processing.matcap.separation.separate import Form, separate

F32 = NDArray[np.float32]
PAPERS_S = {400: 2.0, 800: 6.0}
GOALS_S = {400: 0.2, 800: 0.5}
FILTERS = (Filter.of_size(0.467), Filter.of_size(0.05))
CONSTANT_TOLERANCE = 1e-3
ROUNDS = 3


def comparisons(_: Path) -> list[Comparison]:
    """Compare both forms, and the whole decomposition, with the paper's time for the separation alone."""
    rows: list[Comparison] = []
    for side, goal in GOALS_S.items():
        smooth = painted(side)
        eight_bit = decode_srgb_codes(to_u8(encode_srgb(smooth)))
        grainy = np.clip(smooth + 0.01 * np.random.default_rng(1).normal(size=smooth.shape), 0, None).astype(np.float32)
        flat = np.full_like(smooth, 0.5)
        aim, thrice = f"≤ {goal:g} s", f"≤ {3 * goal:g} s"
        for name, picture in (("8 bits", eight_bit), ("floats", smooth), ("floats, noisy", grainy)):
            rows.append(_row(side, f"continuous, {name}", _separation(picture), aim))
        rows += [
            _row(side, "continuous, all one colour, to 0.001", _separation(flat, tolerance=CONSTANT_TOLERANCE), thrice),
            _row(side, "continuous, 8 bits, every pixel heeded", _separation(eight_bit, tolerance=0)),
            _row(side, "discrete, 8 bits", _separation(eight_bit, form="discrete")),
            _row(side, "discrete, floats", _separation(smooth, form="discrete")),
            _row(side, "discrete, all one colour", _separation(flat, form="discrete")),
            _row(side, "continuous, 8 bits, and the decomposition into maps of 1024²", _decomposition(eight_bit)),
        ]
    return rows


def painted(side: int) -> F32:
    """Draw a matt ball under two lights, with highlights."""
    normals, inside = disc_normals(side)
    matt = sum(
        np.maximum(normals @ np.array(light), 0)[..., None] * np.array(colour)
        for light, colour in (((0.3, 0.5, 0.8), (0.5, 0.3, 0.2)), ((-0.8, 0.1, 0.3), (0.1, 0.2, 0.4)))
    )
    towards = np.array([-0.3, 0.2, 0.93]) / np.linalg.norm([-0.3, 0.2, 0.93])
    shine = np.exp(60 * (normals @ towards - 1)) + 0.1 * (np.sin(9 * normals[..., 0]) > 0.6)
    picture: F32 = ((matt + 0.5 * shine[..., None] + 0.02) * inside[..., None]).astype(np.float32)
    return picture


def _separation(picture: F32, form: Form = "continuous", tolerance: float = 1e-4) -> Callable[[], None]:
    def run() -> None:
        found = separate(picture, form=form, tolerance=tolerance)
        assert found.low.min() >= 0 and found.high.min() >= 0

    found = separate(picture, form=form, tolerance=tolerance)
    inside = disc_normals(len(picture))[1]
    np.testing.assert_allclose((found.low + found.high)[inside], picture[inside], atol=1e-12)
    return run


def _decomposition(picture: F32) -> Callable[[], None]:
    def run() -> None:
        apart = separate(picture)
        decompose(apart.low, apart.high, apart.known, FILTERS, size=1024)

    return run


def _row(side: int, name: str, action: Callable[[], None], goal: str = "") -> Comparison:
    paper = PAPERS_S[side]
    action()
    times = []
    for _ in range(ROUNDS):
        start_s = time.perf_counter()
        action()
        times.append(time.perf_counter() - start_s)
    middle = statistics.median(times)
    spread = (min(times) / paper, max(times) / paper)
    what = f"Separation of a MatCap of {side}², three channels"
    return Comparison(what, name, f"the paper's {paper:g} s, GTX 555", middle / paper, spread, middle, goal)


def main() -> None:
    """Print the rows of this module alone."""
    from benchmarks.measure import table

    print(table(comparisons(Path())))


if __name__ == "__main__":
    main()
