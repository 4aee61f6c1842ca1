"""Was each frame lit from where its light is said to be? Crossed wires and wrong lamps show in the pictures alone.

The frames of one pose are fitted by a polynomial texture map (Malzbender et al. 2001, equation 1: six terms in l_u and
l_v), a fit a texel of the thumbnails. Two questions are asked of it, and each has its own answer:

- *Exchanged*: would all frames be predicted better, each by all others, if two had each other's light? On consistent
  sessions no exchange of lights that are apart helps; see `MUCH_BETTER`.
- *Lit from elsewhere*: where would the polynomials of all others put the light of a frame, and do they predict it
  better from there? Each frame is its own yardstick, so that gloss and cast shadows, which no polynomial follows, count
  on both sides. The worst is left out of the fit of the others, until no further one stands out.

A flat, matte sample looks the same from all azimuths: nothing can be said of it, and nothing is.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from acquisition.thumbs import read_thumbnail
from litrig.base.capture_folder import layout
from litrig.base.capture_folder.capture import Role
from litrig.base.capture_folder.journal import Entry, read_journal
from litrig.base.capture_folder.reader import good_frames
from litrig.base.directions import angle_between_deg, angles_from_direction
from litrig.base.radiometry import decode_srgb_codes

F64 = NDArray[np.float64]

FEWEST_LIGHTS = 10
"""Six coefficients, and enough to contradict them, for exchanges."""
MOST_LIGHTS = 2000
"""All are compared with all."""
FEWEST_OTHERS = 14
"""So many must agree before it is said that a frame is lit from elsewhere: fewer bend to whatever is left."""
WIDTH_PX = 40
MUCH_BETTER = 0.8
"""An exchange is believed that brings the squared error of all predictions below this share."""
WORSE = 1.5
"""A frame is suspect if it is so much worse predicted (RMS) from its light than from the best direction,"""
FARTHEST_DEG, DEVIATIONS = 12.0, 6.0
"""and that lies farther off than this, and than the median of all by so many standard deviations (of the median)."""
_GRID = 50
_HIGHEST_U2V2 = 0.97
_LEAST_FREE = 0.05
"""A frame that its own fit follows by more than 95 % is predicted by the others only through noise."""


@dataclass(frozen=True)
class Suspect:
    """A frame that does not look lit from where its light is said to be.

    Attributes
    ----------
    step, file : which
    said_deg : azimuth and elevation that the journal has
    looks_deg : azimuth and elevation from where the other frames predict it best, to a few degrees
    apart_deg : the angle between the two
    exchanged_with : the step whose light it seems to have; None if it is no plain exchange
    """

    step: int
    file: str
    said_deg: tuple[float, float]
    looks_deg: tuple[float, float]
    apart_deg: float
    exchanged_with: int | None = None

    def __str__(self) -> str:
        azimuth_deg, elevation_deg = self.looks_deg
        other = "" if self.exchanged_with is None else f", as step {self.exchanged_with} should be"
        return (
            f"step {self.step} looks lit from about azimuth {azimuth_deg:.0f}°, elevation {elevation_deg:.0f}°, "
            f"{self.apart_deg:.0f}° from where its light is said to be{other}"
        )


def suspects(folder: Path) -> list[Suspect]:
    """Name the frames of a session that look lit from elsewhere; none where nothing can be said.

    Parameters
    ----------
    folder : a capture folder in any state

    Raises
    ------
    InputError, FormatError
        It has no journal, or a damaged one.
    """
    return suspects_among(folder, good_frames(read_journal(folder / layout.JOURNAL)))


def suspects_among(folder: Path, frames: Iterable[Entry]) -> list[Suspect]:
    """Do what `suspects` does for the frames that count, as their journal lines have them."""
    poses: dict[object, dict[object, Entry]] = {}
    for entry in frames:
        if entry.get("role", Role.FRAME) == Role.FRAME and entry.get("light") is not None:
            goal = entry.get("pose_goal") or {}
            aim = tuple(sorted((key, value) for key, value in goal.items() if key != "angle_deg"))
            pose = poses.setdefault((goal.get("angle_deg"), entry.get("exposure_ev", 0.0)), {})
            pose.setdefault(
                aim or entry["step"], entry
            )  # repeats are shot without a move in between: one speaks for all
    found: list[Suspect] = []
    for lit in poses.values():
        if FEWEST_LIGHTS <= len(lit) <= MOST_LIGHTS:
            found += _of_one_pose(folder, list(lit.values()))
    return sorted(found, key=lambda suspect: suspect.step)


def find_inconsistent(lights: F64, pictures: F64) -> list[tuple[int, F64, int | None]]:
    """Find pictures that were not lit from their lights.

    Parameters
    ----------
    lights : (N, 3) unit, view frame
    pictures : (N, T) linear light of T texels

    Returns
    -------
    found : of each its index, the direction (3,) from where it looks lit, and the index of the one that it seems
        exchanged with, or None
    """
    terms = _terms(lights)
    if len(lights) < FEWEST_LIGHTS or np.linalg.matrix_rank(terms, tol=1e-3) < terms.shape[1]:
        return []
    partner = _exchanged(terms, pictures)
    is_used = partner == np.arange(len(lights))
    partner = _confirmed(partner, terms, pictures, is_used)
    while True:
        seen = _look(terms, pictures, is_used)
        apart_deg = np.array([angle_between_deg(a, b) for a, b in zip(lights, seen.directions, strict=True)])
        usual_deg = float(np.median(apart_deg[is_used]))
        spread_deg = 1.4826 * float(np.median(np.abs(apart_deg[is_used] - usual_deg)))
        is_off = (seen.worse > WORSE) & (apart_deg > max(FARTHEST_DEG, usual_deg + DEVIATIONS * spread_deg))
        others = int(np.count_nonzero(is_used)) - 1
        is_off &= others >= FEWEST_OTHERS
        further = is_off & is_used
        if not further.any() or 3 * others <= 2 * len(lights):
            break
        is_used[np.argmax(np.where(further, seen.worse * apart_deg, 0))] = False
    is_exchanged = partner != np.arange(len(lights))
    return [
        (int(index), seen.directions[index], int(partner[index]) if is_exchanged[index] else None)
        for index in np.flatnonzero(is_off | is_exchanged)
    ]


@dataclass(frozen=True)
class _Seen:
    """What all others make of each picture: how much worse (RMS) it is from its light than from the best direction."""

    worse: F64
    directions: F64


def _of_one_pose(folder: Path, entries: Sequence[Entry]) -> list[Suspect]:
    texels = [_texels(folder, entry["file"]) for entry in entries]
    sizes = [one.size for one in texels if one is not None]
    if not sizes:
        return []
    usual = max(set(sizes), key=sizes.count)
    kept = [(entry, one) for entry, one in zip(entries, texels, strict=True) if one is not None and one.size == usual]
    lights = np.array([entry["light"] for entry, _ in kept], np.float64)
    found = find_inconsistent(lights, np.array([one for _, one in kept]))
    return [
        Suspect(
            step=kept[index][0]["step"],
            file=kept[index][0]["file"],
            said_deg=angles_from_direction(lights[index]),
            looks_deg=angles_from_direction(direction),
            apart_deg=angle_between_deg(lights[index], direction),
            exchanged_with=None if other is None else kept[other][0]["step"],
        )
        for index, direction, other in found
    ]


def _texels(folder: Path, file: str) -> F64 | None:
    thumb = read_thumbnail(folder, file)
    if thumb is None:
        return None
    grey = decode_srgb_codes(thumb).mean(axis=-1)
    height = max(1, round(grey.shape[0] * WIDTH_PX / grey.shape[1]))
    return np.asarray(cv2.resize(grey, (WIDTH_PX, height), interpolation=cv2.INTER_AREA), np.float64).ravel()


def _terms(directions: F64) -> F64:
    """Return (N, 6): u², v², uv, u, v, 1 (Malzbender et al. 2001, equation 1)."""
    u, v = directions[:, 0], directions[:, 1]
    return np.stack([u * u, v * v, u * v, u, v, np.ones_like(u)], axis=-1)


def _exchanged(terms: F64, pictures: F64) -> NDArray[np.intp]:
    """Return for each picture the index of the one whose light it should have; its own if all is well.

    The squared error of all predictions, each by all others, is Σ_ab M_ab G_ab: M of the lights alone (from the
    residuals r_i/(1 − h_ii) of a linear fit with hat matrix h), G the products of the pictures. An exchange of two
    permutes G, so that all pairs are tried at the cost of one product of matrices.
    """
    count = len(terms)
    hat = terms @ np.linalg.pinv(terms)
    left_out = (np.eye(count) - hat) / np.maximum(1 - np.diag(hat), _LEAST_FREE)[:, None]
    weights = left_out.T @ left_out
    all_products = pictures @ pictures.T
    order = np.arange(count)
    for _ in range(count // 4):
        products = all_products[np.ix_(order, order)]
        error = float(np.sum(weights * products))
        change = 2 * _change(weights, products)
        one, other = np.unravel_index(int(np.argmin(change)), change.shape)
        if not error + change[one, other] < MUCH_BETTER * error:
            break
        order[[one, other]] = order[[other, one]]
    # `order[a]` is the picture that light a belongs to; the other way round it is the light of a picture.
    return np.argsort(order)


def _confirmed(partner: NDArray[np.intp], terms: F64, pictures: F64, is_used: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Keep the exchanges in which the frames that are not part of any predict each picture better from its new light.

    One frame that was lit from elsewhere looks better in many places, also at the cost of an innocent one.
    """
    coefficients = np.linalg.pinv(terms[is_used]) @ pictures[is_used]
    as_said = np.sum((pictures - terms @ coefficients) ** 2, axis=1)
    exchanged = np.sum((pictures - terms[partner] @ coefficients) ** 2, axis=1)
    return np.where(exchanged < as_said, partner, np.arange(len(partner)))


