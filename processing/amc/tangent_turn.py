"""How a tangent's angle changes when its normal is turned: by a perspective ray, or upright into the picture's plane.

Normal n, turned normal n′ and z lie in one plane of azimuth φ, so that the smallest rotation from n to n′ is about the
horizontal direction across it. A tangent whose picture has the angle τ then has one of angle τ′, with
tan(τ − φ)·n_z = tan(τ′ − φ)·n′_z. For n′ = z the angle τ′ is the tangent's angle in the surface itself.
"""

import math
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

_WORKERS = os.cpu_count() or 1


@dataclass(frozen=True)
class TangentTurn:
    """The turn at every texel.

    Attributes
    ----------
    normal_z : n_z of the normal whose tangents were seen
    turned_z : n′_z
    azimuth_rad : φ; all three of one shape
    """

    normal_z: F64
    turned_z: F64
    azimuth_rad: F64

    def __getitem__(self, texels: slice | NDArray[np.bool_]) -> "TangentTurn":
        """Pick some texels, as from an array."""
        return TangentTurn(self.normal_z[texels], self.turned_z[texels], self.azimuth_rad[texels])

    @property
    def inverse(self) -> "TangentTurn":
        return TangentTurn(self.turned_z, self.normal_z, self.azimuth_rad)

    @property
    def upright(self) -> "TangentTurn":
        """Turn the normal on to z."""
        return TangentTurn(self.normal_z, np.ones_like(self.normal_z), self.azimuth_rad)

    @property
    def keeps(self) -> bool:
        return bool(np.array_equal(self.normal_z, self.turned_z))


def read_turned(turning: F32, turn: TangentTurn, angles_rad: F64) -> F32:
    """Read a function of τ, known at even angles of a whole turn, where τ′ has the given angles.

    Parameters
    ----------
    turning : (F + 5, T, C) float32, at τ = 2π(f − 2)/F: two samples more before the turn and three after it; fine
        enough that its highest harmonic has eight samples
    turn : of T texels
    angles_rad : (J,) τ′

    Returns
    -------
    values : (J, T, C) float32
    """
    values = np.zeros((len(angles_rad), *turning.shape[1:]), np.float32)
    azimuth = turn.azimuth_rad
    parts = (turn.normal_z, turn.turned_z, np.cos(azimuth), np.sin(azimuth), azimuth / (2 * np.pi))
    normal_z, turned_z, cosines, sines, turns = (part.astype(np.float32) for part in parts)

    def read(places: slice) -> None:
        angles = angles_rad[places]
        along, across = np.cos(angles).astype(np.float32), np.sin(angles).astype(np.float32)
        _read_turned(turning, normal_z, turned_z, cosines, sines, turns, along, across, values[places])

    step = -(-len(angles_rad) // _WORKERS)
    with ThreadPoolExecutor(_WORKERS) as workers:
        list(workers.map(read, [slice(first, first + step) for first in range(0, len(angles_rad), step)]))
    return values


BEFORE, AFTER = 2, 3
"""Samples that `read_turned` wants before and after the turn."""


@kernel
def _read_turned(
    turning: F32,
    normal_z: F32,
    turned_z: F32,
    azimuth_cos: F32,
    azimuth_sin: F32,
    azimuth_turns: F32,
    angles_cos: F32,
    angles_sin: F32,
    values: F32,
) -> None:
    """Interpolate by the polynomial through six samples (Lagrange)."""
    count = turning.shape[0] - 5
    per_radian = np.float32(1 / (2 * math.pi))
    for j in range(len(angles_cos)):
        for t in range(turning.shape[1]):
            across = (angles_sin[j] * azimuth_cos[t] - angles_cos[j] * azimuth_sin[t]) * turned_z[t]
            along = (angles_cos[j] * azimuth_cos[t] + angles_sin[j] * azimuth_sin[t]) * normal_z[t]
            turns = np.float32(math.atan2(across, along)) * per_radian + azimuth_turns[t]
            place = (turns - np.float32(math.floor(turns))) * np.float32(count)
            first = min(int(place), count - 1)
            x = place - np.float32(first)
            one, two, three = np.float32(1), np.float32(2), np.float32(3)
            a, b, c, d, e, f = x + two, x + one, x, x - one, x - two, x - three
            w0 = -b * c * d * e * f / np.float32(120)
            w1 = a * c * d * e * f / np.float32(24)
            w2 = -a * b * d * e * f / np.float32(12)
            w3 = a * b * c * e * f / np.float32(12)
            w4 = -a * b * c * d * f / np.float32(24)
            w5 = a * b * c * d * e / np.float32(120)
            for k in range(turning.shape[2]):
                values[j, t, k] = (
                    w0 * turning[first, t, k]
                    + w1 * turning[first + 1, t, k]
                    + w2 * turning[first + 2, t, k]
                    + w3 * turning[first + 3, t, k]
                    + w4 * turning[first + 4, t, k]
                    + w5 * turning[first + 5, t, k]
                )
