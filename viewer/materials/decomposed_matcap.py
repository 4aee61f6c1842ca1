"""A decomposed MatCap on the graphics card: two dual paraboloid maps whose light adds up."""

from collections.abc import Mapping, Sequence

import moderngl
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from litrig.base.errors import InputError
from processing.matcap.lights.bake import baked_matcap
from processing.matcap.model import Component, DecomposedMatcap, Turn
from processing.matcap.render import remainder_share
from processing.matcap.variation import NONE, Variation
from processing.paraboloid.chain import blur_chain, chain_side, variance_of
from viewer.gl_context import GlContext
from viewer.look import Look, Texture, UniformValue
from viewer.materials.amc import TABLE_NORMAL_CODES

F32 = NDArray[np.float32]
BOTH_OCCLUDED = (1.0, 1.0)
_NOTHING = np.zeros((1, 1, 3), np.float32)


class DecomposedMatcapMaterial:
    """Four maps and what they lack, with smaller copies.

    Parameters are told with every draw, so that they can be edited.
    """

    def __init__(self, gl: GlContext, matcap: DecomposedMatcap, variation: Variation = NONE, number: int = 0) -> None:
        """Upload, with the lights that were added.

        Parameters
        ----------
        variation : what varies over the surface
        number : drawn where the variation's materials have this number

        Raises
        ------
        InputError
            The maps are larger than the card takes, not square, or hold what are no numbers.
        """
        self._matcap = matcap = baked_matcap(matcap)
        self._variation, self._number = variation, number
        low, high = matcap.low, matcap.high
        maps = {"low_front": low.front, "low_back": low.back, "high_front": high.front, "high_back": high.back}
        for name, half_of in (("low", low), ("high", high)):
            maps[f"{name}_remainder"] = _NOTHING if half_of.remainder is None else half_of.remainder
        self._textures = upload_maps(gl, "MatCap", maps)
        self.level_count = low.front.shape[0].bit_length()
        self._rougher = tuple(
            max(most - half_of.filter_size, 0.0) for most, half_of in zip(variation.roughest, (low, high), strict=True)
        )
        if variation.roughness is not None:
            for name, half_of, more in zip(("low", "high"), (low, high), self._rougher, strict=True):
                self._textures |= _upload_blurs(gl, name, half_of, more)
        self._planes = {
            name: (switch, _upload_plane(gl, plane, smooth=name != "materials"))
            for name, switch, plane in _planes(variation)
            if plane is not None
        }

    def look(
        self,
        *,
        level: int | None = None,
        occluded: bool = False,
        occlusion: tuple[float, float] = BOTH_OCCLUDED,
        light_turn: Rotation | None = None,
    ) -> Look:
        """Say how it is drawn (the MatCap paper, section 5).

        Parameters
        ----------
        level : read this mip level everywhere; None reads the one that fits the surface's size on screen
        occluded : darken by the mesh's ambient occlusion; the variation's darkens anyhow
        occlusion : how much both do so to the low and the high frequencies, 0 to 1
        light_turn : turns the light on, view frame

        Raises
        ------
        InputError
            The level does not exist.
        """
        if level is not None and not 0 <= level < self.level_count:
            raise InputError(f"MatCap: there is no mip level {level}; there are 0 to {self.level_count - 1}")
        matcap = self._matcap
        uniforms: dict[str, UniformValue] = {
            "table_normal": TABLE_NORMAL_CODES[matcap.table_normal],
            "level": -1.0 if level is None else float(level),
            "occluded": occluded,
            "occlusion": occlusion,
        }
        for name, component in (("low", matcap.low), ("high", matcap.high)):
            uniforms |= {f"{name}.{field}": value for field, value in half(component, light_turn).items()}
        for name, more in zip(("low", "high"), self._rougher, strict=True):
            if more and self._variation.roughness is not None:
                uniforms[f"{name}.remainder_share"] = 0.0
        textures = dict(self._textures)
        for name, (_, texture) in self._planes.items():
            textures[name] = texture
        if self._variation.materials is not None:
            uniforms["material"] = float(self._number)
        if self._variation.roughness is not None:
            uniforms["filter_sizes"] = (matcap.low.filter_size, matcap.high.filter_size)
            uniforms["rougher"] = self._rougher
            uniforms["first"] = variance_of(1, chain_side(matcap.low.front.shape[0]))
        switches = frozenset(switch for switch, _ in self._planes.values())
        return Look("matcap_decomposed.frag", uniforms, textures, switches=switches)

    def release(self) -> None:
        for texture in (*self._textures.values(), *(texture for _, texture in self._planes.values())):
            texture.release()