def _change(weights: F64, products: F64) -> F64:
    """Return half of what Σ_ab M_ab G_ab changes by when rows and columns i and j of G are exchanged, for all i, j."""
    mixed = weights @ products
    w, g = np.diag(weights), np.diag(products)
    whole = mixed + mixed.T - np.diag(mixed)[:, None] - np.diag(mixed)[None, :]
    # In the sum over b above, b = i and b = j do not count: their part is that of the diagonals.
    at_i = (w[:, None] - weights) * (products - g[:, None])
    at_j = (weights - w[None, :]) * (g[None, :] - products)
    return np.asarray(whole - at_i - at_j + 0.5 * (w[:, None] - w[None, :]) * (g[None, :] - g[:, None]), np.float64)


def _look(terms: F64, pictures: F64, is_used: NDArray[np.bool_]) -> _Seen:
    """Find the direction from where the polynomials of all others predict each picture best."""
    used = terms[is_used]
    inverse = np.linalg.pinv(used.T @ used)
    coefficients = inverse @ (used.T @ pictures[is_used])
    directions, grid = _directions_like(terms)
    worse, best = np.ones(len(terms)), np.zeros((len(terms), 3))
    for index, picture in enumerate(pictures):
        by_others, residual = coefficients, picture - terms[index] @ coefficients
        if is_used[index]:  # takes its own part out of the fit again
            pull = inverse @ terms[index]
            residual = residual / max(1 - float(terms[index] @ pull), _LEAST_FREE)
            by_others = coefficients - np.outer(pull, residual)
        errors = np.sum((grid @ (by_others @ by_others.T)) * grid, axis=1) - 2 * grid @ (by_others @ picture)
        nearest = int(np.argmin(errors))
        here, there = float(residual @ residual), float(errors[nearest] + picture @ picture)
        best[index] = directions[nearest]
        worse[index] = np.sqrt(here / max(there, 1e-9 * here, 1e-30))
    return _Seen(worse, best)


def _directions_like(terms: F64) -> tuple[F64, F64]:
    """Return directions (K, 3) all over the part of the hemisphere where the lights are, and their terms (K, 6)."""
    farthest = float(np.max(terms[:, 0] + terms[:, 1]))  # u² + v²: beyond it polynomials only guess
    steps = np.linspace(-1, 1, _GRID)
    u, v = (axis.ravel() for axis in np.meshgrid(steps, steps))
    inside = u * u + v * v <= min(farthest, _HIGHEST_U2V2)
    u, v = u[inside], v[inside]
    directions = np.stack([u, v, np.sqrt(1 - u * u - v * v)], axis=-1)
    return directions, _terms(directions)
