"""Pixels that can be used, and those that are left as they are because something in them is no use."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from processing.exr_parts import listed, require
from processing.shape.buffers.channels import MEND
from processing.shape.model import BACKGROUND

F32 = NDArray[np.float32]
Tell = Callable[[str], None]
_MOST_LEFT = 0.5
"""Share of the surfaces' pixels from which on a file is refused, for then it is wrong and not flawed."""
_MOST_OUTSIDE = 0.05
_HARDLY_OUTSIDE = 0.05
TURNED_AWAY = -0.2
"""n·v below which a normal is no silhouette's any more."""
_NO_DIRECTION = 1e-3
LARGEST = 1e15
"""Squares of more are not held in single precision."""
_MOST_COLOURS = 256


class Pixels:
    """Which pixels of surfaces can be used.

    Attributes
    ----------
    shown : (H, W), a surface is seen, and all that was checked can be used
    """

    def __init__(self, path: Path, surfaces: NDArray[np.uint32], tell: Tell) -> None:
        self._path, self._tell = path, tell
        self.shown: NDArray[np.bool_] = surfaces != BACKGROUND
        self._seen = int(np.count_nonzero(self.shown))

    def check_seen(self) -> None:
        require(self._path, self._seen > 0, f"no surface is seen in it; {MEND} with numbers of surfaces or alpha")

    def check_numbers(self, name: str, values: F32) -> None:
        """Leave pixels whose values are not finite, or so large that their squares are not."""
        usable = np.abs(values) < LARGEST
        lost: NDArray[np.bool_] = ~usable if values.ndim == 2 else ~np.asarray(usable.all(axis=-1))
        what = "the picture" if name == "picture" else f"layer {name}"
        self._leave(lost, f"{what} holds no numbers", f"{MEND} without them")

    def check_apart(self, positions: F32) -> None:
        """Leave pixels whose surface is where the camera is."""
        lost = np.linalg.norm(positions, axis=-1) == 0
        count = int(np.count_nonzero(lost & self.shown))
        self._leave(lost, f"layer position has {count} pixels in the camera itself", MEND, counted=True)

    def unit_normals(self, normals: F32) -> F32:
        """Return normals of unit length, and leave those that have none."""
        length = np.linalg.norm(normals, axis=-1, keepdims=True)
        lost = length[..., 0] < _NO_DIRECTION
        count = int(np.count_nonzero(lost & self.shown))
        self._leave(lost, f"normals of {count} pixels of surfaces have no direction", "mend them", counted=True)
        long = int(np.count_nonzero(np.abs(length[..., 0][self.shown] - 1) > 0.01))
        if long:
            self._tell(f"normals of {long} pixels are not of unit length; their direction is taken")
        unit: F32 = (normals / np.where(length < _NO_DIRECTION, 1, length)).astype(np.float32)
        return unit

    def check_facing(self, normals: F32, to_eye: F32) -> None:
        """Leave pixels whose normal looks away from the camera."""
        away = np.sum(normals * to_eye, axis=-1) < TURNED_AWAY
        count = int(np.count_nonzero(away & self.shown))
        self._leave(
            away,
            f"normals of {count} pixels of surfaces look away from the camera",
            "if they are in the world's frame, say where the camera is: --world-to-camera",
            counted=True,
        )

    def only_shown(self, values: F32) -> F32:
        """Return values with 0 where nothing can be used."""
        kept: F32 = np.where(self.shown[..., None], values, 0).astype(np.float32)
        return kept

    def _leave(self, lost: NDArray[np.bool_], what: str, mend: str, *, counted: bool = False) -> None:
        lost = lost & self.shown
        count = int(np.count_nonzero(lost))
        if not count:
            return
        said = what if counted else f"{what} in {count} pixels of surfaces"
        require(self._path, count <= _MOST_LEFT * self._seen, f"{said}; {mend}")
        self._tell(f"{said}; they are left as they are")
        self.shown &= ~lost


