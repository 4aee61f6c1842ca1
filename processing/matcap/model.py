"""A MatCap taken apart (MatCap Decomposition for Dynamic Appearance Manipulation, sections 3 and 4)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.table_normals import TableNormal
from processing.matcap.lights.model import Hung, Light
from processing.matcap.silhouette import PLAIN, Silhouette

F32 = NDArray[np.float32]
Colour = tuple[float, float, float]
Turn = tuple[float, float, float]
STILL: Turn = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Component:
    """The low or the high frequencies: white light that a material's filter has blurred, over all directions.

    Attributes
    ----------
    front, back : (S, S, 3) float32, linear light, white-balanced; a dual paraboloid map as `paraboloid.maps` has it
    base_colour : α₀, the material's colour, linear
    slope : μ, 0 to 1. What is seen at an angle θ off the view axis lies at θ·(1 + μ) in the maps
    filter_size : ν, the variance of the material's filter in radians squared
    silhouette : what is added to the base colour towards the silhouette
    light_turn_deg : the turn of the light, about the axis of this vector by its length in degrees, view frame
    normal_turn_deg : another one, of what the maps show at a normal, as the MatCap paper's section 5.1 words it
    lights, pictures : added to the maps' light, in the maps' frame, before the filter
    remainder : (P, P, 3) float32, what the maps lack of the disc that they were made of, white-balanced like them; it
        may be negative. None is nothing
    """

    front: F32
    back: F32
    base_colour: Colour
    slope: float
    filter_size: float
    silhouette: Silhouette = PLAIN
    light_turn_deg: Turn = STILL
    normal_turn_deg: Turn = STILL
    lights: tuple[Light, ...] = ()
    pictures: tuple[Hung, ...] = ()
    remainder: F32 | None = None


@dataclass(frozen=True)
class DecomposedMatcap:
    """The sum of two components.

    Attributes
    ----------
    low, high : components, whose maps are of one size
    table_normal : how a perspective picture's normal is brought to the view axis before the maps are asked
    source : digest of the MatCap that was taken apart
    picture_size : side of its picture in pixels; None if nobody said
    """

    low: Component
    high: Component
    table_normal: TableNormal = TableNormal.RECTIFIED
    source: str = ""
    picture_size: int | None = None