def half(component: Component, light_turn: Rotation | None = None) -> dict[str, UniformValue]:
    """Return the fields of a `MatcapHalf` (litrig_matcap.glsl)."""
    silhouette = component.silhouette
    turn = _whole(component.light_turn_deg, light_turn)
    return {
        "base_colour": component.base_colour,
        "slope": component.slope,
        "silhouette": (float(np.radians(silhouette.start_deg)), silhouette.rise, silhouette.slope),
        "normals_back": _back(_whole(component.normal_turn_deg)),
        "light_back": _back(turn),
        "remainder_share": 0.0 if component.remainder is None else remainder_share(turn),
    }


def _whole(turn_deg: Turn, then: Rotation | None = None) -> Rotation:
    """Return a turn, and another one on top of it."""
    turn = Rotation.from_rotvec(turn_deg, degrees=True)
    return turn if then is None else then * turn


def _back(turn: Rotation) -> tuple[float, ...]:
    """Return the inverse of a turn, column by column."""
    # The inverse is the transpose, and OpenGL reads columns.
    return tuple(float(entry) for entry in turn.as_matrix().ravel())


def _planes(variation: Variation) -> Sequence[tuple[str, str, F32 | None]]:
    """Name the sampler and the switch of each plane."""
    return (
        ("low_colours", "LOW_COLOUR", variation.low_colours),
        ("high_colours", "HIGH_COLOUR", variation.high_colours),
        ("roughness", "ROUGHNESS", variation.roughness),
        ("open_map", "OPENNESS", variation.openness),
        ("materials", "MATERIALS", variation.materials),
    )


def _upload_plane(gl: GlContext, plane: F32, *, smooth: bool) -> Texture:
    """Upload what is laid on by texture coordinates; it repeats."""
    largest = int(gl.moderngl.info["GL_MAX_TEXTURE_SIZE"])
    height, width = plane.shape[:2]
    if max(height, width) > largest:
        raise InputError(f"texture: {width} × {height} pixels, but this graphics driver ends at {largest}; shrink it")
    channels = 1 if plane.ndim == 2 else plane.shape[2]
    texture = gl.moderngl.texture(
        (width, height), channels, np.ascontiguousarray(plane, "<f4").tobytes(), alignment=1, dtype="f4"
    )
    texture.repeat_x = texture.repeat_y = True
    if smooth:
        texture.build_mipmaps()
        texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
    else:
        texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    return texture


def _upload_blurs(gl: GlContext, name: str, component: Component, most: float) -> dict[str, Texture]:
    """Upload a component's maps as they are blurred, front and back, sharpest first."""
    levels = blur_chain(component.front, component.back, most)
    textures: dict[str, Texture] = {}
    for number, side in enumerate(("front", "back")):
        texels = np.ascontiguousarray(levels[:, number], "<f4")
        size = (texels.shape[2], texels.shape[1], texels.shape[0])
        texture = gl.moderngl.texture3d(size, 3, texels.tobytes(), alignment=1, dtype="f4")
        texture.repeat_x = texture.repeat_y = texture.repeat_z = False
        texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        textures[f"{name}_{side}_blurs"] = texture
    return textures


def check_maps(gl: GlContext, what: str, maps: Mapping[str, F32]) -> None:
    """Refuse maps that cannot be uploaded; `what` names them in errors.

    Raises
    ------
    InputError
        One is larger than the card takes, not square, or holds what are no numbers.
    """
    largest = int(gl.moderngl.info["GL_MAX_TEXTURE_SIZE"])
    for texels in maps.values():
        if texels.ndim != 3 or texels.shape[0] != texels.shape[1] or texels.shape[2] != 3 or not texels.size:
            raise InputError(f"{what}: an array {texels.shape} is no square map; give (S, S, 3)")
        if texels.shape[0] > largest:
            raise InputError(
                f"{what}: maps of {texels.shape[1]} × {texels.shape[0]} texels, but this graphics driver ends at "
                f"{largest}; shrink them"
            )
        if not np.all(np.isfinite(texels)):
            raise InputError(f"{what}: a map holds colours that are no numbers; mend it")


def upload_maps(gl: GlContext, what: str, maps: Mapping[str, F32]) -> dict[str, Texture]:
    """Upload square maps (S, S, 3) with smaller copies; `what` names them in errors.

    Raises
    ------
    InputError
        One is larger than the card takes, not square, or holds what are no numbers.
    """
    check_maps(gl, what, maps)
    textures: dict[str, Texture] = {}
    for name, texels in maps.items():
        texture = _empty_map(gl, texels.shape[0])
        texture.write(np.ascontiguousarray(texels, "<f4").tobytes(), alignment=1)
        texture.build_mipmaps()
        texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
        textures[name] = texture
    return textures


def _empty_map(gl: GlContext, size: int) -> moderngl.Texture:
    texture = gl.moderngl.texture((size, size), 3, alignment=1, dtype="f4")
    texture.repeat_x = texture.repeat_y = False
    return texture
