"""A map of what should be where: blocks are also chosen by how well they fit it (Efros, Freeman, 2001, transfer)."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from processing.ptm.model import Ptm
from processing.ptm.relighting.relight import relight

F32 = NDArray[np.float32]
_OVERHEAD = np.array([0.0, 0.0, 1.0])
_BLUR_OF_BLOCK = 0.25


@dataclass(frozen=True)
class Guidance:
    """A map of the result and one of each source, of the same meaning.

    Attributes
    ----------
    target : (H, W) float32, 0..1, of the result's size
    sources : (h, w) float32, 0..1, one for each source and of its size
    """

    target: F32
    sources: tuple[F32, ...]

    def target_on(self, shape: tuple[int, int]) -> F32:
        """Return the map on a canvas that may be larger, where its last rows and columns go on."""
        more = [(0, whole - part) for whole, part in zip(shape, self.target.shape, strict=True)]
        return np.pad(self.target, more, mode="edge")


def stretched(target: F32, size: tuple[int, int]) -> F32:
    """Bring a map (h, w) to the result's height and width."""
    return np.asarray(cv2.resize(target, size[::-1], interpolation=cv2.INTER_AREA), np.float32)


def brightness_ranks(materials: Sequence[Ptm], block_px: int) -> tuple[F32, ...]:
    """Make maps of sources from themselves: where among all pixels, from dark 0 to bright 1, a blurred pixel stands."""
    blurred = []
    for material in materials:
        brightness = np.ascontiguousarray(relight(material, _OVERHEAD).mean(axis=-1), np.float32)
        blurred.append(cv2.GaussianBlur(brightness, (0, 0), _BLUR_OF_BLOCK * block_px, borderType=cv2.BORDER_REFLECT))
    everything = np.sort(np.concatenate([one.ravel() for one in blurred]))
    ranks = [np.searchsorted(everything, one.ravel(), side="left") for one in blurred]
    most = max(1, len(everything) - 1)
    return tuple((rank.reshape(one.shape) / most).astype(np.float32) for rank, one in zip(ranks, blurred, strict=True))
