"""Surfaces by formula: each takes the parameters u and v, 0..1, and returns x, y, z (y up)."""

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray

from processing.mesh import jets
from processing.mesh.jets import Jet

Point = tuple[Jet, Jet, Jet]
F64 = NDArray[np.float64]
_TURN = 2 * math.pi


def torus(u: Jet, v: Jet) -> Point:
    """Return a torus about the y axis; u runs along the ring, v round the tube."""
    tube = 0.36
    along, around = u * _TURN, v * _TURN
    from_axis = (jets.cos(around) * tube + 1.0) / (1 + tube)
    return from_axis * jets.sin(along), jets.sin(around) * (tube / (1 + tube)), from_axis * jets.cos(along)


def ribbon(u: Jet, v: Jet) -> Point:
    """Return a gymnast's ribbon: a band that winds about the x axis, widens and shows both its sides."""
    turns = 2.25
    wind = u * (turns * _TURN)
    radius = 0.24 + 0.34 * u
    across = (v - 0.5) * (0.26 + 0.1 * u)
    lean = 0.55 * jets.sin(wind * 0.5)
    from_axis = radius + across * jets.sin(lean)
    x = u * 1.7 - 0.85 + across * jets.cos(lean)
    return x, from_axis * jets.cos(wind), from_axis * jets.sin(wind)


def pillow_side(u: Jet, v: Jet, side: float) -> Point:
    """Return the front (side 1) or the back (side −1) of a pillow with drawn-in edges and puckers along its seam."""
    a, b = (2 * u - 1) * side, 2 * v - 1
    a2, b2 = a * a, b * b
    inside = (1 - a2) * (1 - b2)
    soft = 0.16
    height = jets.sqrt(inside + soft**2) - soft
    pucker = 0.018 * inside * (jets.cos(b * 29.0) * a2 * a2 + jets.cos(a * 29.0) * b2 * b2)
    # Filling draws the middle of each edge inwards and leaves the corners out.
    x = a * (1 - 0.13 * (1 - b2) * a2)
    y = b * (1 - 0.13 * (1 - a2) * b2)
    return x, y, (0.52 * height + pucker) * side


def cloth(u: Jet, v: Jet) -> Point:
    """Return a square cloth over a ball: smooth on top, then hanging in folds, longest at its corners.

    The way ρ from the middle over the cloth is kept: what the smaller circle of the hanging cloth does not need of its
    length 2πρ goes into folds. n waves of amplitude A lengthen a circle of radius r by 1 + (nA/r)²/4 to first order.
    """
    folds = 9
    x, y = (2 * u - 1) * _HALF_SIDE, (2 * v - 1) * _HALF_SIDE
    rho = jets.sqrt(x * x + y * y + 1e-6)
    phi = jets.angle(y, x + 1e-9)
    radius, drop = _profile(rho)
    loose = jets.tanh((rho / _CONTACT) ** 6.0)
    spare = jets.sqrt(rho * rho - radius * radius + 1e-4)
    swing = 0.5 * jets.sin(2 * phi + 0.7) + 0.25 * jets.sin(3 * phi - 1.1) + 0.25 * (rho - _CONTACT)
    wave = phi * float(folds) + swing
    depth = 1 + 0.3 * jets.sin(4 * phi + 2.1) + 0.1 * jets.sin(5 * phi)
    amplitude = spare * loose * depth * (0.62 * math.sqrt(2) / folds)
    out = radius + amplitude * (jets.cos(wave) + 0.18 * jets.cos(2 * wave + 0.6))
    # A fold hangs over: its flanks are steeper than those of a cosine.
    turned = (amplitude / radius) * -0.26 * jets.sin(2 * wave)
    ripple = 0.05 * amplitude * jets.sin(wave + 1.3)
    # The direction x/ρ, y/ρ is smooth in the middle, where the angle itself is not.
    east, north = x / rho, y / rho
    ahead = east * jets.cos(turned) - north * jets.sin(turned)
    aside = north * jets.cos(turned) + east * jets.sin(turned)
    return out * aside, -drop + ripple, out * ahead


def skirt(u: Jet, v: Jet) -> Point:
    """Return a flared skirt about the y axis; u runs round it, counter-clockwise from above, v from hem to waist.

    It is a cone whose folds deepen towards the hem.
    """
    around = u * _TURN
    slant = SKIRT_WAIST + (1 - v) * (1 - SKIRT_WAIST)
    hanging = (1 - v) * (1 - v)
    wave = around * 6.0 + 0.5 * jets.sin(2 * around + 0.7) + 0.35 * jets.sin(3 * around - 1.1)
    depth = 1 + 0.3 * jets.sin(around + 2.1) + 0.2 * jets.sin(3 * around)
    fold = 0.06 * hanging * depth * (jets.cos(wave) + 0.2 * jets.cos(2 * wave + 0.6))
    radius = slant * SKIRT_FLARE + fold
    height = slant * -math.sqrt(1 - SKIRT_FLARE**2) + 0.3 * fold
    return radius * jets.sin(around), height, radius * jets.cos(around)


SKIRT_WAIST = 0.25
"""Way from the cone's tip to the waist, as a share of that to the hem."""
SKIRT_FLARE = 0.5
"""Sine of the angle between the cone and its axis."""

_HALF_SIDE = 1.25
_CONTACT = 0.95
_BALL = 0.62
_STEEPEST = math.radians(80)


def _profile(rho: Jet) -> tuple[Jet, Jet]:
    """Return the smooth cloth's distance from the axis and its drop, at way ρ from the middle."""
    ways, radii, drops = _profile_table()
    radius = jets.function(rho, lambda s: np.interp(s, ways, radii), lambda s: np.cos(_slope_rad(s)))
    drop = jets.function(rho, lambda s: np.interp(s, ways, drops), lambda s: np.sin(_slope_rad(s)))
    return radius, drop


def _slope_rad(way: F64) -> F64:
    """Return how steeply the cloth falls: as on a ball at first, never more than it can hang."""
    slope: F64 = _STEEPEST * np.tanh(way / (_BALL * _STEEPEST))
    return slope


@cache
def _profile_table() -> tuple[F64, F64, F64]:
    """Integrate the slope along the way by the midpoint rule, finely enough for float32."""
    ways = np.linspace(0, 1.5 * _HALF_SIDE, 20_001)
    middles = (ways[1:] + ways[:-1]) / 2
    step = ways[1] - ways[0]
    radii = np.concatenate([[0], np.cumsum(np.cos(_slope_rad(middles)))]) * step
    drops = np.concatenate([[0], np.cumsum(np.sin(_slope_rad(middles)))]) * step
    return ways, radii, drops
