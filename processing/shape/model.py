"""What a renderer hands over beside its picture, and what is reconstructed from it (Local Shape Editing, section 3)."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]
BACKGROUND = 0


@dataclass(frozen=True)
class ShadingBuffers:
    """A rendered picture and its buffers. Row 0 on top, linear light, view frame with the camera in its origin.

    Attributes
    ----------
    picture : (H, W, 3) float32, the picture itself, I
    coverage : (H, W) float32, 0..1, the share of a pixel that is no background, α
    diffuse, reflection : (H, W, 3) float32, the two parts of the shading, D₀ and R₀
    normals : (H, W, 3) float32, unit where there is a surface
    positions : (H, W, 3) float32
    surfaces : (H, W) uint32, which surface is seen; 0 is the background
    ambient_occlusion, reflection_occlusion : (H, W) float32, 0..1, 1 where nothing is in the way, α_D and α_R
    """

    picture: F32
    coverage: F32
    diffuse: F32
    reflection: F32
    normals: F32
    positions: F32
    surfaces: NDArray[np.uint32]
    ambient_occlusion: F32
    reflection_occlusion: F32

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width."""
        height, width = self.coverage.shape
        return height, width


@dataclass(frozen=True)
class SurfaceEnvironment:
    """The light that a surface's shading shows, already filtered by its material.

    Attributes
    ----------
    diffuse : (9, 3) float32, coefficients of `harmonics` for each channel; D(n)
    front, back : (S, S, 3) float32, dual paraboloid map over the mirrored view direction, as `paraboloid.maps`; R(r)
    """

    diffuse: F32
    front: F32
    back: F32


Environments = Mapping[int, SurfaceEnvironment]
"""By the number of their surface."""
