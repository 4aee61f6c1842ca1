"""How a material is shown."""

from dataclasses import dataclass, field
from pathlib import Path

from litrig.base.errors import InputError
from processing.matcap.variation_files import VariationFiles
from viewer.develop import Development
from viewer.materials.amc import Coordinates
from viewer.materials.ptm_shading import PtmShading, shading_lights
from viewer.motion import Motion
from viewer.view import View

DEFAULT_SIZE_PX = (800, 800)
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
    """What is said of a PTM alone.

    Attributes
    ----------
    lights : x and y of the unit vectors to its lights, view frame; none is one from the upper left. A decomposed MatCap
        has one too: where its light from the camera is turned
    colours : of each light, linear; none is white
    softness_deg : angular radius of the lights
    diffuse_gain : of the second derivatives; 1 changes nothing
    gloss : strength and exponent of a highlight that is added
    normals : show these instead
    window : left, top, width and height of the texels that a flat picture shows; None is all
    repeat : how often it is laid across a mesh's texture coordinates, each way
    """

    lights: tuple[tuple[float, float], ...] = ()
    colours: tuple[tuple[float, float, float], ...] = ()
    softness_deg: float = 0.0
    diffuse_gain: float = 1.0
    gloss: tuple[float, float] | None = None
    normals: bool = False
    window: tuple[int, int, int, int] | None = None
    repeat: int = 1

    def shading(self) -> PtmShading:
        """Return what the material is told.

        Raises
        ------
        InputError
            Lights, colours, gain or highlight are none, or would change nothing.
        """
        if self.normals and self != PtmStaging(normals=True, window=self.window, repeat=self.repeat):
            raise InputError(
                "normals: are the same under every light; leave out the lights, --diffuse-gain and --specular, or "
                "--normals"
            )
        lights = shading_lights(self.lights, self.colours, self.softness_deg)
        return PtmShading(lights, self.diffuse_gain, self.gloss, "normals" if self.normals else "lit")


@dataclass(frozen=True)
class MatcapStaging:
    """What is said of a decomposed MatCap alone.

    Attributes
    ----------
    recipe : file of steps that are done to it first
    variation : pictures that are laid on by the mesh's texture coordinates
    others : more decomposed MatCaps, chosen by the variation's materials
    occlusion : how much ambient occlusion darkens the low and the high frequencies
    """

    recipe: Path | None = None
    variation: VariationFiles = field(default_factory=VariationFiles)
    others: tuple[Path, ...] = ()
    occlusion: tuple[float, float] = (1.0, 1.0)


@dataclass(frozen=True)
class BuffersStaging:
    """What is said of a rendered picture with its shading buffers.

    Attributes
    ----------
    environment : file of its surfaces' environments, without which nothing can be changed
    normals : file of other normals; None keeps the picture's
    diffuse_factor, reflection_factor : k_D and k_R (the Shape paper, equation 5)
    recipe : file of edits, carried out on these normals
    """

    environment: Path | None = None
    normals: Path | None = None
    diffuse_factor: float = 1.0
    reflection_factor: float = 1.0
    recipe: Path | None = None


@dataclass(frozen=True)
class Staging:
    """How a material is shown.

    Attributes
    ----------
    mesh : name of a builtin mesh, or a mesh file; None is a torus, and flat for a PTM
    size_px : width and height; None is 800 by 800, or the PTM's own size if it is flat
    background_srgb : colour behind the object, display values 0..1; None is transparent
    supersample : draw so many times finer and average
    amc : what is said of an AMC alone
    ptm : what is said of a PTM alone
    buffers : what is said of a rendered picture alone
    matcap : what is said of a decomposed MatCap alone
    occluded : darken by the mesh's ambient occlusion
    tangents : draw the mesh's tangents over it
    beside : another material file, drawn to the right on the same mesh in the same view
    development : exposure and tone curve
    motion : what moves, and for how many frames, if a video is made
    mesh_options : what was asked for, by its option's name, that means something on a mesh only
    """

    mesh: str | None = None
    size_px: tuple[int, int] | None = None
    view: View = field(default_factory=lambda: View(pitch_deg=30))
    background_srgb: tuple[float, float, float] | None = DARK_GREY
    supersample: int = 3
    amc: AmcStaging = field(default_factory=AmcStaging)
    ptm: PtmStaging = field(default_factory=PtmStaging)
    buffers: BuffersStaging = field(default_factory=BuffersStaging)
    matcap: MatcapStaging = field(default_factory=MatcapStaging)
    occluded: bool = False
    tangents: bool = False
    beside: Path | None = None
    development: Development = field(default_factory=Development)
    motion: Motion | None = None
    mesh_options: tuple[str, ...] = ()
