"""A sample of the table's texels, for all that is asked of the slices before and beside the table."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from processing.amc.geometry import texel_plane
from processing.amc.harmonics import folding
from processing.amc.shots import Slices
from processing.amc.table import Series, even_angles, read_back
from processing.amc.tangent_turn import TangentTurn

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
C64 = NDArray[np.complex64]

# The rim is steep: a tenth of a pixel in the circle shows there as a change over the turn.
_TRUSTED_RADIUS = 0.9
_TEXELS_ACROSS = 40
_SECTORS, _RINGS = 8, 3


@dataclass(frozen=True)
class Probe:
    """Some texels, away from the rim.

    Attributes
    ----------
    light : (N, T, 3) float32
    series : what the slices' angles can tell
    turn : (T,) from the tangent's picture angle to the angle that is asked for
    regions : (T,) which part of the disc each texel lies in
    """

    light: F32
    series: Series
    turn: TangentTurn
    regions: NDArray[np.int64]

    def upright(self) -> "Probe":
        """Ask for the tangent's angle in the surface instead."""
        return replace(self, turn=self.turn.upright)

    def harmonics(self) -> C64:
        """Return the series (M + 1, T, 3) over the angle that is asked for."""
        return self.series.harmonics(self.light, self.turn)

    def residuals(self, depth: int, repeats: int) -> F64:
        """RMS difference (N,) between the slices and what a table of D slices and invariance R says of them."""
        halves = 2 - repeats % 2
        count = self.series.turned_count // halves
        even = self.series.turned(self.light, self.turn, even_angles(count) / halves, halves)
        matrix = folding(count, depth, repeats // halves)
        table = (matrix @ even.reshape(count, -1)).reshape(depth, *even.shape[1:])
        said = read_back(table, self.turn, repeats, self.series.angles_rad)
        rms: F64 = np.sqrt(np.mean((self.light - said).astype(np.float64) ** 2, axis=(1, 2)))
        return rms


def make_probe(slices: Slices, series: Series) -> Probe:
    """Take every so-manieth texel of every so-manieth row."""
    size = len(slices.valid)
    step = max(1, size // _TEXELS_ACROSS)
    n_x, n_y = texel_plane(size)
    radius = np.hypot(n_x, n_y)
    picked = np.zeros_like(slices.valid)
    picked[step // 2 :: step, step // 2 :: step] = True
    picked &= slices.valid & (radius <= _TRUSTED_RADIUS)
    sector = np.floor((np.arctan2(n_y, n_x) / (2 * np.pi) + 0.5) * _SECTORS).astype(np.int64) % _SECTORS
    ring = np.minimum((radius / _TRUSTED_RADIUS) ** 2 * _RINGS, _RINGS - 1).astype(np.int64)
    texels = np.flatnonzero(picked)
    light = np.zeros((len(slices.light), len(texels), 3), np.float32)
    for index, one in enumerate(slices.light):
        light[index] = one.reshape(-1, 3)[texels]
        slices.room.release()
    return Probe(light, series, slices.turn[picked], (ring * _SECTORS + sector)[picked])
