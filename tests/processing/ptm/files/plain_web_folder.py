"""A second reader of web folders: the sums that a viewer's shader makes, written from the description alone."""

import json
import math
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from tests.processing.ptm.files.plain_rti import harmonics


def plain_picture(folder: Path, u: float, v: float) -> NDArray[np.float64]:
    """Relight a folder: (H, W, 3) where 1 is white, row 0 on top."""
    info = json.loads((folder / "info.json").read_text())
    material = info["materials"][0]
    texels = []
    for number in range(math.ceil(info["nplanes"] / 3)):
        picture = cv2.imread(str(folder / f"plane_{number}.jpg"), cv2.IMREAD_COLOR)
        assert picture is not None
        assert picture.shape == (info["height"], info["width"], 3)
        texels += [picture[..., 2] / 255, picture[..., 1] / 255, picture[..., 0] / 255]
    planes = [
        (texel - bias) * scale for texel, bias, scale in zip(texels, material["bias"], material["scale"], strict=False)
    ]
    assert len(planes) == info["nplanes"] == len(material["bias"]) == len(material["scale"])
    weights = [1, u, v, u * u, u * v, v * v] if info["type"] == "ptm" else harmonics(u, v, math.sqrt(1 - u * u - v * v))
    if info["colorspace"] == "lrgb":
        luminance = sum(weight * plane for weight, plane in zip(weights, planes[3:], strict=False))
        return np.stack([luminance * plane for plane in planes[:3]], axis=-1)
    return np.stack(
        [
            sum(weight * plane for weight, plane in zip(weights, planes[channel::3], strict=False))
            for channel in range(3)
        ],
        axis=-1,
    )
