"""How a surface looks: what a material hands to the renderer for one draw."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import moderngl

UniformValue = int | float | bool | tuple[float, ...] | tuple[tuple[float, ...], ...]
Texture = moderngl.Texture | moderngl.TextureArray | moderngl.Texture3D


@dataclass(frozen=True)
class Look:
    """Shaders, and all that they are told beside the camera and the geometry.

    It is cheap: a material makes one for every draw, with another light or another level, from what it has on the card.

    Attributes
    ----------
    fragment, vertex : shader files
    uniforms : values by the names that the shaders give them; every one must be used
    textures : what each sampler reads
    switches : names that are defined in both shaders; each set of them is a program of its own
    others : drawn on the same geometry too, where this one leaves it out
    """

    fragment: str
    uniforms: Mapping[str, UniformValue] = field(default_factory=dict)
    textures: Mapping[str, Texture] = field(default_factory=dict)
    vertex: str = "mesh.vert"
    switches: frozenset[str] = frozenset()
    others: tuple["Look", ...] = ()
