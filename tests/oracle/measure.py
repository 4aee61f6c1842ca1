"""The oracle's measurements, for the tests (one cell of each table) and for the long campaign (all of them)."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from firmware_sim.mitsuba.config import Brushing, Invariance, MitsubaScene
from litrig.base.directions import angle_between_deg
from litrig.base.table_normals import TableNormal
from processing.amc.build import AmcResult
from processing.ptm.files.ptm_file import read_ptm, write_ptm
from processing.ptm.fit import fit
from processing.ptm.lights.estimate import Ways, estimate_lights
from processing.ptm.model import Colour
from processing.ptm.relighting.relight import relight
from processing.stack import Stack
from tests.oracle.compare import amc_psnr_db, psnr_db, relative_rmse, trusted
from tests.oracle.shoot import CHROME, NAIVE, Studio, Way, seen_from

F64 = NDArray[np.float64]


class Prediction(NamedTuple):
    """PSNR in dB of a predicted brushing with the right tangents, and with all of them off by a right angle."""

    right_db: float
    off_by_90_db: float


class SplitErrors(NamedTuple):
    """RMS errors relative to the truth's RMS."""

    split: float
    rectified: float
    camera: float


class PtmFit(NamedTuple):
    """PSNR in dB over all frames, of our file and of an independent float fit."""

    ours_db: float
    lstsq_db: float


class LightErrors(NamedTuple):
    """Angles in degrees to where the lamps stood; how far the outline is off, in parts of its radius."""

    mean_deg: float
    most_deg: float
    outline: float


def predict_brushing(
    studio: Studio, material: MitsubaScene, brushing: Brushing, distance_radii: float | None = None
) -> Prediction:
    """Build an AMC from a turn of parallels, and predict another brushing of the same material."""
    way = NAIVE if distance_radii is None else TableNormal.RECTIFIED
    amc = studio.table(seen_from(material, distance_radii), way).amc
    truth = studio.truth(material, brushing)
    return Prediction(amc_psnr_db(amc, truth), amc_psnr_db(amc, truth, off_deg=90))


def truth_noise_db(studio: Studio, metal: MitsubaScene, brushing: Brushing) -> float:
    """Return the PSNR that a truth without noise would have against ours: two of them differ by √2 times that."""
    ours, other = (studio.truth(metal, brushing, seed) for seed in (2, 3))
    where = trusted(ours.surface)
    return psnr_db(other.picture[where], ours.picture[where]) + float(10 * np.log10(2))


def perspective_error(
    studio: Studio, metal: MitsubaScene, distance_radii: float | None, way: Way, brushing: Brushing
) -> float:
    """Build an AMC from perspective pictures, and return its relative RMS error against an orthographic render."""
    amc = studio.table(seen_from(metal, distance_radii), way).amc
    return relative_rmse([amc], studio.truth(metal, brushing))


def split_errors(studio: Studio, material: MitsubaScene, distance_radii: float, brushing: Brushing) -> SplitErrors:
    """Compare the sum of a low and a high table with either way alone."""
    scene = seen_from(material, distance_radii)
    truth = studio.truth(material, brushing)
    low_high = [result.amc for result in studio.split(scene)]
    alone = (studio.table(scene, way).amc for way in (TableNormal.RECTIFIED, TableNormal.CAMERA))
    return SplitErrors(relative_rmse(low_high, truth), *(relative_rmse([amc], truth) for amc in alone))


def fabric_verdict(studio: Studio, invariance: Invariance, distance_radii: float | None) -> AmcResult:
    """Let the build find the invariance of a fabric."""
    fabric = MitsubaScene(sample="fabric", invariance=invariance, radius_px=200)
    way = NAIVE if distance_radii is None else TableNormal.RECTIFIED
    return studio.table(seen_from(fabric, distance_radii), way)


def ptm_fit(studio: Studio, scene: MitsubaScene, path: Path, colour: Colour) -> PtmFit:
    """Fit a PTM, write it and read it back; beside it, fit the same display values by NumPy's least squares."""
    capture = studio.capture(scene)
    stack = Stack.of(capture)
    lights = np.array([frame.light for frame in capture.frames])
    frames = np.stack([stack.encoded(index) for index in range(len(stack))]).astype(np.float64)
    write_ptm(path, fit(stack, lights, colour=colour))
    ptm = read_ptm(path)
    ours = np.stack([relight(ptm, light) for light in lights])
    return PtmFit(_display_psnr_db(ours, frames), _display_psnr_db(_least_squares(frames, lights), frames))


def light_errors(studio: Studio, distance_radii: float | None, *, ignore_distance: bool = False) -> LightErrors:
    """Read the lamps' directions off a chrome ball that is found by itself."""
    scene = seen_from(CHROME, distance_radii)
    capture = studio.capture(scene)
    ways = Ways(distance_radii=None if ignore_distance else distance_radii)
    session = estimate_lights([frame.path for frame in capture.frames], ways)
    lamps = zip(session.lights, capture.frames, strict=True)
    errors = [
        angle_between_deg(light.direction, frame.light)
        for light, frame in lamps
        if light.direction is not None and frame.light is not None
    ]
    found, truth = session.balls[0].circle, studio.circle(scene)
    off = (found.x_px - truth.x_px, found.y_px - truth.y_px, found.radius_px - truth.radius_px)
    missed = [180.0] * (len(capture.frames) - len(errors))
    return LightErrors(
        float(np.mean(errors + missed)), max(errors + missed), float(np.abs(off).max() / truth.radius_px)
    )


def _least_squares(frames: F64, lights: F64) -> F64:
    """Fit and evaluate the six terms without a line of the product's."""
    u, v = lights[:, 0], lights[:, 1]
    design = np.stack([u * u, v * v, u * v, u, v, np.ones_like(u)], axis=1)
    coefficients, *_ = np.linalg.lstsq(design, frames.reshape(len(frames), -1), rcond=None)
    return np.asarray((design @ coefficients).reshape(frames.shape), np.float64)


def _display_psnr_db(values: NDArray[np.floating], frames: F64) -> float:
    return float(-10 * np.log10(np.mean((values - frames) ** 2)))
