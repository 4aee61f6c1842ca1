"""From slices at measured angles to the even slices of a table.

Without a turn of normals all texels have one matrix; with one, every texel is read at angles of its own first.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from processing.amc.harmonics import fit_harmonics, fitting, folding, reading, unfolding
from processing.amc.tangent_turn import AFTER, BEFORE, TangentTurn, read_turned
from processing.room import Room, make_room

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
C64 = NDArray[np.complex64]

_SAMPLES_PER_WAVE = 4
_VALUES_AT_ONCE = 1 << 22


@dataclass(frozen=True)
class Series:
    """The Fourier series that slices at measured angles carry.

    Attributes
    ----------
    angles_rad : (N,) tangent angles of the slices, in the picture
    highest : M, as `check_angles` gives it
    """

    angles_rad: F64
    highest: int

    @property
    def count(self) -> int:
        """Even angles that hold all of it."""
        return 2 * self.highest + 1

    @property
    def told(self) -> int:
        """As many even slices as these are worth: repeated angles count once."""
        return min(len(self.angles_rad), self.count + 1)

    @property
    def turned_count(self) -> int:
        """Even number of even angles that hold what a turn makes of it, for waves get wider here and narrower there."""
        return 2 * (3 * self.count // 4)

    @cached_property
    def fine(self) -> F32:
        """The matrix from slices to what `read_turned` reads."""
        return reading(self.fit, _fine_angles(self.count))

    @cached_property
    def fit(self) -> F64:
        return fitting(self.angles_rad, self.highest)

    def turned(self, slices: F32, turn: TangentTurn, wanted_rad: F64, repeats: int = 1) -> F32:
        """Read slices (N, T, C) of T texels at angles (J,) of their turned tangents; (J, T, C).

        Parameters
        ----------
        repeats : 2 leaves out what does not repeat at half a turn, and costs half as much; a turn takes opposite
            tangents to opposite ones, so that it mixes nothing of the rest in
        """
        if turn.keeps:
            copies = [reading(self.fit, wanted_rad + 2 * np.pi * copy / repeats) for copy in range(repeats)]
            return _apply(np.mean(copies, axis=0), slices)
        fine = self.fine
        if repeats == 2:
            half = _SAMPLES_PER_WAVE * self.count // 2
            fine = np.float32(0.5) * (fine[: half + BEFORE + AFTER] + fine[half:])
        turning = slices.reshape(len(slices), -1).T @ fine.T
        return read_turned(turning.reshape(*slices.shape[1:], len(fine)), turn, wanted_rad, repeats)

    def harmonics(self, slices: F32, turn: TangentTurn) -> C64:
        """Return the series (M + 1, T, C) over the angle of the turned tangents."""
        if turn.keeps:
            return fit_harmonics(slices, self.angles_rad, self.highest)
        even = self.turned(slices, turn, even_angles(self.turned_count))
        harmonics = np.fft.rfft(even, axis=0)[: self.highest + 1] * (2 / len(even))
        harmonics[0] /= 2
        return np.asarray(harmonics, np.complex64)


def make_table(room: Room, series: Series, turn: TangentTurn, depth: int, repeats: int) -> F32:
    """Turn slices (N, S, S, 3) into D even ones over one period, in place where they fit.

    Light is never negative: a series undershoots zero beside a sharp highlight.

    Parameters
    ----------
    room : the slices; overwritten
    turn : (S, S)

    Returns
    -------
    table : (D, S, S, 3), a part of `room` where D is at most N
    """
    slices, size = len(room.array), room.array.shape[1]
    made = room if depth <= slices else make_room((depth, *room.array.shape[1:]))
    halves = 2 - repeats % 2
    count = series.count if turn.keeps else series.turned_count // halves
    if turn.keeps:
        to_slices = folding(count, depth, repeats) @ reading(series.fit, even_angles(count))
    else:
        to_slices = folding(count, depth, repeats // halves)
    widest = slices if turn.keeps else max(slices, _SAMPLES_PER_WAVE * count)
    step = max(1, _VALUES_AT_ONCE // (widest * size * 3))
    room.release()
    for first in range(0, size, step):
        rows = slice(first, first + step)
        part = room.rows(rows)
        shape = (depth, *part.shape[1:])
        part = part.reshape(slices, -1, 3)
        if not turn.keeps:
            part = series.turned(part, turn[rows].flat, even_angles(count) / halves, halves)
        values = _apply(to_slices, part)
        made.put_rows(rows, np.maximum(values, 0, out=values).reshape(shape))
    return made.array[:depth]


def read_back(table: F32, turn: TangentTurn, repeats: int, angles_rad: F64) -> F32:
    """Tell what a table (D, T, 3) says of slices at angles in the picture, (N, T, 3)."""
    if turn.keeps:
        return _apply(unfolding(angles_rad, len(table), repeats), table)
    halves = 2 - repeats % 2
    waves = repeats * len(table) // halves
    matrix = unfolding(_fine_angles(waves) / halves, len(table), repeats)
    turning = table.reshape(len(table), -1).T @ matrix.T
    return read_turned(turning.reshape(*table.shape[1:], len(matrix)), turn.inverse, angles_rad, halves)


def even_angles(count: int) -> F64:
    """Return angles 2π·i/count."""
    angles: F64 = 2 * np.pi * np.arange(count) / count
    return angles


def _fine_angles(waves: int) -> F64:
    """Return angles of a turn as `read_turned` wants them."""
    count = _SAMPLES_PER_WAVE * waves
    angles: F64 = 2 * np.pi * np.arange(-BEFORE, count + AFTER) / count
    return angles


def _apply(matrix: F32, slices: F32) -> F32:
    """Multiply along the slices."""
    return (matrix @ slices.reshape(len(slices), -1)).reshape(len(matrix), *slices.shape[1:])
