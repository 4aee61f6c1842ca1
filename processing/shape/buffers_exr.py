"""Shading buffers as renderers write them: one OpenEXR with a layer for each.

Read by these names: the picture `R G B A`, `diffuse.R/G/B`, `reflection.R/G/B`, `normal.X/Y/Z`, `position.X/Y/Z`,
`surface_id.I`, and `ambient_occlusion.Y`, `reflection_occlusion.Y`, which may be missing where nothing is occluded.
Normals and positions are in the view frame, or in the world's where the header has `worldToCamera`.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
from numpy.typing import NDArray

from litrig.base.errors import FormatError, InputError
from litrig.base.quiet import quiet_library
from processing.exr_parts import check_budget, listed, require
from processing.shape.model import BACKGROUND, ShadingBuffers

F32 = NDArray[np.float32]
Channels = Mapping[str, NDArray[Any]]

LARGEST_PIXELS = 100_000_000
_LARGEST_BYTES = 16 << 30
_MEND = "render it again"
_LAYERS = {
    "picture": ("R", "G", "B"),
    **{name: tuple(f"{name}.{part}" for part in "RGB") for name in ("diffuse", "reflection")},
    **{name: tuple(f"{name}.{part}" for part in "XYZ") for name in ("normal", "position")},
}
_SURFACE = "surface_id.I"
_OCCLUSIONS = ("ambient_occlusion.Y", "reflection_occlusion.Y")
_NORMAL_NAMES = (_LAYERS["normal"], ("X", "Y", "Z"), ("R", "G", "B"))


def read_buffers(path: Path) -> ShadingBuffers:
    """Read shading buffers.

    Raises
    ------
    InputError
        The file cannot be read.
    FormatError
        It is no EXR, lacks a buffer, or holds what is no number where a surface is seen.
    """
    channels, world_to_camera = _read(path)
    wanted = [name for names in _LAYERS.values() for name in names] + [_SURFACE]
    missing = [name for name in wanted if name not in channels]
    require(path, not missing, f"lacks {listed(missing)}; render the picture with these buffers")
    surfaces = _surfaces(path, channels[_SURFACE])
    shown = surfaces != BACKGROUND
    planes = {name: _stacked(channels, names) for name, names in _LAYERS.items()}
    require(
        path, bool(np.all(np.isfinite(planes["picture"]))), f"holds pixels that are no numbers; {_MEND} without them"
    )
    for name in ("diffuse", "reflection", "normal", "position"):
        lost = int(np.count_nonzero(~np.isfinite(planes[name][shown]).all(axis=-1)))
        require(path, not lost, f"layer {name} holds no numbers in {lost} pixels of surfaces; {_MEND} without them")
        planes[name] = np.where(shown[..., None], planes[name], 0).astype(np.float32)
    if world_to_camera is not None:
        planes["normal"] = (planes["normal"] @ world_to_camera[:3, :3]).astype(np.float32)
        moved = planes["position"] @ world_to_camera[:3, :3] + world_to_camera[3, :3]
        planes["position"] = np.where(shown[..., None], moved, 0).astype(np.float32)
    at_eye = int(np.count_nonzero(np.linalg.norm(planes["position"][shown], axis=-1) == 0))
    require(path, not at_eye, f"layer position has {at_eye} pixels in the camera itself; {_MEND}")
    ambient, reflected = (_share(path, channels, name, np.ones(shown.shape, np.float32)) for name in _OCCLUSIONS)
    return ShadingBuffers(
        picture=planes["picture"],
        coverage=_share(path, channels, "A", shown.astype(np.float32)),
        diffuse=planes["diffuse"],
        reflection=planes["reflection"],
        normals=_unit(path, planes["normal"], shown),
        positions=planes["position"],
        surfaces=surfaces,
        ambient_occlusion=ambient,
        reflection_occlusion=reflected,
    )


def read_normals(path: Path, buffers: ShadingBuffers) -> F32:
    """Read other normals for the surfaces of a picture, (H, W, 3): `normal.X/Y/Z`, `X Y Z` or `R G B`, signed.

    They are in the same frame as the picture's: the world's if the header has `worldToCamera`.

    Raises
    ------
    InputError, FormatError
        The file cannot be read, is damaged or of another size, or holds no directions where a surface is seen.
    """
    channels, world_to_camera = _read(path)
    names = next((names for names in _NORMAL_NAMES if all(name in channels for name in names)), None)
    if names is None:
        raise FormatError(f"{path}: holds no normals (found {listed(sorted(channels))}); name them normal.X/Y/Z")
    normals = _stacked(channels, names)
    height, width = buffers.shape
    if normals.shape[:2] != (height, width):
        raise InputError(
            f"{path}: {normals.shape[1]} × {normals.shape[0]} normals for a picture of {width} × {height} pixels; give "
            "one a pixel"
        )
    shown = buffers.surfaces != BACKGROUND
    lost = int(np.count_nonzero(~np.isfinite(normals[shown]).all(axis=-1)))
    require(path, not lost, f"holds no numbers in {lost} pixels of surfaces; mend it")
    normals = np.where(shown[..., None], normals, 0).astype(np.float32)
    if world_to_camera is not None:
        normals = (normals @ world_to_camera[:3, :3]).astype(np.float32)
    return _unit(path, normals, shown)


def _read(path: Path) -> tuple[Channels, NDArray[np.float64] | None]:
    """Read all channels of the one part, after its head was found to be true to its size."""
    try:
        with path.open("rb"):
            pass
        with quiet_library(), OpenEXR.File(str(path), separate_channels=True, header_only=True) as exr:
            parts, header = len(exr.parts), exr.parts[0].header
            (left, top), (right, bottom) = (corner.tolist() for corner in header["dataWindow"])
            display = [corner.tolist() for corner in header["displayWindow"]]
            count = len(header["channels"])
            camera = header.get("worldToCamera")
        require(path, parts == 1, f"has {parts} parts; write the layers into one")
        require(
            path,
            [[left, top], [right, bottom]] == display,
            "is a cropped picture; render the whole, data window and display window alike",
        )
        width, height = right - left + 1, bottom - top + 1
        require(path, width * height <= LARGEST_PIXELS, f"claims {width} × {height} pixels; refused")
        check_budget(path, 4 * count * width * height, _LARGEST_BYTES)
        with quiet_library(), OpenEXR.File(str(path), separate_channels=True) as exr:
            channels = {name: np.asarray(channel.pixels) for name, channel in exr.channels().items()}
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file; check the path") from error
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path") from error
    except (RuntimeError, ValueError, LookupError, TypeError) as error:
        raise FormatError(f"{path}: no EXR, or a damaged one ({error}); {_MEND}") from error
    broken = [name for name, values in channels.items() if values.shape != (height, width)]
    require(path, bool(channels) and not broken, f"damaged EXR ({listed(broken) or 'no channel'}); copy it again")
    return channels, None if camera is None else _matrix(path, camera)


def _matrix(path: Path, stored: Any) -> NDArray[np.float64]:
    matrix = np.asarray(stored, np.float64)
    good = matrix.shape == (4, 4) and bool(np.all(np.isfinite(matrix)))
    turn = matrix[:3, :3] if good else np.zeros((3, 3))
    require(
        path,
        bool(np.allclose(turn @ turn.T, np.eye(3), atol=1e-3)),
        "worldToCamera is no rotation and translation; write it without scale",
    )
    return matrix


def _stacked(channels: Channels, names: tuple[str, ...]) -> F32:
    return np.stack([channels[name].astype(np.float32) for name in names], axis=-1)


def _surfaces(path: Path, stored: NDArray[Any]) -> NDArray[np.uint32]:
    whole = np.issubdtype(stored.dtype, np.unsignedinteger) or bool(
        np.all(np.isfinite(stored) & (stored >= 0) & (stored == np.rint(stored)) & (stored < 2.0**24))
    )
    require(path, whole, f"{_SURFACE} holds what are no numbers of surfaces; write them as unsigned integers")
    return stored.astype(np.uint32)


def _share(path: Path, channels: Channels, name: str, missing: F32) -> F32:
    if name not in channels:
        return missing
    values = channels[name].astype(np.float32)
    require(path, bool(np.all((values >= 0) & (values <= 1))), f"{name} leaves 0 to 1; {_MEND}")
    return values


def _unit(path: Path, normals: F32, shown: NDArray[np.bool_]) -> F32:
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    lost = int(np.count_nonzero(length[shown] < 1e-3))
    require(path, not lost, f"normals of {lost} pixels of surfaces have no direction; mend them")
    unit: F32 = (normals / np.where(length < 1e-3, 1, length)).astype(np.float32)
    return unit
