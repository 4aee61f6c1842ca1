"""Acknowledging frames durably, beside merely writing them."""

import itertools
from pathlib import Path

import numpy as np

from benchmarks.measure import Comparison, compare
from litrig.base.capture_folder.writer import CaptureFolderWriter

FRAME = np.random.default_rng(0).integers(0, 256, 200_000, np.uint8).tobytes()
THUMB = np.zeros((120, 160, 3), np.uint8)


def comparisons(folder: Path) -> list[Comparison]:
    """Compare a frame in the full order of writes with a bare write."""
    (folder / "bare").mkdir()
    count = itertools.count()
    with CaptureFolderWriter.create(folder / "session", "x", {}, []) as writer:
        return [
            compare(
                "One frame of 200 kB onto the disk",
                (
                    "journalled: fsync of file, folder and journal",
                    lambda: writer.add_frame(f"{next(count):06d}.jpg", FRAME, THUMB, step=0),
                ),
                ("written, no fsync", lambda: (folder / "bare" / f"{next(count)}.jpg").write_bytes(FRAME)),
                rounds=40,
            )
        ]
