"""Fitting JPEGs to a `.ptm`, beside merely decoding them with as many threads and beside the plain NumPy way.

Usage: python -m benchmarks.ptm FOLDER COLOUR, which fits the folder and prints the peak in bytes before and after.
"""

import json
import math
import os
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import cv2
import numpy as np
import simplejpeg
from numpy.typing import NDArray

from benchmarks.measure import Comparison, compare, peak_bytes
from litrig.base.directions import direction_from_angles
from litrig.base.lights import Lights
from litrig.base.lp import write_lp
from litrig.base.pictures import decode_jpeg, read_codes
from processing.ptm.files.either import choose_coder, read_any, write_any
from processing.ptm.fit import FitSettings, start_fit
from processing.ptm.model import Colour
from processing.ptm.quality import report_on
from processing.ptm.relighting.relight import relight
from processing.stack import Stack

F64 = NDArray[np.float64]
LIGHTS = 50
MEGAPIXELS = (1, 4, 24)
COLOURS: tuple[Colour, ...] = ("rgb", "lrgb")


def lights() -> F64:
    """Light directions on a spiral."""
    return np.array([direction_from_angles(137.5 * i, 20 + 60 * i / LIGHTS) for i in range(LIGHTS)])


def write_set(folder: Path, megapixels: float) -> list[Path]:
    """Write the JPEGs of a structured relief, 4:2:0 like a camera's, and their .lp."""
    folder.mkdir(parents=True)
    height = math.isqrt(int(megapixels * 750_000))
    width = height * 4 // 3
    grain = cv2.GaussianBlur(np.random.default_rng(0).random((height, width, 3), np.float32), (0, 0), 2)
    grain = (grain - grain.min()) / np.ptp(grain)
    y, x = np.mgrid[0:height, 0:width].astype(np.float32) / 40
    slope = np.stack([np.cos(x) * 0.4 + 0.4 * (grain[..., 0] - 0.5), np.sin(y + x) * 0.3, np.ones_like(x)], -1)
    normals = slope / np.linalg.norm(slope, axis=-1, keepdims=True)
    albedo = np.array([0.9, 0.7, 0.5], np.float32) * (0.5 + grain)
    paths = [folder / f"{index:03d}.jpg" for index in range(LIGHTS)]
    for path, light in zip(paths, lights().astype(np.float32), strict=True):
        shade = np.clip(np.clip(normals @ light, 0, 1)[..., None] * albedo, 0, 1)
        path.write_bytes(simplejpeg.encode_jpeg((shade * 255).astype(np.uint8), 92, colorsubsampling="420"))
    write_lp(folder / "set.lp", Lights(tuple(path.name for path in paths), lights()))
    return paths


def fit_to_file(paths: list[Path], out: Path, colour: Colour) -> None:
    """Do what `litrig ptm fit` does."""
    fitted = start_fit(Stack(paths), lights(), FitSettings(colour=colour))
    coder = choose_coder(out, fitted)
    report_on(fitted, None if coder is None else coder.stored)
    write_any(out, fitted, coder)


def comparisons(folder: Path) -> list[Comparison]:
    """Compare the fit at every size."""
    rows: list[Comparison] = []
    for megapixels in MEGAPIXELS:
        paths = write_set(folder / f"ptm{megapixels}", megapixels)
        rounds = 5 if megapixels < 10 else 2
        for colour in COLOURS:
            out = folder / f"{colour}{megapixels}.ptm"
            ours = (f"{colour.upper()} to .ptm, all of it", lambda: fit_to_file(paths, out, colour))  # noqa: B023
            what = f"PTM, {LIGHTS} JPEGs of {megapixels} MP"
            goal = "≤ 2 (2.5)" if megapixels == 4 else ""
            rows.append(compare(what, ours, ("decoding alone", lambda: decode(paths)), rounds=rounds, goal=goal))  # noqa: B023
            if megapixels == 1:
                _check(paths, out)
                rows.append(compare(what, ours, ("numpy.linalg.lstsq, no file", lambda: _lstsq(paths)), rounds=3))  # noqa: B023
        if megapixels == 1:
            rows.append(_cold_start(paths[0].parent, folder))
    return rows


def memory(folder: Path) -> str:
    """Say how much the fit takes above the interpreter; needs what `comparisons` left in the folder."""
    lines = ["| what | peak above the interpreter, MiB | budget, MiB |", "| --- | --- | --- |"]
    for megapixels in MEGAPIXELS:
        for colour in COLOURS:
            command = [sys.executable, "-m", "benchmarks.ptm", str(folder / f"ptm{megapixels}"), colour]
            before, after = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
            used = (after - before) / 2**20
            what = f"{LIGHTS} JPEGs of {megapixels} MP, {colour.upper()} to .ptm"
            lines.append(f"| {what} | {used:.0f} | {1e9 / 2**20:.0f} |")
    return "\n".join(lines)


def decode(paths: list[Path]) -> None:
    """Decode with as many threads as the fit has, and keep nothing."""
    with ThreadPoolExecutor(os.cpu_count()) as workers:
        for _ in workers.map(lambda path: decode_jpeg(path.read_bytes(), str(path)).shape, paths):
            pass


def _check(paths: list[Path], out: Path) -> None:
    light = np.array([0.3, 0.4, math.sqrt(0.75)])
    plain = np.tensordot(_terms(light[None])[0], _lstsq(paths), 1)
    np.testing.assert_allclose(relight(read_any(out), light).mean(-1), plain.mean(-1), atol=0.03)


def _cold_start(pictures: Path, folder: Path) -> Comparison:
    """Compare the command, a process of its own, with the same in a process that runs already."""
    out = folder / "cold.ptm"
    command = [sys.executable, "-m", "litrig", "ptm", "fit", str(pictures), "-o", str(out)]
    paths = sorted(pictures.glob("*.jpg"))
    return compare(
        f"PTM, {LIGHTS} JPEGs of 1 MP",
        ("LRGB, the command in a new process", lambda: subprocess.run(command, check=True, capture_output=True)),
        ("in a process that runs", lambda: fit_to_file(paths, out, "lrgb")),
        rounds=3,
    )


def _terms(directions: F64) -> F64:
    u, v = directions[:, 0], directions[:, 1]
    return np.stack([u * u, v * v, u * v, u, v, np.ones_like(u)], 1)


def _lstsq(paths: list[Path]) -> F64:
    stack = np.stack([read_codes(path) for path in paths]).astype(np.float64) / 255
    coefficients, *_ = np.linalg.lstsq(_terms(lights()), stack.reshape(len(paths), -1), rcond=None)
    return np.asarray(coefficients.reshape(6, *stack.shape[1:]), np.float64)


def main() -> None:
    folder, colour = Path(sys.argv[1]), COLOURS[COLOURS.index(sys.argv[2])]
    with tempfile.TemporaryDirectory() as out:
        small = write_set(Path(out) / "small", 0.01)
        fit_to_file(small, Path(out) / "small.ptm", colour)  # loads what is loaded once
        before = peak_bytes()
        fit_to_file(sorted(folder.glob("*.jpg")), Path(out) / "x.ptm", colour)
    sys.stdout.write(json.dumps([before, peak_bytes()]))


if __name__ == "__main__":
    main()
