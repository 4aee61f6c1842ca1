"""What a scene for mitsuba is made of."""

from typing import Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

Sample = Literal["brushed-metal", "fabric", "relief", "chrome-ball", "white-card"]
Brushing = Literal["parallels", "circular", "tilted-pole"]
Invariance = Literal[1, 2, 3, 4, "isotropic"]


class MitsubaScene(BaseModel):
    """A sample on the turntable, rendered physically. Pixel figures are those of a picture of 640 × 480."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True, allow_inf_nan=False)

    kind: Literal["mitsuba"] = "mitsuba"
    sample: Sample = "brushed-metal"
    """What lies on the table: three kinds of spheres, a slab with a relief, a white card."""
    metal: Literal["aluminium", "gold"] = "aluminium"
    """Of the brushed sphere."""
    roughness_along: float = Field(default=0.12, gt=0.01, le=1)
    """GGX roughness along the brushing."""
    roughness_across: float = Field(default=0.4, gt=0.01, le=1)
    """GGX roughness across the brushing."""
    diffuse_share: float = Field(default=0.0, ge=0, le=1)
    """Of the brushed sphere: how much of it is matt white paint under thin metal, 0 to 1."""
    brushing: Brushing = "parallels"
    """Brushed along parallels about an axis in the picture's plane (the tangent has one direction in the picture),
    about the camera's axis, or about an axis half-way between."""
    invariance: Invariance = 2
    """Of the fabric: how many tilted lobes share a turn, so that 360°/R brings the same material back."""
    lights: Literal["studio", "lamp", "near-lamp"] = "studio"
    """Softboxes and an environment that do not move; or the lamp on the arm alone, far away or near."""
    lamp_distance_radii: float = Field(default=12.0, gt=1.5, le=1000)
    """Distance of the near lamp from the sample's centre."""
    projection: Literal["perspective", "orthographic"] = "perspective"
    """How the camera sees."""
    distance_radii: float = Field(default=8.0, gt=1.2, le=1000)
    """Distance from the camera to the sample's centre, in radii of the sphere; of no meaning to an orthographic one."""
    centre_x_px: float = 324.3
    """Where the camera's axis meets the picture, and with it the sample's centre, from the left edge."""
    centre_y_px: float = 238.6
    """The same from the upper edge."""
    radius_px: float = Field(default=180.0, gt=4)
    """Radius of the sphere's picture; the length of one radius at the slab and at the card."""
    tangent_zero_deg: float = 0.0
    """Direction of the brushing at turntable angle 0, counter-clockwise from the picture's right."""
    samples: int = Field(default=64, ge=1, le=65_536)
    """Paths a pixel."""
    seed: int = Field(default=1, ge=0, lt=2**31)
    """Seed of the paths; the same seed gives the same bits."""

    @model_validator(mode="after")
    def _lamp_outside_camera_reach(self) -> Self:
        if self.sample in ("relief", "white-card") and self.lights == "near-lamp" and self.lamp_distance_radii < 3:
            raise ValueError(
                f"lamp_distance_radii ({self.lamp_distance_radii:g}) must be 3 or more above a {self.sample}, which is "
                "wider than a sphere"
            )
        return self
