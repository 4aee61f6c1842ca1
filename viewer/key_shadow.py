"""Where a mesh keeps the key light from itself, by a shadow map (the AMC paper, section 6.1)."""

import math
from typing import Self

import moderngl
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.reference.camera import Camera
from viewer.geometry import Geometry
from viewer.gl_context import GlContext
from viewer.look import Look, UniformValue
from viewer.renderer import Renderer
from viewer.targets import DepthTarget
from viewer.view import View

F64 = NDArray[np.float64]
MAP_TEXELS = 2048
_REACH = 1.02
"""Half the map's side: the mesh lies within the unit sphere."""
_OFFSET_TEXELS = 2.0


class KeyShadow:
    """A shadow map, and how to read it. Draw it again whenever the object is turned or the key light is moved.

    Attributes
    ----------
    uniforms : what `key_shadow.glsl` is told
    """

    def __init__(self, gl: GlContext, side_texels: int = MAP_TEXELS) -> None:
        self._map = DepthTarget(gl, (side_texels, side_texels))
        self.uniforms: dict[str, UniformValue] = {}

    @property
    def depth(self) -> moderngl.Texture:
        return self._map.depth

    def cast(self, renderer: Renderer, geometry: Geometry, view: View, key: tuple[float, float]) -> Self:
        """Draw what the key light sees.

        Parameters
        ----------
        geometry : within the unit sphere
        key : x and y of the unit vector to the distant key light, view frame; it stands still while the object turns

        Raises
        ------
        InputError
            The direction is none.
        """
        towards = key_direction(key)
        map_from_view = _orthographic(towards)
        camera = Camera(view.camera((1, 1)).view_from_object, map_from_view, None)
        renderer.draw(Look("depth.frag"), geometry, self._map, camera)
        # The map's clip space goes from −1 to 1, its texture from 0 to 1.
        to_texture = np.array([[0.5, 0, 0, 0.5], [0, 0.5, 0, 0.5], [0, 0, 0.5, 0.5], [0, 0, 0, 1]])
        self.uniforms = {
            "map_from_view": tuple((to_texture @ map_from_view).T.ravel()),
            "key_direction": tuple(towards),
            "key_offset": _OFFSET_TEXELS * 2 * _REACH / self._map.size[0],
        }
        return self

    def release(self) -> None:
        self._map.release()


def key_direction(key: tuple[float, float]) -> F64:
    """Complete x and y to a unit vector towards the camera's side.

    Raises
    ------
    InputError
        They lie outside the unit disc.
    """
    square = key[0] ** 2 + key[1] ** 2
    if not square <= 1:
        raise InputError(
            f"key light: ({key[0]:g}, {key[1]:g}) is no direction; give x and y of a unit vector, x² + y² ≤ 1"
        )
    return np.array([key[0], key[1], math.sqrt(1 - square)])


def _orthographic(towards: F64) -> F64:
    """Look along the light, (4, 4): x and y across it, z growing away from it."""
    aside = np.array([0.0, 1.0, 0.0]) if abs(towards[1]) < 0.9 else np.array([1.0, 0.0, 0.0])
    right = np.cross(aside, towards)
    right /= np.linalg.norm(right)
    clip_from_view = np.eye(4)
    clip_from_view[:3, :3] = np.stack([right, np.cross(towards, right), -towards]) / _REACH
    return clip_from_view
