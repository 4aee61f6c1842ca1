"""An isotropic MatCap from one photograph of a ball (the AMC paper, section 3: single image acquisition).

Every normal that faces the camera is seen once on the ball, so that its picture, cropped to the disc, is the table.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.radiometry import encode_srgb
from processing.amc.geometry import SphereView
from processing.amc.resample import dilate, make_resampler
from processing.outline.circle import Circle, trusted
from processing.outline.limb import weigh_apart
from processing.outline.silhouette import Turn, exposed, shrunk

F32 = NDArray[np.float32]

_MARGIN_SHARE = 0.12
# A MatCap that fills its picture has lost part of a pixel of its rim at four places; a ball that lost more is cut.
_LOST_SHARE = 0.01
# Of a MatCap with a dark rim: light in display values, how near to the rim it must be, and how much may lie beyond.
_LIT, _NEAR_SHARE, _EDGE_PX, _SPILT_SHARE = 0.03, 0.02, 1.5, 0.002
_SECTORS = 48


@dataclass(frozen=True)
class PhotoMatcap:
    """A MatCap with the disc inscribed in the square.

    Attributes
    ----------
    colours : (S, S, 3) float32 linear, row 0 at n_y = +1; beyond the disc as at its nearest valid texel
    valid : (S, S) bool, texels that hold what was seen
    """

    colours: F32
    valid: NDArray[np.bool_]


def find_ball(picture: F32, source: str = "the photograph") -> Circle:
    """Find the outline of the one ball in a photograph.

    Display values are looked at, in which a dark rim before a dark room shows; the outline is known to a quarter of a
    pixel where it is sharp. The picture is continued past its borders with the colour of its corners, for the disc of a
    MatCap touches them. Where too little of the rim is seen, a square picture whose light ends at the inscribed circle
    is taken for a MatCap.

    Parameters
    ----------
    picture : (H, W, 3) linear light, of any exposure
    source : what to call it in errors

    Raises
    ------
    InputError
        No round outline stands out, or the border cuts it.
    """
    try:
        return _whole(_outlined(picture, source), picture.shape[:2], source)
    except InputError:
        inscribed = _inscribed(picture)
        if inscribed is None:
            raise
        return inscribed


def _outlined(picture: F32, source: str) -> Circle:
    small, factor = shrunk(picture)
    codes, margin = _with_margin(encode_srgb(exposed(small)))
    turn = Turn(codes[None])
    limb, _ = turn.find()
    limb = turn.sharpen(limb, weigh_apart)
    found = trusted(limb, np.array([[limb.x_px, limb.y_px]]), 0.0, factor, source)
    return Circle(found.x_px - margin * factor, found.y_px - margin * factor, found.radius_px)


def _inscribed(picture: F32) -> Circle | None:
    """Return the circle that fills a square picture, if all around light ends at it: a MatCap whose rim is mostly dark.

    Beyond it everything is as dark as the corners; next to it, inside, light is seen in sectors that leave no gap of
    half a turn. A smaller ball, or one at another place, would have its light end elsewhere.
    """
    height, width, _ = picture.shape
    if height != width:
        return None
    radius = width / 2
    brightest = encode_srgb(exposed(picture)).max(axis=-1)
    y, x = np.mgrid[:width, :width] + 0.5 - radius
    off, azimuth = np.hypot(x, y), np.arctan2(y, x)
    lit = brightest > np.median(brightest[off > radius + _EDGE_PX]) + _LIT
    if lit[off > radius + _EDGE_PX].mean() > _SPILT_SHARE:
        return None
    near = lit & (np.abs(off - radius * (1 - _NEAR_SHARE / 2)) < max(radius * _NEAR_SHARE / 2, _EDGE_PX))
    seen = np.unique(((azimuth[near] / (2 * np.pi) + 0.5) * _SECTORS).astype(int) % _SECTORS)
    gaps = np.diff(seen, append=seen[:1] + _SECTORS)
    return Circle(radius, radius, radius) if len(seen) and gaps.max() < _SECTORS / 2 else None


def matcap_from_photo(picture: F32, circle: Circle, view: SphereView, size: int) -> PhotoMatcap:
    """Bring the ball to an S×S table.

    Parameters
    ----------
    picture : (H, W, 3) linear light
    circle : the ball's outline in it
    view : distance and kind of table normal
    size : S
    """
    resampler = make_resampler(circle, view, size)
    if not resampler.valid.any():
        raise InputError(f"the ball ({circle}) is too small for a table of {size} texels; photograph it larger")
    return PhotoMatcap(dilate(resampler(picture), resampler.valid), resampler.valid)


def _with_margin(codes: F32) -> tuple[F32, int]:
    margin = round(_MARGIN_SHARE * min(codes.shape[:2]))
    corners = np.stack([codes[0, 0], codes[0, -1], codes[-1, 0], codes[-1, -1]])
    colour = [float(value) for value in np.median(corners, axis=0)]
    padded = cv2.copyMakeBorder(codes, margin, margin, margin, margin, cv2.BORDER_CONSTANT, value=colour)
    return padded.astype(np.float32), margin


def _whole(circle: Circle, shape: tuple[int, ...], source: str) -> Circle:
    """Return the circle if the border leaves nearly all of it; `Circle.inside` composes the error."""
    kept = circle.radius_px * (1 - _LOST_SHARE)
    Circle(circle.x_px, circle.y_px, kept).inside((shape[0], shape[1]), source)
    return circle
