"""Shading buffers as renderers write them: one OpenEXR with a layer for each, in one part or in many.

litrig's own names are the picture `R G B A`, `diffuse.R/G/B`, `reflection.R/G/B`, `normal.X/Y/Z`, `position.X/Y/Z` or
`depth.Z`, `surface_id.I`, `ambient_occlusion.Y`, `reflection_occlusion.Y`, `albedo.R/G/B` and
`reflection_albedo.R/G/B`; other renderers' are in `buffers.names`. Picture, diffuse shading and normals must be there;
what else is missing is said, and done without.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import FormatError, InputError
from processing.exr_parts import listed, require
from processing.shape.buffers.alpha import straightened
from processing.shape.buffers.camera import CameraSaid, world_to_camera
from processing.shape.buffers.channels import Stored, read_channels
from processing.shape.buffers.layers import Found, Layers, find_buffers
from processing.shape.buffers.names import BUFFERS, DIALECTS, Recipe, parse_recipe
from processing.shape.buffers.pixels import LARGEST, Pixels, decoded_normals, share, surface_numbers
from processing.shape.buffers.view import view_of
from processing.shape.model import BACKGROUND, ShadingBuffers

F32 = NDArray[np.float32]
Tell = Callable[[str], None]
NORMALS = "normals"
"""Kind of the files that litrig writes normals to, in the view frame."""
_NEEDED = {
    "picture": ("R", "G", "B"),
    "diffuse": ("diffuse.R", "diffuse.G", "diffuse.B"),
    "normal": ("normal.X", "normal.Y", "normal.Z"),
}
_NORMAL_RECIPES = tuple(recipe for names in DIALECTS.values() for recipe in names.get("normal", ()))


@dataclass(frozen=True)
class ReadOptions:
    """What the user says of a file.

    Attributes
    ----------
    layers : by buffer, the layers it is made of
    camera : how it was seen
    may_be_empty : that no surface is seen is no mistake, as in a frame of a sequence
    """

    layers: Mapping[str, Recipe] = field(default_factory=dict)
    camera: CameraSaid = field(default_factory=CameraSaid)
    may_be_empty: bool = False


def parse_layers(words: tuple[str, ...]) -> dict[str, Recipe]:
    """Read `reflection=spec_all`, `diffuse=light_direct + light_indirect * albedo` and the like.

    Raises
    ------
    InputError
        There is no such buffer, or nothing that could name a layer.
    """
    said = {}
    for word in words:
        buffer, _, layers = word.partition("=")
        try:
            said[buffer.strip()] = parse_recipe(layers)
        except ValueError as error:
            raise InputError(f"--layer {word}: {error}; write BUFFER=LAYER") from error
        if buffer.strip() not in BUFFERS:
            raise InputError(f"--layer {word}: no buffer is called {buffer.strip()}; there are {', '.join(BUFFERS)}")
    return said


def read_buffers(path: Path, options: ReadOptions | None = None, tell: Tell | None = None) -> ShadingBuffers:
    """Read shading buffers.

    Parameters
    ----------
    options : which layers to take, and what is known of the camera
    tell : called with each remark: what is missing and how it is done without, and what pixels are left as they are

    Raises
    ------
    InputError
        The file cannot be read, or a layer that was named is not there.
    FormatError
        It is no EXR, lacks a buffer that nothing can stand in for, or most of its surfaces' pixels cannot be used.
    """
    options, tell = options or ReadOptions(), tell or (lambda _: None)
    stored = read_channels(path)
    layers = Layers(stored.planes)
    found = find_buffers(layers, options.layers)
    _check_found(path, found, options.layers, layers)
    if stored.cropped:
        tell("the file holds another part than the whole picture; what it lacks is taken as background")
    made = {name: layers.make(one.recipe, name) for name, one in found.items() if name not in _UNREAD}
    surfaces, coverage = _surfaces(path, layers, found, made, tell)
    pixels = Pixels(path, surfaces, tell)
    if not options.may_be_empty:
        pixels.check_seen()
    for name in ("picture", "diffuse", "reflection", "normal", "albedo", "reflection_albedo"):
        if name in made:
            pixels.check_numbers(name, made[name])
    made = straightened(made, coverage, pixels.shown, tell)
    normals = decoded_normals(made["normal"], pixels.shown, tell)
    seen = view_of(path, stored, found, made, options.camera, pixels, tell)
    turn = seen.turn.astype(np.float32)
    normals = pixels.unit_normals(np.where(pixels.shown[..., None], normals, 0) @ turn)
    missing = [name for name in ("reflection", "ambient_occlusion", "reflection_occlusion") if name not in made]
    _tell_missing(missing, tell)
    ones = np.ones(surfaces.shape, np.float32)
    zeros = np.zeros((*surfaces.shape, 3), np.float32)
    ambient, reflected = (
        share(path, name, made[name], pixels.shown, tell) if name in made else ones
        for name in ("ambient_occlusion", "reflection_occlusion")
    )
    read = ShadingBuffers(
        picture=made["picture"],
        coverage=share(path, "coverage", coverage, pixels.shown, tell),
        diffuse=pixels.only_shown(made["diffuse"]),
        reflection=pixels.only_shown(made.get("reflection", zeros)),
        normals=normals,
        positions=pixels.only_shown(seen.positions),
        surfaces=surfaces,
        ambient_occlusion=ambient,
        reflection_occlusion=reflected,
        albedo=pixels.only_shown(made["albedo"]) if "albedo" in made else None,
        reflection_albedo=pixels.only_shown(made["reflection_albedo"]) if "reflection_albedo" in made else None,
        orthographic=seen.orthographic,
        stored_turn=None if _said_in_header(path, stored, options) else _rows(seen.turn),
    )
    pixels.check_facing(read.normals, read.to_eye)
    left = pixels.shown != (surfaces != BACKGROUND)
    surfaces[left] = BACKGROUND
    for name in ("diffuse", "reflection"):
        dark = int(np.count_nonzero((getattr(read, name)[pixels.shown] < 0).any(axis=-1)))
        if dark:
            tell(f"layer {name} is negative in {dark} pixels; editing makes them no darker")
    return read


def read_normals(path: Path, buffers: ShadingBuffers, tell: Tell | None = None, *, in_surface: bool = False) -> F32:
    """Read other normals for the surfaces of a picture, (H, W, 3): `normal.X/Y/Z`, bare `X Y Z` or `R G B`, signed.

    Any renderer's name for normals will do. They are in the same frame as the picture's: the world's if the header has
    `worldToCamera`, or if for the picture the user said where the camera is; but litrig's own are in the view frame.
    Where the picture's own normals cannot be used, neither are these.

    Parameters
    ----------
    in_surface : they are in no such frame, for z is the surface's own normal

    Raises
    ------
    InputError, FormatError
        The file cannot be read, is damaged or of another size, or holds no directions where a surface is seen.
    """
    stored = read_channels(path)
    layers = Layers(stored.planes)
    fits = (layers.resolve(recipe, "normal") for recipe in _NORMAL_RECIPES)
    recipe = next((recipe for recipe in fits if recipe is not None), None)
    bare = next((names for names in ("XYZ", "RGB") if all(name in stored.planes for name in names)), None)
    if recipe is None and bare is None:
        raise FormatError(f"{path}: holds no normals (found {listed(sorted(stored.planes))}); name them normal.X/Y/Z")
    if recipe is not None:
        normals = layers.make(recipe, "normal")
    else:
        normals = np.stack([stored.planes[name].astype(np.float32) for name in bare or ""], axis=-1)
    height, width = buffers.shape
    if normals.shape[:2] != (height, width):
        raise InputError(
            f"{path}: {normals.shape[1]} × {normals.shape[0]} normals for a picture of {width} × {height} pixels; give "
            "one a pixel"
        )
    shown = buffers.surfaces != BACKGROUND
    lost = int(np.count_nonzero(~(np.abs(normals[shown]) < LARGEST).all(axis=-1)))
    require(path, not lost, f"holds no numbers in {lost} pixels of surfaces; mend it")
    normals = decoded_normals(normals, shown, tell or (lambda _: None))
    normals = np.where(shown[..., None], normals, 0).astype(np.float32)
    matrix = world_to_camera(path, stored.header, CameraSaid())
    if matrix is not None:
        normals = (normals @ matrix[:3, :3]).astype(np.float32)
    elif buffers.stored_turn is not None and not in_surface and stored.header.get("litrig.kind") != NORMALS:
        normals = (normals @ np.array(buffers.stored_turn)).astype(np.float32)
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    flat = int(np.count_nonzero(length[shown] < 1e-3))
    require(path, not flat, f"normals of {flat} pixels of surfaces have no direction; mend them")
    unit: F32 = (normals / np.where(length < 1e-3, 1, length)).astype(np.float32)
    return unit


def _said_in_header(path: Path, stored: Stored, options: ReadOptions) -> bool:
    said = options.camera.world_to_camera is not None
    return not said and world_to_camera(path, stored.header, CameraSaid()) is not None


def _rows(turn: NDArray[np.float64]) -> tuple[tuple[float, ...], ...] | None:
    return None if np.array_equal(turn, np.eye(3)) else tuple(tuple(row) for row in turn.tolist())


_UNREAD = frozenset({"surface_id", "emission", "transparency"})


def _check_found(path: Path, found: Mapping[str, Found], said: Mapping[str, Recipe], layers: Layers) -> None:
    for name in said:
        if name not in found:
            raise InputError(
                f"{path}: has no layers {said[name]} that could be its {name}; it has "
                f"{listed([layer or 'R G B' for layer in layers.names])}"
            )
    missing = [channel for name, channels in _NEEDED.items() if name not in found for channel in channels]
    require(path, not missing, f"lacks {listed(missing)}; render the picture with these buffers, or name them: --layer")


def _surfaces(
    path: Path, layers: Layers, found: Mapping[str, Found], made: Mapping[str, F32], tell: Tell
) -> tuple[NDArray[np.uint32], F32]:
    """Return the numbers of surfaces, and coverage; one stands in for the other."""
    if "surface_id" in found:
        layer = found["surface_id"].recipe.terms[0]
        names = layers.channel_names(layer, "surface_id")
        surfaces = surface_numbers(path, names, layers.channels(layer, "surface_id"), tell)
        if "coverage" in made:
            return surfaces, made["coverage"]
        tell("no alpha: what has a surface covers its pixels")
        return surfaces, (surfaces != BACKGROUND).astype(np.float32)
    tell("no numbers of surfaces: all that is covered is taken as surface 1")
    if "coverage" in made:
        return (made["coverage"] > 0).astype(np.uint32), made["coverage"]
    tell("no alpha: what has a normal covers its pixels")
    covered = np.linalg.norm(np.nan_to_num(made["normal"]), axis=-1) > 1e-3
    return covered.astype(np.uint32), covered.astype(np.float32)


def _tell_missing(missing: list[str], tell: Tell) -> None:
    without = {
        "reflection": "no reflection: the diffuse shading alone is edited",
        "ambient_occlusion": "no ambient occlusion: diffuse shading is taken as open everywhere",
        "reflection_occlusion": "no reflection occlusion: reflections are taken as open everywhere",
    }
    for name in missing:
        tell(without[name])
