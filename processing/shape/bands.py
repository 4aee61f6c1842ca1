"""Work on the rows of a picture, on all cores: kernels do not hold the interpreter's lock."""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise

_LEAST_ROWS = 64


def in_bands(height: int, work: Callable[[int, int], None]) -> None:
    """Call work(first row, row after the last) for bands that make up the whole height, at once."""
    count = max(1, min(os.cpu_count() or 1, height // _LEAST_ROWS))
    edges = [height * index // count for index in range(count + 1)]
    if count == 1:
        work(0, height)
        return
    with ThreadPoolExecutor(count) as workers:
        for done in [workers.submit(work, *band) for band in pairwise(edges)]:
            done.result()
