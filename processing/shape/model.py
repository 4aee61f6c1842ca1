"""What a renderer hands over beside its picture, and what is reconstructed from it (Local Shape Editing, section 3)."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

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
    albedo, reflection_albedo : (H, W, 3) float32, what illumination is multiplied by to give D₀ and R₀; None where the
        renderer did not tell
    orthographic : every pixel is seen along −z; positions may then be missing, and stand at (0, 0, −1)
    stored_turn : three rows that normals in other files of the same camera are multiplied by, where those do not say it
        themselves; None leaves them as they are
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
    albedo: F32 | None = None
    reflection_albedo: F32 | None = None
    orthographic: bool = False
    stored_turn: tuple[tuple[float, ...], ...] | None = None

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width."""
        height, width = self.coverage.shape
        return height, width

    @cached_property
    def seen(self) -> list[int]:
        """Numbers of the surfaces that are seen, in their order."""
        return [number for number in np.unique(self.surfaces).tolist() if number != BACKGROUND]

    @cached_property
    def to_eye(self) -> F32:
        """Unit directions (H, W, 3) from the surface to the eye, v; z where there is no surface."""
        towards = -self.positions
        if self.orthographic:
            towards = np.zeros_like(towards)
        length = np.linalg.norm(towards, axis=-1, keepdims=True)
        axis = np.array([0, 0, 1], np.float32)
        unit: F32 = np.where(length > 0, towards / np.where(length > 0, length, 1), axis).astype(np.float32)
        return unit


@dataclass(frozen=True)
class SurfaceEnvironment:
    """The light that a surface's shading shows, already filtered by its material.

    Attributes
    ----------
    diffuse : (9, 3) float32, coefficients of `harmonics` for each channel; D(n)
    front, back : (S, S, 3) float32, dual paraboloid map over the mirrored view direction, as `paraboloid.maps`; R(r)
    diffuse_is_illumination, reflection_is_illumination : D or R is light before the material's albedo, which varies
        over the surface and is multiplied back (the paper's section 6)
    regions : of an extended surface, whose light is not the same everywhere; `extended.blend` says how they go over
        into one another. All that is above is then that of the whole surface, for whoever does not care
    falloff : standard deviation of their weights, in units of the positions
    """

    diffuse: F32
    front: F32
    back: F32
    diffuse_is_illumination: bool = False
    reflection_is_illumination: bool = False
    regions: tuple["Region", ...] = ()
    falloff: float = 0.0


@dataclass(frozen=True)
class Region:
    """A part of a surface with light of its own.

    Attributes
    ----------
    centre : (3,) float32, view frame
    environment : without regions
    """

    centre: F32
    environment: SurfaceEnvironment


Environments = Mapping[int, SurfaceEnvironment]
"""By the number of their surface."""
