"""Relighting PTMs flat beside the cheapest picture of that size, and a picture by the command beside its imports."""

import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import numpy as np

from benchmarks.measure import Comparison, compare
from processing.mesh.model import Mesh
from processing.ptm.basis import PTM, Basis
from processing.ptm.files.either import write_any
from processing.ptm.model import Colour, Ptm
from viewer.geometry import mesh_geometry, whole_picture
from viewer.materials.matcap import MatcapMaterial
from viewer.materials.ptm import PtmMaterial
from viewer.materials.ptm_shading import PtmShading, shading_lights
from viewer.renderer import Renderer
from viewer.targets import Target
from viewer.view import Projection, View

SIDE, FRAMES = 1024, 4
KINDS: tuple[tuple[str, Basis, Colour, float], ...] = (
    ("PTM LRGB, 6 + 3 coefficients", PTM, "lrgb", 1.0),
    ("PTM RGB, 18 coefficients", PTM, "rgb", 1.0),
    ("PTM RGB with diffuse gain", PTM, "rgb", 2.0),
    ("HSH RGB, 27 coefficients", Basis("hsh", 9), "rgb", 1.0),
)


def comparisons(folder: Path) -> list[Comparison]:
    """Compare frames by the time of the processor, uploads and reading left out; and the command by the clock."""
    with Renderer() as renderer, ExitStack() as held:
        target = held.enter_context(renderer.upload(Target, (SIDE, SIDE)))
        floor = _matcap(held, renderer, target)
        rows = [
            compare(
                f"{FRAMES} flat frames of {SIDE}², each under another light, CPU time",
                (name, _relit(held, renderer, target, _material(basis, colour), gain)),
                ("plain MatCap over the whole picture", floor),
                clock=time.process_time,
            )
            for name, basis, colour, gain in KINDS
        ]
    return [*rows, _command(folder)]


def _relit(held: ExitStack, renderer: Renderer, target: Target, ptm: Ptm, gain: float) -> Callable[[], None]:
    material = held.enter_context(renderer.upload(PtmMaterial, ptm, brightest=gain != 1))
    everything = held.enter_context(renderer.upload(whole_picture))

    def draw() -> None:
        for number in range(FRAMES):
            shading = PtmShading(shading_lights(((0.1 * number, 0.3),)), gain)
            renderer.draw(material.flat_look(shading), everything, target)
        renderer.finish()

    draw()
    _check(target.read())
    return draw


def _matcap(held: ExitStack, renderer: Renderer, target: Target) -> Callable[[], None]:
    along = (2 * np.arange(128) + 1) / 128 - 1
    disc = np.stack(np.broadcast_arrays(along[None] / 2 + 0.5, along[:, None] / 2 + 0.5, np.float64(0.5)), axis=-1)
    material = held.enter_context(renderer.upload(MatcapMaterial, disc.astype(np.float32)))
    geometry = held.enter_context(renderer.upload(mesh_geometry, _bulge()))

    def draw() -> None:
        for number in range(FRAMES):
            renderer.draw(material.look(), geometry, target, View(Projection.ORTHOGRAPHIC, zoom=1.6 + 0.01 * number))
        renderer.finish()

    draw()
    _check(target.read())
    return draw


def _bulge() -> Mesh:
    """Two triangles that fill the picture, with the normals of a ball."""
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32) / 1.5
    normals = corners + np.array([0, 0, 0.6], np.float32)
    tangents = np.cross(np.array([0, 1, 0], np.float32), normals)
    return Mesh(
        positions=corners,
        normals=normals / np.linalg.norm(normals, axis=1, keepdims=True),
        tangents=tangents / np.linalg.norm(tangents, axis=1, keepdims=True),
        uvs=np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32),
        triangles=np.array([[0, 1, 2], [0, 2, 3]], np.int32),
    )


def _command(folder: Path) -> Comparison:
    write_any(folder / "bench.ptm", _material(PTM, "lrgb", 256))
    litrig: list[str | Path] = [
        sys.executable,
        "-m",
        "litrig",
        "render",
        folder / "bench.ptm",
        "-o",
        folder / "bench.png",
    ]
    libraries: list[str | Path] = [sys.executable, "-c", "import moderngl, numpy, cv2"]

    def run(words: list[str | Path]) -> Callable[[], object]:
        return lambda: subprocess.run(words, check=True, capture_output=True)

    row = compare(
        "From the command to the picture",
        ("litrig render of a PTM of 256²", run(litrig)),
        ("Python with moderngl, NumPy and OpenCV imported", run(libraries)),
    )
    if not (folder / "bench.png").stat().st_size:
        raise AssertionError("no picture")
    return row


def _material(basis: Basis, colour: Colour, side: int = SIDE) -> Ptm:
    random = np.random.default_rng(3)
    shape = (basis.terms, side, side, 1 if colour == "lrgb" else 3)
    coefficients = random.uniform(-0.2, 0.3, shape).astype(np.float32)
    factor = random.uniform(0.3, 1, (side, side, 3)).astype(np.float32) if colour == "lrgb" else None
    return Ptm(coefficients, factor, basis=basis)


def _check(picture: np.ndarray) -> None:
    if not (float(picture[..., 3].min()) == 1 and float(picture[..., :3].std()) > 0.05):
        raise AssertionError("the picture is not filled")
