"""Shading buffers written as renderers write them, by OpenEXR alone."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR

from processing.shape.model import ShadingBuffers


def layers(buffers: ShadingBuffers) -> dict[str, np.ndarray]:
    stored: dict[str, np.ndarray] = {part: buffers.picture[..., index] for index, part in enumerate("RGB")}
    stored["A"] = buffers.coverage
    for name, plane, parts in (
        ("diffuse", buffers.diffuse, "RGB"),
        ("reflection", buffers.reflection, "RGB"),
        ("normal", buffers.normals, "XYZ"),
        ("position", buffers.positions, "XYZ"),
    ):
        stored |= {f"{name}.{part}": plane[..., index] for index, part in enumerate(parts)}
    stored["surface_id.I"] = buffers.surfaces
    stored["ambient_occlusion.Y"] = buffers.ambient_occlusion
    stored["reflection_occlusion.Y"] = buffers.reflection_occlusion
    return stored


def write(path: Path, channels: Mapping[str, np.ndarray], **header: Any) -> None:
    attributes = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **header}
    OpenEXR.File(attributes, {name: np.ascontiguousarray(values) for name, values in channels.items()}).write(str(path))
