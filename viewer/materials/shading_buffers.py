"""Shading buffers on the graphics card: a rendered picture whose normals can be changed."""

from collections.abc import Sequence

import moderngl
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.shape.albedo import check_reflectance
from processing.shape.horizon import HORIZON
from processing.shape.model import BACKGROUND, Environments, ShadingBuffers, SurfaceEnvironment
from viewer.geometry import whole_picture
from viewer.gl_context import GlContext
from viewer.look import Look, Texture, UniformValue
from viewer.renderer import Renderer

F32 = NDArray[np.float32]
_NONE = np.ones((1, 1, 3), np.float32)


class ShadingBuffersMaterial:
    """A picture, its buffers and the environments of its surfaces. Normals are uploaded as often as they change."""

    def __init__(
        self,
        gl: GlContext,
        buffers: ShadingBuffers,
        environments: Environments,
        factor_maps: tuple[F32, F32] | None = None,
    ) -> None:
        """Upload.

        Parameters
        ----------
        factor_maps : what k_D and k_R are multiplied by, (H, W) each; None is 1

        Raises
        ------
        InputError
            The picture is larger than the card takes, there is no environment, they are not square maps of one size, or
            they need an albedo that is not there.
        """
        check_reflectance(buffers, environments)
        height, width = buffers.shape
        info = gl.moderngl.info
        largest, most = int(info["GL_MAX_TEXTURE_SIZE"]), int(info["GL_MAX_ARRAY_TEXTURE_LAYERS"])
        surfaces = sorted(environments)
        _check(surfaces, [environments[number] for number in surfaces], largest, most)
        if max(width, height) > largest:
            raise InputError(
                f"shading buffers: {width} × {height} pixels, but this graphics driver ends at {largest}; cut or "
                "shrink them"
            )
        self._gl, self._size = gl, (width, height)
        places = np.full(buffers.shape, -1, np.float32)
        for place, number in enumerate(surfaces):
            places[buffers.surfaces == number] = place
        planes = {
            "picture": _with(buffers.picture, buffers.coverage),
            "diffuse": _with(buffers.diffuse, buffers.ambient_occlusion),
            "reflection": _with(buffers.reflection, buffers.reflection_occlusion),
            "normals": _with(buffers.normals, places),
            "to_eye": buffers.to_eye,
            "new_normals": buffers.normals,
            "albedo": _NONE if buffers.albedo is None else buffers.albedo,
            "reflection_albedo": _NONE if buffers.reflection_albedo is None else buffers.reflection_albedo,
            "factor_maps": _factor_maps(factor_maps, buffers.shape),
            "harmonics": np.stack([_row(environments[number]) for number in surfaces]),
        }
        self._textures: dict[str, Texture] = {name: _plane(gl, texels) for name, texels in planes.items()}
        self._new_normals = self._textures["new_normals"]
        for name, side in (("environment_front", "front"), ("environment_back", "back")):
            self._textures[name] = _layers(gl, [getattr(environments[number], side) for number in surfaces])

    def change_normals(self, normals: F32) -> None:
        """Upload other normals (H, W, 3), unit, view frame.

        Raises
        ------
        InputError
            They are of another size, or no numbers.
        """
        width, height = self._size
        if normals.shape != (height, width, 3):
            raise InputError(f"normals: {normals.shape} are not those of {width} × {height} pixels; give (H, W, 3)")
        if not np.all(np.isfinite(normals)):
            raise InputError("normals: hold what are no numbers; mend them")
        with self._gl.moderngl:
            self._new_normals.write(np.ascontiguousarray(normals, "<f4").tobytes(), alignment=1)

    def look(self, *, diffuse_factor: float = 1.0, reflection_factor: float = 1.0, horizon: float = HORIZON) -> Look:
        """Say how it is drawn, on `whole_picture` at its own size; row 0 is drawn at the bottom.

        Parameters
        ----------
        diffuse_factor, reflection_factor : k_D and k_R of the paper's equation 5
        horizon : r̃·n from which down the surface hides mirrored rays; 0 is equation 4 as it is printed
        """
        uniforms: dict[str, UniformValue] = {"factors": (diffuse_factor, reflection_factor), "horizon": horizon}
        return Look("recompose.frag", uniforms, self._textures, vertex="flat.vert")

    def release(self) -> None:
        for texture in self._textures.values():
            texture.release()


