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
    def flat(self) -> "TangentTurn":
        """The same texels in one row."""
        return TangentTurn(self.normal_z.ravel(), self.turned_z.ravel(), self.azimuth_rad.ravel())

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


def read_turned(turning: F32, turn: TangentTurn, angles_rad: F64, repeats: int = 1) -> F32:
    """Read a function of τ, known at even angles of one period, where τ′ has the given angles.

    Parameters
    ----------
    turning : (T, C, F + 5) float32, at τ = 2π(f − 2)/(F·repeats): two samples more before the period and three after
        it; fine enough that its highest harmonic has eight samples
    turn : of T texels
    angles_rad : (J,) τ′
    repeats : periods in a turn

    Returns
    -------
    values : (J, T, C) float32, a texel's values side by side in memory
    """
    values = np.zeros((*turning.shape[:2], len(angles_rad)), np.float32)
    parts = (turn.normal_z, turn.turned_z, np.cos(turn.azimuth_rad), np.sin(turn.azimuth_rad))
    texels = np.stack([part.astype(np.float32) for part in parts], axis=-1)
    turns = np.mod(angles_rad / (2 * np.pi), 1)
    angles = np.stack([part.astype(np.float32) for part in (np.cos(angles_rad), np.sin(angles_rad), turns)])

    def read(places: slice) -> None:
        _read_turned(turning[places], texels[places], angles, np.float32(repeats), values[places])

    step = max(1, -(-len(values) // _WORKERS))
    with ThreadPoolExecutor(_WORKERS) as workers:
        list(workers.map(read, [slice(first, first + step) for first in range(0, len(values), step)]))
    return np.moveaxis(values, -1, 0)


BEFORE, AFTER = 2, 3
"""Samples that `read_turned` wants before and after the period."""


@kernel
def _read_turned(turning: F32, texels: F32, angles: F32, repeats: np.float32, values: F32) -> None:
    """Interpolate by the polynomial through six samples (Lagrange).

    The angle comes as τ′ and the way from there, tan(τ − τ′) = sin(τ′ − φ)·cos(τ′ − φ)·(n′_z − n_z)/(cos²·n_z +
    sin²·n′_z), whose denominator is never negative: one arctangent without cases, which runs on many angles at once.
    It is Abramowitz & Stegun's polynomial 4.4.49, off by 2e-8.
    """
    count = turning.shape[2] - 5
    one, two, three = np.float32(1), np.float32(2), np.float32(3)
    firsts = np.zeros(angles.shape[1], np.int32)
    weights = np.zeros((6, angles.shape[1]), np.float32)
    for t in range(len(texels)):
        normal_z, turned_z, azimuth_cos, azimuth_sin = texels[t]
        for j in range(angles.shape[1]):
            along = angles[0, j] * azimuth_cos + angles[1, j] * azimuth_sin
            across = angles[1, j] * azimuth_cos - angles[0, j] * azimuth_sin
            rise = along * across * (turned_z - normal_z)
            run = along * along * normal_z + across * across * turned_z + np.float32(1e-30)
            steep = abs(rise) > run
            slope = min(abs(rise), run) / max(abs(rise), run)
            square = slope * slope
            arc = np.float32(0.0028662257)
            arc = arc * square - np.float32(0.0161657367)
            arc = arc * square + np.float32(0.0429096138)
            arc = arc * square - np.float32(0.0752896400)
            arc = arc * square + np.float32(0.1065626393)
            arc = arc * square - np.float32(0.1420889944)
            arc = arc * square + np.float32(0.1999355085)
            arc = arc * square - np.float32(0.3333314528)
            arc = (arc * square + one) * slope * np.float32(1 / (2 * math.pi))
            arc = np.float32(0.25) - arc if steep else arc
            periods = (angles[2, j] + (arc if rise >= 0 else -arc)) * repeats
            place = (periods - np.floor(periods)) * np.float32(count)
            firsts[j] = min(np.int32(place), np.int32(count - 1))
            x = place - np.float32(firsts[j])
            a, b, c, d, e, f = x + two, x + one, x, x - one, x - two, x - three
            weights[0, j] = b * c * d * e * f * np.float32(-1 / 120)
            weights[1, j] = a * c * d * e * f * np.float32(1 / 24)
            weights[2, j] = a * b * d * e * f * np.float32(-1 / 12)
            weights[3, j] = a * b * c * e * f * np.float32(1 / 12)
            weights[4, j] = a * b * c * d * f * np.float32(-1 / 24)
            weights[5, j] = a * b * c * d * e * np.float32(1 / 120)
        for k in range(turning.shape[1]):
            curve = turning[t, k]
            for j in range(angles.shape[1]):
                first = np.uint32(firsts[j])  # unsigned: an index that could be below zero costs a test
                values[t, k, j] = (
                    weights[0, j] * curve[first]
                    + weights[1, j] * curve[first + np.uint32(1)]
                    + weights[2, j] * curve[first + np.uint32(2)]
                    + weights[3, j] * curve[first + np.uint32(3)]
                    + weights[4, j] * curve[first + np.uint32(4)]
                    + weights[5, j] * curve[first + np.uint32(5)]
                )
