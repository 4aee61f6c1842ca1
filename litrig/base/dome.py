"""`.dome` files: the lights of a dome as RelightLab calibrates them, JSON.

`lightConfiguration` says which of three lists counts: `directional` the `directions`, `spherical` the
`positionsSphere` (or `directions` on a sphere of `domeDiameter`, whose centre lies `verticalOffset` above the sample),
`lights3d` the `positions3d`. Positions have their origin at the centre of the picture, z towards the camera, in mm
where `imageWidth` says how many of them the picture is wide, and else in widths of the picture. `ledAdjust` is what
pixel values are multiplied by. Pictures are not named: order is all there is.
"""

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import FailFast, Field

from litrig.base.config import ForeignModel, parse_json_bytes
from litrig.base.errors import FormatError
from litrig.base.files import read_limited
from litrig.base.lights import MOST_LIGHTS, Lights

F64 = NDArray[np.float64]

LARGEST_DOME_BYTES = 8_000_000
_SHORTEST = 1e-4
_LARGEST = 1e6
_MEND = "calibrate the dome again, or export an .lp"


class _Vector(ForeignModel):
    x: float
    y: float
    z: float


class _Colour(ForeignModel):
    r: float
    g: float
    b: float


_Vectors = Annotated[tuple[_Vector, ...], Field(max_length=MOST_LIGHTS), FailFast()]


class _Dome(ForeignModel):
    light_configuration: Literal["directional", "spherical", "lights3d"] = "directional"
    image_width: float = 0
    dome_diameter: float = 0
    vertical_offset: float = 0
    directions: _Vectors = ()
    positions_sphere: _Vectors = ()
    positions3d: _Vectors = Field(default=(), alias="positions3d")
    led_adjust: Annotated[tuple[_Colour, ...], Field(max_length=MOST_LIGHTS), FailFast()] = ()


def read_dome(path: Path) -> Lights:
    """Read a `.dome` file.

    Raises
    ------
    InputError
        The file is missing or unreadable.
    FormatError
        It is no JSON of a dome, holds no light of the kind that it says it has, one without direction, or a number of
        corrections that differs from the lights'.
    """
    dome = parse_json_bytes(read_limited(path, LARGEST_DOME_BYTES), _Dome, str(path))
    positions = _positions(path, dome)
    vectors = _array(dome.directions) if positions is None else positions
    if not 0 < len(vectors) <= MOST_LIGHTS:
        raise FormatError(
            f"{path}: a {dome.light_configuration} dome of {len(vectors)} lights; 1 to {MOST_LIGHTS} are read, {_MEND}"
        )
    lengths = np.linalg.norm(vectors, axis=1)
    for number, length in enumerate(lengths, 1):
        if not _SHORTEST < length < _LARGEST:
            raise FormatError(f"{path}: light {number} is at a distance of {length:g}; {_MEND}")
    return Lights(
        None,
        vectors / lengths[:, None],
        positions_mm=positions,
        picture_width_mm=_picture_width_mm(path, dome),
        gains=_gains(path, dome, len(vectors)),
    )


def _positions(path: Path, dome: _Dome) -> F64 | None:
    if dome.light_configuration == "directional":
        return None
    if dome.light_configuration == "lights3d":
        return _array(dome.positions3d)
    if dome.positions_sphere:
        return _array(dome.positions_sphere)
    if not 0 < dome.dome_diameter < _LARGEST:
        raise FormatError(f"{path}: a sphere of diameter {dome.dome_diameter:g} mm carries no lights; {_MEND}")
    directions = _array(dome.directions)
    radii = np.maximum(np.linalg.norm(directions, axis=1, keepdims=True), _SHORTEST)
    return np.asarray(directions / radii * dome.dome_diameter / 2 + np.array([0, 0, dome.vertical_offset]), np.float64)


def _picture_width_mm(path: Path, dome: _Dome) -> float | None:
    if not 0 <= dome.image_width < _LARGEST:
        raise FormatError(f"{path}: imageWidth is {dome.image_width:g} mm; measure how wide the pictures are")
    # Positions are in widths of the picture where its width is not known.
    return dome.image_width or (1.0 if dome.light_configuration == "lights3d" else None)


def _gains(path: Path, dome: _Dome, count: int) -> F64 | None:
    if not dome.led_adjust:
        return None
    gains = np.array([[colour.r, colour.g, colour.b] for colour in dome.led_adjust])
    if len(gains) != count or not np.all((gains > 0) & (gains < _LARGEST)):
        raise FormatError(f"{path}: ledAdjust should hold {count} factors above 0, one a light; {_MEND}")
    return gains


def _array(vectors: tuple[_Vector, ...]) -> F64:
    return np.array([[vector.x, vector.y, vector.z] for vector in vectors], np.float64).reshape(-1, 3)