def recomposed_picture(
    renderer: Renderer,
    buffers: ShadingBuffers,
    environments: Environments,
    normals: F32,
    *,
    diffuse_factor: float = 1.0,
    reflection_factor: float = 1.0,
    horizon: float = HORIZON,
    factor_maps: tuple[F32, F32] | None = None,
) -> F32:
    """Shade a picture again under changed normals, once.

    Parameters
    ----------
    factor_maps : what the factors are multiplied by, (H, W) each

    Returns
    -------
    picture : (H, W, 3) float32, linear light, row 0 on top
    """
    height, width = buffers.shape
    with (
        renderer.upload(ShadingBuffersMaterial, buffers, environments, factor_maps) as material,
        renderer.upload(whole_picture) as everything,
    ):
        material.change_normals(normals)
        look = material.look(diffuse_factor=diffuse_factor, reflection_factor=reflection_factor, horizon=horizon)
        return renderer.picture(look, everything, size=(width, height))[::-1, :, :3]


def _check(surfaces: Sequence[int], environments: Sequence[SurfaceEnvironment], largest: int, most: int) -> None:
    if not surfaces or BACKGROUND in surfaces:
        raise InputError(f"environments: of surfaces {list(surfaces)}; give at least one, {BACKGROUND} is background")
    shapes = {side.shape for environment in environments for side in (environment.front, environment.back)}
    size = next(iter(shapes))[0]
    if shapes != {(size, size, 3)} or any(environment.diffuse.shape != (9, 3) for environment in environments):
        raise InputError("environments: maps are not square and of one size, or there are not 9 coefficients a channel")
    if size > largest or len(surfaces) > most:
        raise InputError(
            f"environments: {len(surfaces)} of {size}² texels, but this graphics driver ends at {most} of {largest}²"
        )
    if not all(
        np.all(np.isfinite(part))
        for environment in environments
        for part in (environment.front, environment.back, environment.diffuse)
    ):
        raise InputError("environments: hold what are no numbers; reconstruct them again")


def _row(environment: SurfaceEnvironment) -> F32:
    """Return coefficients (10, 3), the last of which tells what is light before the albedo."""
    flags = (environment.diffuse_is_illumination, environment.reflection_is_illumination, 0)
    return np.vstack([environment.diffuse, np.array(flags, np.float32)])


def _factor_maps(maps: tuple[F32, F32] | None, shape: tuple[int, int]) -> F32:
    if maps is None:
        return _NONE[..., :2]
    if any(plane.shape != shape for plane in maps):
        raise InputError(f"factors: are not those of {shape[1]} × {shape[0]} pixels; give (H, W)")
    return np.stack(maps, axis=-1).astype(np.float32)


def _with(colours: F32, fourth: F32) -> F32:
    return np.concatenate([colours, fourth[..., None]], axis=-1)


def _plane(gl: GlContext, texels: F32) -> moderngl.Texture:
    height, width, channels = texels.shape
    texture = gl.moderngl.texture(
        (width, height), channels, np.ascontiguousarray(texels, "<f4").tobytes(), alignment=1, dtype="f4"
    )
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    return texture


def _layers(gl: GlContext, maps: Sequence[F32]) -> moderngl.TextureArray:
    size = maps[0].shape[0]
    texels = np.ascontiguousarray(np.stack(maps), "<f4").tobytes()
    texture = gl.moderngl.texture_array((size, size, len(maps)), 3, texels, alignment=1, dtype="f4")
    texture.repeat_x = texture.repeat_y = False
    texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
    return texture
