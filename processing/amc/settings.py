"""What can be chosen when an AMC is built."""

from dataclasses import dataclass
from typing import Literal

from litrig.base.camera_model import CameraModel
from litrig.base.capture_folder.session_file import LARGEST_ANGLE_DEG
from litrig.base.errors import InputError
from litrig.base.table_normals import TableNormal
from processing.amc.geometry import SphereView
from processing.amc.invariance import MOST_REPEATS, THRESHOLD
from processing.amc.model import Invariance, TangentAngle
from processing.outline.circle import Circle

LARGEST_SIZE = 1024
LARGEST_REPEATS = 12


@dataclass(frozen=True)
class Settings:
    """The ways of a build; every one has a default.

    Attributes
    ----------
    size : S, texels along the normal's x and y
    depth : D, slices stored; by default as many as there are different angles, divided by R; 1 for isotropic
    invariance : R, "isotropic", or "auto" to find it; where one cannot tell, all slices are kept
    threshold : for "auto", share of the change's energy that may contradict an R
    most_repeats : for "auto", the largest R that is tried
    circle : silhouette in the pictures (undistorted ones, with `camera`); found when None
    distance_radii : camera to sphere centre; by default from `camera`, then from the capture, else orthographic
    camera : lens model, whose distortion is taken out
    table_normal : how normals of a perspective picture are brought to the table
    tangent_angle : what k counts; by default the angle of the tangent's picture, except that a material with R of 3 or
        more, which repeats exactly in the surface alone, is stored by that
    tangent_zero_deg : tangent angle at turntable zero; by default the capture's
    clockwise : the turntable's angles count clockwise as the camera sees them
    weave : keep the texture that turns with the sample, or average it out
    defects : find folds, cuts and hot pixels, or trust every pixel
    """

    size: int = 128
    depth: int | None = None
    invariance: Literal["auto"] | Invariance = "auto"
    threshold: float = THRESHOLD
    most_repeats: int = MOST_REPEATS
    circle: Circle | None = None
    distance_radii: float | None = None
    camera: CameraModel | None = None
    table_normal: TableNormal = TableNormal.RECTIFIED
    tangent_angle: TangentAngle | None = None
    tangent_zero_deg: float | None = None
    clockwise: bool = False
    weave: Literal["keep", "average"] = "keep"
    defects: Literal["find", "ignore"] = "find"

    def __post_init__(self) -> None:
        if not 4 <= self.size <= LARGEST_SIZE:
            raise InputError(f"a table of {self.size} texels a side; choose 4 to {LARGEST_SIZE}")
        if self.depth is not None and not 1 <= self.depth <= LARGEST_SIZE:
            raise InputError(f"a depth of {self.depth} slices; choose 1 to {LARGEST_SIZE}")
        if self.depth == 2:
            raise InputError("a depth of 2 slices, which hold no change over the turn; choose 1, or 3 and more")
        if self.invariance == "isotropic" and self.depth not in (None, 1):
            raise InputError(f"a depth of {self.depth} slices of an isotropic material; it has one, leave --depth out")
        if not 0 <= self.threshold <= 1:
            raise InputError(f"a threshold of {self.threshold:g}; it is a share, choose 0 to 1")
        if not 1 <= self.most_repeats <= LARGEST_REPEATS:
            raise InputError(f"trying R up to {self.most_repeats}; choose 1 to {LARGEST_REPEATS}")
        if isinstance(self.invariance, int) and not 1 <= self.invariance <= LARGEST_REPEATS:
            raise InputError(f"an invariance of {self.invariance}; choose 1 to {LARGEST_REPEATS}, isotropic or auto")
        SphereView(self.table_normal, self.distance_radii)  # refuses a distance that cannot be
        if self.tangent_zero_deg is not None and not abs(self.tangent_zero_deg) <= LARGEST_ANGLE_DEG:
            raise InputError(
                f"a tangent at {self.tangent_zero_deg:g} deg; choose -{LARGEST_ANGLE_DEG:g} to {LARGEST_ANGLE_DEG:g}"
            )
