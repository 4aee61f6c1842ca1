"""Turning the light of a MatCap against renders in turned surroundings, and its separation against renders of parts."""

from dataclasses import replace
from functools import cache
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates
from scipy.spatial.transform import Rotation

from processing.matcap.decompose import Filter, decompose
from processing.matcap.disc import disc_normals
from processing.matcap.estimate.estimate import estimate_filter_size
from processing.matcap.filter import MATT_FILTER_SIZE
from processing.matcap.model import DecomposedMatcap
from processing.matcap.render import disc_picture
from processing.matcap.separation.separate import Form, separate
from tests.oracle.glossy_sphere import GOLD, PLASTIC, SATIN_GOLD, SATIN_PLASTIC, Ball, Material, plastic, rendered

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Axis = Literal["x", "y"]

BALLS: dict[str, Material] = {
    "gold": GOLD,
    "satin gold": SATIN_GOLD,
    "plastic": PLASTIC,
    "satin plastic": SATIN_PLASTIC,
}
ANGLES_DEG = (30.0, 60.0, 90.0)
LEAST_NORMAL_Z = 0.2
TRUTH_FACTOR = 2
"""How many more samples a truth gets than the picture that is taken apart."""
_RIM_PX = 1.25


class Quality(NamedTuple):
    """Of renders."""

    variant: str
    side_px: int
    samples: int


class Turns(NamedTuple):
    """Pictures (S, S, 3) of a ball whose light was turned.

    Attributes
    ----------
    truth : rendered in turned surroundings
    ours : decomposed, the light turned
    picture : the MatCap looked up by turned normals; those that look away, at the rim
    mirrored : the same, the far hemisphere the mirror image of the near one
    """

    truth: F32
    ours: F32
    picture: F32
    mirrored: F32


class Errors(NamedTuple):
    """RMS errors relative to the truth's RMS, where n_z > .2."""

    ours: float
    picture: float
    mirrored: float


class Parts(NamedTuple):
    """How near the low and the high frequencies come to diffuse and specular light: as `Errors`; means as ratios."""

    low: float
    whole_as_diffuse: float
    low_by_diffuse: float
    high: float
    whole_as_specular: float
    high_by_specular: float
    alike: float


@cache
def taken_apart(quality: Quality, name: str) -> DecomposedMatcap:
    """Take the picture of a ball apart: low frequencies as matt, the filter of high ones estimated."""
    layers = separate(ball(quality, name).picture)
    unclipped = np.zeros(layers.known.shape, np.bool_)
    low, high = layers.low.astype(np.float32), layers.high.astype(np.float32)
    found = estimate_filter_size(high, clipped=unclipped).filter_size
    return decompose(low, high, layers.known, (Filter.of_size(MATT_FILTER_SIZE), Filter.of_size(found)))


@cache
def ball(quality: Quality, name: str) -> Ball:
    """Render a ball in the surroundings as they are."""
    return rendered(quality.variant, BALLS[name], quality.side_px, quality.samples)


def turned(quality: Quality, name: str, axis: Axis, angle_deg: float) -> Turns:
    """Turn a ball's light in four ways."""
    turn = Rotation.from_euler(axis, angle_deg, degrees=True)
    truth = rendered(
        quality.variant, BALLS[name], quality.side_px, TRUTH_FACTOR * quality.samples, turn, seed=2
    ).picture
    picture = ball(quality, name).picture
    normals, _ = disc_normals(quality.side_px)
    before = turn.apply(normals.reshape(-1, 3), inverse=True).reshape(normals.shape)
    x, y, z = turn.as_rotvec(degrees=True)
    low, high = (
        replace(part, light_turn_deg=(float(x), float(y), float(z)))
        for part in (taken_apart(quality, name).low, taken_apart(quality, name).high)
    )
    ours = disc_picture(replace(taken_apart(quality, name), low=low, high=high))
    return Turns(truth, ours, _looked_up(picture, before, to_rim=True), _looked_up(picture, before, to_rim=False))


def errors(quality: Quality, name: str, turns: Turns) -> Errors:
    """Compare three ways with the truth."""
    where = _compared(quality, name)
    return Errors(*(_relative_rms(way[where], turns.truth[where]) for way in turns[1:]))


def noise(quality: Quality, name: str) -> float:
    """Return the relative RMS of the truths' noise: two renders differ by √2 times that."""
    samples = TRUTH_FACTOR * quality.samples
    first, second = (
        rendered(quality.variant, BALLS[name], quality.side_px, samples, seed=seed).picture for seed in (2, 3)
    )
    where = _compared(quality, name)
    return _relative_rms(first[where], second[where]) / float(np.sqrt(2))


def layers_and_parts(quality: Quality, alpha: float, form: Form) -> tuple[F32, F32, F32, F32, F32]:
    """Return a plastic ball's picture, its diffuse and specular part, and its low and high frequencies."""
    renders = [
        rendered(quality.variant, plastic(alpha, **shares), quality.side_px, quality.samples, seed=seed).picture
        for seed, shares in enumerate(({}, {"specular": 0.0}, {"diffuse": 0.0}), 4)
    ]
    layers = separate(renders[0], form=form)
    return renders[0], renders[1], renders[2], layers.low.astype(np.float32), layers.high.astype(np.float32)


def separation(quality: Quality, alpha: float, form: Form = "continuous") -> Parts:
    """Compare a plastic ball's low and high frequencies with its diffuse and specular part."""
    where = _compared(quality, "plastic")
    whole, diffuse, specular, low, high = (
        part[where].astype(np.float64) for part in layers_and_parts(quality, alpha, form)
    )
    return Parts(
        low=_relative_rms(low, diffuse),
        whole_as_diffuse=_relative_rms(whole, diffuse),
        low_by_diffuse=float(low.mean() / diffuse.mean()),
        high=_relative_rms(high, specular),
        whole_as_specular=_relative_rms(whole, specular),
        high_by_specular=float(high.mean() / specular.mean()),
        alike=float(np.corrcoef(high.mean(axis=1), specular.mean(axis=1))[0, 1]),
    )


def _compared(quality: Quality, name: str) -> NDArray[np.bool_]:
    normals, _ = disc_normals(quality.side_px)
    where: NDArray[np.bool_] = ball(quality, name).whole & (normals[..., 2] > LEAST_NORMAL_Z)
    return where


def _looked_up(picture: F32, normals: F64, *, to_rim: bool) -> F32:
    size = len(picture)
    across = np.linalg.norm(normals[..., :2], axis=-1)
    edge = 1 - 2 * _RIM_PX / size
    radius = np.where(to_rim & (normals[..., 2] < 0), edge, np.minimum(across, edge))
    place = normals[..., :2] * (radius / np.maximum(across, 1e-9))[..., None]
    at = [(1 - place[..., 1]) * size / 2 - 0.5, (1 + place[..., 0]) * size / 2 - 0.5]
    return np.stack([map_coordinates(picture[..., channel], at, order=1) for channel in range(3)], axis=-1)


def _relative_rms(found: NDArray[np.floating], truth: NDArray[np.floating]) -> float:
    difference = np.asarray(found, np.float64) - truth
    return float(np.sqrt(np.mean(difference**2) / np.mean(np.asarray(truth, np.float64) ** 2)))
