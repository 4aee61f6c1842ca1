"""What can be done to the normals of a rendered picture, as a recipe says it."""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from litrig.base.config import StrictModel

Across = Literal["screen", "positions"]
_Positive = Annotated[float, Field(gt=0)]
_Factor = Annotated[float, Field(ge=0)]


class Operation(StrictModel):
    """What all operations have in common."""

    strength: Annotated[float, Field(ge=0, le=1)] = 1.0
    """How far to go: 0 changes nothing."""
    surfaces: tuple[Annotated[int, Field(ge=1)], ...] = ()
    """Numbers of the surfaces that it is for; none is all."""
    mask: Path | None = None
    """Picture of the buffers' size, by which strength is multiplied: black 0, white 1."""


class Emboss(Operation):
    """Let surfaces bulge: β·n_z in place of n_z (the Shape paper, section 5)."""

    op: Literal["emboss"] = "emboss"
    beta: Annotated[float, Field(gt=0, le=1)]
    """1 changes nothing."""


class Relief(Operation):
    """What all reliefs have in common: a height at each place; lengths are all in one unit."""

    across: Across = "screen"
    """Where the relief lies: on the screen, lengths in pixels; or in the scene, lengths in its unit."""
    displace: bool = False
    """Move positions and derive normals from them, in place of tilting normals; for small heights, in the scene."""

    @model_validator(mode="after")
    def _displaces_positions(self) -> "Relief":
        if self.displace and self.across != "positions":
            raise ValueError('displacement is for reliefs in the scene; write across = "positions"')
        return self


class Bump(Relief):
    """A height map, or a decal."""

    op: Literal["bump"] = "bump"
    height: float | None = None
    """Of white over black; a twentieth of the size if left out."""
    heights: Path
    """Picture whose stored values are heights."""
    at: tuple[float, float] | None = None
    """Column and row of its middle in the picture; the middle of the picture if left out."""
    size: _Positive | None = None
    """Its width; that of the picture if left out, on the screen."""
    turn_deg: float = 0.0
    """Counter-clockwise."""
    repeat: bool = False
    """Lay it like tiles."""

    @model_validator(mode="after")
    def _says_its_size(self) -> "Bump":
        if self.size is None and self.across == "positions":
            raise ValueError("a decal in the scene has a size in its unit; give size")
        return self


class Noise(Relief):
    """Gradient noise, as Perlin's."""

    op: Literal["noise"] = "noise"
    height: float
    """Of its largest features."""
    scale: _Positive
    """Length of its largest features."""
    octaves: Annotated[int, Field(ge=1, le=12)] = 3
    """Each has features half as long and half as high as the one before."""
    seed: Annotated[int, Field(ge=0, lt=1 << 32)] = 0


class Ripple(Relief):
    """A wave around a point that fades with the distance (the Shape paper, figure 10)."""

    op: Literal["ripple"] = "ripple"
    height: float
    """Amplitude at the middle."""
    at: tuple[float, float]
    """Column and row of its middle."""
    wavelength: _Positive
    fade: _Positive
    """Distance over which it falls to 1/e."""
    phase_deg: float = 0.0


class Smooth(Operation):
    """Average normals that are near in the picture and in depth (the Shape paper, section 5)."""

    op: Literal["smooth"] = "smooth"
    radius: Annotated[float, Field(gt=0, le=100)]
    """Standard deviation in pixels."""
    depth_radius: _Positive | None = None
    """Standard deviation in depth; by what a surface's depth changes over the radius, if left out."""


class Painted(Operation):
    """Normals that were made elsewhere."""

    op: Literal["normals"] = "normals"
    file: Path
    """EXR of signed components, or a PNG or TIFF in which 0..1 stands for −1..1; of the buffers' size."""
    space: Literal["view", "surface"] = "view"
    """`surface`: z is the surface's own normal, to which they are added as detail."""
    green: Literal["up", "down"] = "up"


class Factors(Operation):
    """Scale the two parts of the shading: k_D and k_R of equation 5."""

    op: Literal["factors"] = "factors"
    diffuse: _Factor = 1.0
    reflection: _Factor = 1.0


AnyOperation = Annotated[Emboss | Bump | Noise | Ripple | Smooth | Painted | Factors, Field(discriminator="op")]


class Recipe(StrictModel):
    """Steps, each done to what the one before left. Files are named as seen from the recipe's folder."""

    kind: Literal["shape"] = "shape"

    steps: tuple[AnyOperation, ...] = ()
