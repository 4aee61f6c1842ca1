"""What a file of shading buffers holds, also where it cannot be used."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from litrig.base.errors import FormatError
from processing.shape.buffers.channels import read_channels
from processing.shape.buffers.layers import Layers, find_buffers
from processing.shape.buffers.names import BUFFERS
from processing.shape.buffers_exr import ReadOptions, read_buffers
from processing.shape.model import ShadingBuffers


@dataclass(frozen=True)
class Survey:
    """What was found.

    Attributes
    ----------
    size : width and height
    found : layers and whose names they are, by buffer
    missing : buffers that were not found
    unused : layers that are no buffer
    surfaces : a few words on each, by its number; none if the buffers cannot be used
    remarks : what is done without, what is left out, or why the buffers cannot be used
    """

    size: tuple[int, int]
    found: dict[str, tuple[str, str]]
    missing: list[str]
    unused: list[str]
    surfaces: dict[int, str]
    remarks: list[str]


def survey(path: Path, options: ReadOptions) -> Survey:
    """Look a file through.

    Raises
    ------
    InputError, FormatError
        The file cannot be read, or is no EXR.
    """
    stored = read_channels(path)
    layers = Layers(stored.planes)
    found = find_buffers(layers, options.layers)
    used = {
        name
        for one in found.values()
        for name in (*one.recipe.terms, *one.recipe.also, *([one.recipe.factor] if one.recipe.factor else []))
    }
    either = {"position": "depth", "depth": "position"}
    missing = [name for name in BUFFERS if name not in found and either.get(name) not in found]
    remarks: list[str] = []
    surfaces: dict[int, str] = {}
    try:
        surfaces = _surfaces(read_buffers(path, options, remarks.append))
    except FormatError as error:
        remarks.append(f"cannot be used: {str(error).removeprefix(f'{path}: ')}")
    height, width = stored.shape
    return Survey(
        size=(width, height),
        found={name: (str(one.recipe) or "R G B A", one.renderer) for name, one in found.items()},
        missing=missing,
        unused=[name for name in layers.names if name and name not in used],
        surfaces=surfaces,
        remarks=remarks,
    )


def _surfaces(buffers: ShadingBuffers) -> dict[int, str]:
    told = {}
    for number in buffers.seen:
        here = buffers.surfaces == number
        extent = np.ptp(buffers.positions[here], axis=0)
        size = "" if buffers.orthographic else f", {extent[0]:.3g} × {extent[1]:.3g} × {extent[2]:.3g} in the scene"
        rows, columns = np.nonzero(here)
        told[number] = f"{rows.size} pixels around {columns.mean():.0f}, {rows.mean():.0f}{size}"
    return told
