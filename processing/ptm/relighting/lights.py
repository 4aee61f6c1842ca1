"""Many lights at once."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]


class Lights(NamedTuple):
    """Distant lights above the horizon.

    Attributes
    ----------
    directions : (N, 3), unit, view frame, sample to light, z ≥ 0
    colours : (N, 3), linear light; 1 is the lamp of the capture
    """

    directions: F64
    colours: F64

    def and_also(self, others: "Lights") -> "Lights":
        """Join the lights of two."""
        return Lights(*(np.concatenate(pair) for pair in zip(self, others, strict=True)))

    def exposed(self, exposure_ev: float) -> "Lights":
        """Make all of them 2^EV times as strong."""
        return self._replace(colours=self.colours * 2.0**exposure_ev)

    def softened(self, radius_deg: float, samples: int) -> "Lights":
        """Make each light a disc of an angular radius, evenly bright: so many lights of a share each.

        The samples are spread evenly over the disc's solid angle, on a spiral. What of a disc is below the horizon does
        not light the sample.

        Parameters
        ----------
        radius_deg : 0 to 90; 0 changes nothing
        """
        if radius_deg == 0:
            return self
        number = (np.arange(samples) + 0.5) / samples
        z = 1 - number * (1 - np.cos(np.radians(radius_deg)))
        azimuth = np.arange(samples) * np.pi * (3 - np.sqrt(5))
        flat = np.sqrt(1 - z * z)
        spiral = np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), z], axis=-1)
        directions = np.concatenate([spiral @ _frame(direction) for direction in self.directions])
        colours = np.repeat(self.colours / samples, samples, axis=0)
        above = directions[:, 2] >= 0
        return Lights(directions[above], colours[above])

    def gathered(self, rings: int) -> "Lights":
        """Replace the lights of each cell of the half-sphere by one, in the middle of their luminance.

        The cells are 4·rings² of equal solid angle: `rings` rings about z, of 4, 12, 20 … cells. What is dark is left
        out.
        """
        x, y, z = self.directions.T
        # √(1 − z) is the radius in the map of the half-sphere to the disc that keeps areas.
        ring = np.minimum((rings * np.sqrt(np.maximum(1 - z, 0))).astype(np.int64), rings - 1)
        share = np.arctan2(y, x) / (2 * np.pi) % 1
        cells = 4 * (2 * ring + 1)
        cell = 4 * ring**2 + np.minimum((share * cells).astype(np.int64), cells - 1)
        luminance = np.maximum(self.colours.mean(axis=1), 0)
        middle = _sums(cell, self.directions * luminance[:, None], 4 * rings**2)
        colours = _sums(cell, self.colours, 4 * rings**2)
        length = np.linalg.norm(middle, axis=1)
        lit = length > 0
        return Lights(middle[lit] / length[lit, None], colours[lit])


def lamps(positions: Sequence[tuple[float, float]], colours: Sequence[tuple[float, float, float]] = ()) -> Lights:
    """Make lights of their (u, v); white ones, unless each has a colour."""
    flat = np.asarray(positions, np.float64).reshape(-1, 2)
    z = np.sqrt(np.maximum(1 - np.sum(flat**2, axis=1), 0))
    chosen = np.asarray(colours, np.float64).reshape(-1, 3) if colours else np.ones((len(flat), 3))
    return Lights(np.column_stack([flat, z]), chosen)


def _frame(direction: F64) -> F64:
    """Return two directions across a unit one, and that one, in rows (3, 3)."""
    aside = np.eye(3)[np.argmin(np.abs(direction))]
    right = np.cross(aside, direction)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(direction, right), direction])


def _sums(cell: NDArray[np.int64], values: F64, cells: int) -> F64:
    return np.stack([np.bincount(cell, column, cells) for column in values.T], axis=1)
