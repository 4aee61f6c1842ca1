"""A material under many lights at once: light adds up in linear light, and there alone."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from litrig.base.progress import Progress, Report, silent
from litrig.base.radiometry import decode_srgb
from processing.ptm.basis import Basis
from processing.ptm.model import Ptm
from processing.ptm.relighting.highlight import Highlight, shade
from processing.ptm.relighting.lights import Lights

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

RINGS = 8
_ROWS = 64
_CHUNK = 65_536


def relight_by_many(ptm: Ptm, lights: Lights, highlight: Highlight | None = None, report: Report = silent) -> F32:
    """Sum the pictures of a material under each light, times the light's colour.

    Linear values sum in the basis: one weight a term and channel, Σ colour·term(l), over all lights however many.
    Values fitted to display values do not add up, and highlights have no basis: these pictures are made one by one,
    decoded, and summed. More than 4·RINGS² lights are gathered for this into as many cells of the half-sphere. Under a
    sky with a sun that changes display values by less than one of 255; in HSH of 16 terms by a few, where the fit
    swings at the horizon.

    Returns
    -------
    picture : (H, W, 3) float32, linear light, not cut off
    """
    few = lights.gathered(RINGS) if len(lights.directions) > 4 * RINGS**2 else lights
    weights = light_weights(ptm.basis, lights).astype(np.float32) if ptm.space == "linear" else None
    picture = np.zeros((*ptm.shape, 3), np.float32)
    for top in range(0, ptm.shape[0], _ROWS):
        rows = slice(top, top + _ROWS)
        coefficients, colour = ptm.strip(rows)
        gloss = None if highlight is None else highlight.strip(rows)
        if weights is None:
            part = replace(ptm, coefficients=coefficients, colour=colour)
            picture[rows] = _decoded_sum(part, few, gloss)
        else:
            values = np.einsum("tc,thwc->hwc", weights, np.broadcast_to(coefficients, (*coefficients.shape[:3], 3)))
            picture[rows] = values if colour is None else values * colour
            picture[rows] += _highlights(gloss, few)
        report(Progress("relighting", min(top + _ROWS, ptm.shape[0]), ptm.shape[0], "rows"))
    return picture


def light_weights(basis: Basis, lights: Lights) -> F64:
    """Integrate the terms of a basis over the lights: (T, 3), one weight a term and channel."""
    weights = np.zeros((basis.terms, 3))
    for start in range(0, len(lights.directions), _CHUNK):
        chunk = slice(start, start + _CHUNK)
        weights += basis.evaluate(lights.directions[chunk]).T @ lights.colours[chunk]
    return weights


def _decoded_sum(ptm: Ptm, lights: Lights, highlight: Highlight | None) -> F32:
    total = np.zeros((*ptm.shape, 3), np.float32)
    for direction, colour in zip(lights.directions, lights.colours.astype(np.float32), strict=True):
        total += decode_srgb(shade(ptm, direction, highlight)) * colour
    return total


def _highlights(highlight: Highlight | None, lights: Lights) -> F32 | float:
    if highlight is None:
        return 0.0
    total = np.zeros((*highlight.normals.shape[:2], 3), np.float32)
    for direction, colour in zip(lights.directions, lights.colours.astype(np.float32), strict=True):
        total += highlight.under(direction)[..., None] * colour
    return total