def surface_numbers(path: Path, names: list[str], planes: list[NDArray[Any]], tell: Tell) -> NDArray[np.uint32]:
    """Return the numbers of surfaces (H, W) from whole numbers, colours, or the bits of a Cryptomatte.

    Raises
    ------
    FormatError
        Most pixels hold nothing of the kind.
    """
    layer = names[0].rpartition(".")[0].lower()
    if "crypto" in layer and layer.endswith("00"):
        return np.ascontiguousarray(planes[0], np.float32).view(np.uint32).copy()
    if len(planes) == 3 and not all(np.array_equal(planes[0], plane) for plane in planes[1:]):
        return _numbered_colours(path, planes, tell)
    stored = planes[0]
    if np.issubdtype(stored.dtype, np.unsignedinteger):
        return stored.astype(np.uint32)
    whole = np.isfinite(stored) & (stored >= 0) & (stored == np.rint(stored)) & (stored < 2.0**24)
    lost, marked = int(np.count_nonzero(~whole)), int(np.count_nonzero(stored != 0))
    require(
        path,
        lost <= _MOST_LEFT * marked,
        f"{names[0]} holds what are no numbers of surfaces; write them as unsigned integers",
    )
    if lost:
        tell(f"{names[0]} is between two surfaces in {lost} pixels; they are left as they are")
    return np.where(whole, stored, BACKGROUND).astype(np.uint32)


def decoded_normals(normals: F32, shown: NDArray[np.bool_], tell: Tell) -> F32:
    """Bring normals that were stored as colours, (n + 1)/2, back to −1..1."""
    seen = normals[shown & (np.abs(normals) < LARGEST).all(axis=-1)]
    if not seen.size or seen.min() < 0 or seen.max() > 1:
        return normals
    as_stored, as_colour = (np.abs(np.linalg.norm(values, axis=-1) - 1) for values in (seen, 2 * seen - 1))
    if np.median(as_colour) > 0.05 or np.median(as_stored) <= np.median(as_colour):
        return normals
    tell("normals are stored as colours; 0 to 1 is taken as −1 to 1")
    decoded: F32 = (2 * normals - 1).astype(np.float32)
    return decoded


def share(path: Path, name: str, values: F32, shown: NDArray[np.bool_], tell: Tell) -> F32:
    """Return values that are between 0 and 1, as filters leave them up to a little.

    Raises
    ------
    FormatError
        Too many are far outside: the layer is something else.
    """
    finite = np.isfinite(values)
    outside = ~(finite & (values >= 0) & (values <= 1))
    count = int(np.count_nonzero(outside & shown))
    if np.any(outside):
        far = int(np.count_nonzero(outside & shown & ~(np.abs(values - 0.5) <= 0.5 + _HARDLY_OUTSIDE)))
        require(path, far <= _MOST_OUTSIDE * int(np.count_nonzero(shown)), f"{_CHANNEL[name]} leaves 0 to 1; {MEND}")
    if count:
        tell(f"{_CHANNEL[name]} leaves 0 to 1 in {count} pixels; the nearest of both is taken")
    kept: F32 = np.clip(np.where(finite, values, 0), 0, 1).astype(np.float32)
    return kept


_CHANNEL = {
    "coverage": "alpha",
    "ambient_occlusion": "ambient_occlusion.Y",
    "reflection_occlusion": "reflection_occlusion.Y",
}


def _numbered_colours(path: Path, planes: list[NDArray[Any]], tell: Tell) -> NDArray[np.uint32]:
    """Give surfaces that are told by colours the numbers 0xRRGGBB, the same in every frame; black is background."""
    colours = np.nan_to_num(np.stack(planes, axis=-1).astype(np.float32))
    height, width = colours.shape[:2]
    kinds, which, counts = np.unique(colours.reshape(-1, 3), axis=0, return_inverse=True, return_counts=True)
    codes = np.rint(np.clip(kinds, 0, 1) * 255).astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], np.uint32)
    colourful = codes != BACKGROUND
    # What filters mix at edges are colours of a few pixels.
    least = max(2, counts[colourful].sum() // 1000) if np.any(colourful) else 1
    kept = colourful & (counts >= least)
    require(
        path,
        bool(np.count_nonzero(kept) <= _MOST_COLOURS and counts[kept].sum() >= _MOST_LEFT * counts[colourful].sum()),
        f"surfaces have {np.count_nonzero(colourful)} colours; write numbers of surfaces without a filter",
    )
    alike = [int(code) for code, times in zip(*np.unique(codes[kept], return_counts=True), strict=True) if times > 1]
    require(
        path, not alike, f"surfaces {listed([f'{code:06x}' for code in alike])} differ too little in colour; {MEND}"
    )
    names = [f"{code} is {code:06x}" for code in codes[kept].tolist()]
    tell(f"surfaces are told by colours: {listed(names)}")
    return np.where(kept, codes, BACKGROUND)[np.ravel(which)].reshape(height, width).astype(np.uint32)
