"""How a PTM is shaded: under which lights, and what is made of it."""

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from litrig.base.errors import InputError
from processing.ptm.basis import PTM, Basis
from processing.ptm.relighting.lights import Lights, lamps
from viewer.look import UniformValue

Light = tuple[float, float]
DEFAULT_LIGHT: Light = (-0.4, 0.4)
MOST_LIGHTS = 64
"""As many as the shader has room for (`ptm.glsl`)."""
SOFT_SAMPLES = 16
"""A soft light is so many hard ones."""


@dataclass(frozen=True)
class PtmShading:
    """How a PTM is shaded.

    Attributes
    ----------
    lights : distant ones, at most MOST_LIGHTS
    diffuse_gain : g of the second derivatives about each pixel's brightest light; 1 changes nothing
    gloss : strength and exponent of a Blinn–Phong lobe on the estimated normals, added to the values; None adds none
    view : "lit", or "normals": ½ + ½n as display values, n in the view frame
    """

    lights: Lights = field(default_factory=lambda: lamps([DEFAULT_LIGHT]))
    diffuse_gain: float = 1.0
    gloss: tuple[float, float] | None = None
    view: Literal["lit", "normals"] = "lit"

    def __post_init__(self) -> None:
        count = len(self.lights.directions)
        if not 1 <= count <= MOST_LIGHTS:
            raise InputError(
                f"lights: {count} are outside 1..{MOST_LIGHTS}; give fewer lights, a soft one counts {SOFT_SAMPLES}"
            )
        if not (math.isfinite(self.diffuse_gain) and self.diffuse_gain >= 0):
            raise InputError(f"diffuse gain: {self.diffuse_gain:g} is no gain; give 0 or more, 1 changes nothing")
        if self.gloss is not None and not (
            all(map(math.isfinite, self.gloss)) and self.gloss[0] >= 0 and self.gloss[1] > 0
        ):
            raise InputError(
                f"highlight: strength {self.gloss[0]:g} and exponent {self.gloss[1]:g} make none; give a strength of 0 "
                "or more, and an exponent above 0"
            )

    @property
    def needs_normals(self) -> bool:
        return self.view == "normals" or self.gloss is not None

    @property
    def needs_brightest(self) -> bool:
        return self.view == "lit" and self.diffuse_gain != 1

    @property
    def is_one_plain_light(self) -> bool:
        """Tell whether what is stored can be shown as it is, without a detour by linear light."""
        return len(self.lights.directions) == 1 and bool(np.all(self.lights.colours == 1))

    def check(self, basis: Basis) -> None:
        """Refuse a basis that cannot be shaded so.

        Raises
        ------
        InputError
            Diffuse gain was asked for, and the basis has no second derivatives.
        """
        if self.needs_brightest and basis != PTM:
            raise InputError(
                f"PTM: is a {basis}, and diffuse gain scales the second derivatives of a {PTM}; leave the gain out, or "
                "use a highlight"
            )

    def switches(self, basis: Basis, *, is_luminance: bool) -> frozenset[str]:
        """Name what the shaders are to be compiled with."""
        chosen = {f"TERMS {basis.terms}"}
        if basis.kind == "hsh":
            chosen.add("HSH")
        if self.view == "normals":
            return frozenset(chosen | {"NORMALS"})
        if is_luminance:
            chosen.add("LUMINANCE")
        if self.needs_brightest:
            chosen.add("GAIN")
        if self.gloss is not None:
            chosen.add("GLOSS")
        return frozenset(chosen)

    def controls(self) -> dict[str, UniformValue]:
        """Return what the shaders are told of gain and highlight."""
        told: dict[str, UniformValue] = {}
        if self.view == "normals":
            return told
        if self.needs_brightest:
            told["diffuse_gain"] = self.diffuse_gain
        if self.gloss is not None:
            told["gloss"] = self.gloss
        return told

    def light_array(self) -> dict[str, UniformValue]:
        """Return what the shaders are told of the lights, where they add up."""
        count = len(self.lights.directions)
        padding = ((0, MOST_LIGHTS - count), (0, 0))
        return {
            "light_count": count,
            "light_directions": tuple(map(tuple, np.pad(self.lights.directions, padding).tolist())),
            "light_colours": tuple(map(tuple, np.pad(self.lights.colours, padding).tolist())),
        }


def shading_lights(
    positions: tuple[Light, ...], colours: tuple[tuple[float, float, float], ...] = (), softness_deg: float = 0.0
) -> Lights:
    """Make lights of their (u, v), white unless each has a colour, with discs of an angular radius.

    Raises
    ------
    InputError
        A light is outside the unit disc, colours and lights are not as many, or softness or colours are no numbers.
    """
    for u, v in positions:
        if not u**2 + v**2 <= 1:
            raise InputError(f"light: ({u:g}, {v:g}) is no direction; give x and y of a unit vector, x² + y² ≤ 1")
    chosen = positions or (DEFAULT_LIGHT,)
    if colours and len(colours) != len(chosen):
        raise InputError(f"lights: {len(chosen)} of them and {len(colours)} colours; give one for each")
    if not all(math.isfinite(part) and part >= 0 for colour in colours for part in colour):
        raise InputError("lights: a colour below 0, or of no numbers; give linear light, 1 is the lamp of the capture")
    if not 0 <= softness_deg <= 90:
        raise InputError(f"lights: a softness of {softness_deg:g} deg is outside 0..90 deg; give the disc's radius")
    return lamps(chosen, colours).softened(softness_deg, SOFT_SAMPLES)
