"""How a material is shown."""

from dataclasses import dataclass, field
from pathlib import Path

from viewer.materials.amc import Coordinates
from viewer.view import View

DEFAULT_SIZE_PX = (800, 800)
DEFAULT_LIGHT = (-0.4, 0.4)
DEFAULT_MESH = "torus"
DARK_GREY = (0x20 / 255, 0x21 / 255, 0x24 / 255)


@dataclass(frozen=True)
class AmcStaging:
    """What is said of an AMC alone.

    Attributes
    ----------
    directions : picture of the grain's direction on the mesh, as `read_directions` reads it; None is the mesh's own
    turn_deg : then turns the grain in the surface, counter-clockwise seen from outside
    coordinates : where i, j and k are found
    unlit : AMC file of the same material without the key light, shown where the key light is in shadow
    key : x and y of the unit vector to the key light, view frame
    add : AMC file whose light is added, the other half of a split material
    """

    directions: Path | None = None
    turn_deg: float = 0.0
    coordinates: Coordinates = Coordinates.FRAGMENT
    unlit: Path | None = None
    key: tuple[float, float] | None = None
    add: Path | None = None


@dataclass(frozen=True)
class PtmStaging:
    """What is said of a PTM on a mesh alone.

    Attributes
    ----------
    highlight : strength, where 1 is white, and exponent of a highlight that is added; None adds none
    repeat : how often the picture repeats across the mesh's texture coordinates, each way
    """

    highlight: tuple[float, float] | None = None
    repeat: int = 1


@dataclass(frozen=True)
class Staging:
    """How a material is shown.

    Attributes
    ----------
    mesh : name of a builtin mesh, or a mesh file; None is a torus, and flat for a PTM
    light : x and y of the unit vector to a PTM's light, view frame; None is one from the upper left
    size_px : width and height; None is 800 by 800, or the PTM's own size if it is flat
    background_srgb : colour behind the object, display values 0..1; None is transparent
    supersample : draw so many times finer and average
    amc : what is said of an AMC alone
    occluded : darken by the mesh's ambient occlusion
    tangents : draw the mesh's tangents over it
    beside : another material file, drawn to the right on the same mesh in the same view
    ptm : what is said of a PTM alone
    mesh_options : what was asked for, by its option's name, that means something on a mesh only
    """

    mesh: str | None = None
    light: tuple[float, float] | None = None
    size_px: tuple[int, int] | None = None
    view: View = field(default_factory=lambda: View(pitch_deg=30))
    background_srgb: tuple[float, float, float] | None = DARK_GREY
    supersample: int = 3
    amc: AmcStaging = field(default_factory=AmcStaging)
    occluded: bool = False
    tangents: bool = False
    beside: Path | None = None
    ptm: PtmStaging = field(default_factory=PtmStaging)
    mesh_options: tuple[str, ...] = ()
