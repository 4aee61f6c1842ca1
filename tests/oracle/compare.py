"""How near a picture that was predicted from a table comes to the one that mitsuba rendered."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from firmware_sim.mitsuba.renderer import Surface
from firmware_sim.scene.pose import F32
from processing.amc.model import Amc
from processing.reference.amc import lookup, table_coordinates

F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

LEAST_NORMAL_Z = 0.25
LEAST_TANGENT = 0.15
"""Length of the tangent in the picture, below which its direction there says nothing."""
PEAK_QUANTILE = 0.999


class Truth(NamedTuple):
    """An orthographic picture that was rendered directly, and what surface it shows.

    Attributes
    ----------
    picture : (H, W, 3) float32, linear
    surface : normals, tangents and validity of its pixels
    """

    picture: F32
    surface: Surface


def trusted(surface: Surface, largest_radius: float = 1.0) -> Mask:
    """Return pixels away from the rim and from tangents that point to the camera."""
    in_picture = np.hypot(surface.tangents[..., 0], surface.tangents[..., 1])
    radius = np.hypot(surface.normals[..., 0], surface.normals[..., 1])
    steep = surface.normals[..., 2] > LEAST_NORMAL_Z
    return surface.valid & steep & (in_picture > LEAST_TANGENT) & (radius < largest_radius)


def predict(amc: Amc, surface: Surface, where: Mask, off_deg: float = 0.0) -> F64:
    """Shade pixels of an orthographic picture from a table; the tangent may be turned off in the surface's plane.

    Returns
    -------
    colours : (N, 3) of the N pixels in `where`
    """
    normals, tangents = (part[where].astype(np.float64) for part in (surface.normals, surface.tangents))
    off = np.radians(off_deg)
    tangents = np.cos(off) * tangents + np.sin(off) * np.cross(normals, tangents)
    to_eye = np.broadcast_to(np.array([0.0, 0.0, 1.0]), normals.shape)
    turned, k = table_coordinates(normals, tangents, to_eye, amc.table_normal, amc.tangent_angle)
    return lookup(amc, turned, k)


def psnr_db(predicted: NDArray[np.floating], truth: NDArray[np.floating]) -> float:
    """Peak signal to noise in linear light; the peak is the truth's 99.9th percentile."""
    error = float(np.sqrt(np.mean((predicted - truth) ** 2)))
    return float(20 * np.log10(np.quantile(truth, PEAK_QUANTILE) / error))


def amc_psnr_db(amc: Amc, truth: Truth, off_deg: float = 0.0) -> float:
    """Compare a prediction with the truth where both mean something."""
    where = trusted(truth.surface)
    return psnr_db(predict(amc, truth.surface, where, off_deg), truth.picture[where])


def relative_rmse(tables: Sequence[Amc], truth: Truth, largest_radius: float = 0.8) -> float:
    """Return the RMS error of what tables predict together by the RMS of the truth, away from the rim."""
    where = trusted(truth.surface, largest_radius)
    picture = truth.picture[where].astype(np.float64)
    error = sum(predict(amc, truth.surface, where) for amc in tables) - picture
    return float(np.sqrt(np.mean(error**2) / np.mean(picture**2)))
