"""Shading under other normals on the processor, in one pass over the pixels (the Shape paper, section 4)."""

import math

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.kernels import kernel
from processing.shape.albedo import check_reflectance
from processing.shape.bands import in_bands
from processing.shape.horizon import HORIZON
from processing.shape.model import BACKGROUND, Environments, ShadingBuffers

F32 = NDArray[np.float32]
Factor = float | F32
_NO_ENVIRONMENT = -1
_MISALIGNED = np.float32(0.005 * math.pi)
"""ε of equation 4."""
_HALF_CHORD = np.float32(math.sin(0.005 * math.pi / 2))
"""Half the chord of ε; beyond it no angle is needed."""


class Recomposer:
    """A picture with its buffers and environments, to be shaded again and again under other normals.

    Raises
    ------
    InputError
        There is no environment, they are not square maps of one size, or they need an albedo that the buffers lack.
    """

    def __init__(self, buffers: ShadingBuffers, environments: Environments) -> None:
        check_reflectance(buffers, environments)
        numbers = sorted(environments)
        maps = [side for number in numbers for side in (environments[number].front, environments[number].back)]
        if not numbers or BACKGROUND in numbers:
            raise InputError(f"environments: of surfaces {numbers}; give at least one, {BACKGROUND} is background")
        if any(side.shape != (len(side), len(side), 3) or side.shape != maps[0].shape for side in maps):
            raise InputError("environments: maps are not square and of one size; reconstruct them again")
        self._buffers = buffers
        self._places = np.full(buffers.shape, _NO_ENVIRONMENT, np.int32)
        for place, number in enumerate(numbers):
            self._places[buffers.surfaces == number] = place
        self._maps = np.ascontiguousarray(np.stack(maps).reshape(len(numbers), 2, *maps[0].shape), np.float32)
        self._harmonics = np.stack([environments[number].diffuse for number in numbers]).astype(np.float32)
        self._flags = np.array(
            [
                (environments[number].diffuse_is_illumination, environments[number].reflection_is_illumination)
                for number in numbers
            ]
        )
        self._to_eye = buffers.to_eye
        none = np.ones((1, 1, 3), np.float32)
        self._albedo = none if buffers.albedo is None else buffers.albedo
        self._reflection_albedo = none if buffers.reflection_albedo is None else buffers.reflection_albedo

    def picture(
        self,
        normals: F32,
        *,
        diffuse_factor: Factor = 1.0,
        reflection_factor: Factor = 1.0,
        horizon: float = HORIZON,
    ) -> F32:
        """Shade the picture under other normals; what has the same ones, and factors of 1, keeps its bits.

        Parameters
        ----------
        normals : (H, W, 3) unit, view frame
        diffuse_factor, reflection_factor : k_D and k_R of equation 5, for all pixels or (H, W)
        horizon : r̃·n from which down the surface hides mirrored rays; 0 is equation 4 as it is printed

        Returns
        -------
        picture : (H, W, 3) float32, linear light

        Raises
        ------
        InputError
            Normals or factors are of another size.
        """
        height, width = self._buffers.shape
        if normals.shape != (height, width, 3):
            raise InputError(f"normals: {normals.shape} are not those of {width} × {height} pixels; give (H, W, 3)")
        factors = [np.asarray(factor, np.float32) for factor in (diffuse_factor, reflection_factor)]
        if any(factor.shape not in ((), (height, width)) for factor in factors):
            raise InputError(f"factors: are not one, nor those of {width} × {height} pixels")
        # Copies, so that the kernel is compiled for one layout.
        k_d, k_r = (np.array(np.broadcast_to(factor, (height, width)), order="C") for factor in factors)
        b = self._buffers
        picture = np.array(b.picture, np.float32)
        planes = (picture, b.coverage, b.diffuse, b.reflection, b.ambient_occlusion, b.reflection_occlusion, b.normals)
        new = np.asarray(normals, np.float32)
        light = (self._harmonics, self._maps, self._flags, self._albedo, self._reflection_albedo)

        def shade(first: int, end: int) -> None:
            _recompose(first, end, *planes, new, self._to_eye, self._places, *light, k_d, k_r, np.float32(horizon))

        in_bands(height, shade)
        return picture


def recompose(
    buffers: ShadingBuffers,
    environments: Environments,
    normals: F32,
    *,
    diffuse_factor: Factor = 1.0,
    reflection_factor: Factor = 1.0,
    horizon: float = HORIZON,
) -> F32:
    """Shade a picture again once, as `Recomposer.picture` does."""
    return Recomposer(buffers, environments).picture(
        normals, diffuse_factor=diffuse_factor, reflection_factor=reflection_factor, horizon=horizon
    )


@kernel
def _recompose(
    first: int,
    end: int,
    picture: F32,
    coverage: F32,
    diffuse: F32,
    reflection: F32,
    ambient: F32,
    reflected: F32,
    normals: F32,
    changed: F32,
    to_eye: F32,
    places: NDArray[np.int32],
    harmonics: F32,
    maps: F32,
    flags: NDArray[np.bool_],
    albedo: F32,
    reflection_albedo: F32,
    k_d: F32,
    k_r: F32,
    horizon: np.float32,
) -> None:
    zero, one, half, two = np.float32(0), np.float32(1), np.float32(0.5), np.float32(2)
    width = places.shape[1]
    size = maps.shape[2]
    terms = np.zeros(9, np.float32)
    for row in range(first, end):
        for column in range(width):
            place = places[row, column]
            if place < 0:
                continue
            x0, y0, z0 = normals[row, column, 0], normals[row, column, 1], normals[row, column, 2]
            x1, y1, z1 = changed[row, column, 0], changed[row, column, 1], changed[row, column, 2]
            kd, kr = k_d[row, column], k_r[row, column]
            same = x0 == x1 and y0 == y1 and z0 == z1
            if same and kd == one and kr == one:
                continue
            share, u, v, side = zero, zero, zero, 0
            if not same:
                # Differences of basis values, taken before they are weighted.
                terms[1] = np.float32(0.48860251) * (y1 - y0)
                terms[2] = np.float32(0.48860251) * (z1 - z0)
                terms[3] = np.float32(0.48860251) * (x1 - x0)
                terms[4] = np.float32(1.09254843) * (x1 * y1 - x0 * y0)
                terms[5] = np.float32(1.09254843) * (y1 * z1 - y0 * z0)
                terms[6] = np.float32(0.94617470) * (z1 * z1 - z0 * z0)
                terms[7] = np.float32(1.09254843) * (x1 * z1 - x0 * z0)
                terms[8] = np.float32(0.54627422) * ((x1 * x1 - x0 * x0) - (y1 * y1 - y0 * y0))
                vx, vy, vz = to_eye[row, column, 0], to_eye[row, column, 1], to_eye[row, column, 2]
                along0 = two * (x0 * vx + y0 * vy + z0 * vz)
                along1 = two * (x1 * vx + y1 * vy + z1 * vz)
                rx, ry, rz = along1 * x1 - vx, along1 * y1 - vy, along1 * z1 - vz
                dx, dy, dz = along0 * x0 - vx - rx, along0 * y0 - vy - ry, along0 * z0 - vz - rz
                chord = half * np.sqrt(dx * dx + dy * dy + dz * dz)
                share = one if chord >= _HALF_CHORD else two * np.arcsin(chord) / _MISALIGNED
                share *= reflected[row, column]
                if horizon > zero:
                    share *= min(max((rx * x0 + ry * y0 + rz * z0) / horizon, zero), one)
                if share > zero:
                    side = 0 if rz >= zero else 1
                    below = one + abs(rz)
                    u = (one + rx / below) * half * np.float32(size) - half
                    v = (one - ry / below) * half * np.float32(size) - half
                    u, v = min(max(u, zero), np.float32(size - 1)), min(max(v, zero), np.float32(size - 1))
            left, top = int(u), int(v)
            right, bottom = min(left + 1, size - 1), min(top + 1, size - 1)
            u -= np.float32(left)
            v -= np.float32(top)
            alpha, open_d = coverage[row, column], ambient[row, column]
            red, green, blue = zero, zero, zero
            if not same:
                for term in range(1, 9):
                    red += terms[term] * harmonics[place, term, 0]
                    green += terms[term] * harmonics[place, term, 1]
                    blue += terms[term] * harmonics[place, term, 2]
            for channel in range(3):
                d0, r0 = diffuse[row, column, channel], reflection[row, column, channel]
                d, r = d0, r0
                if not same:
                    rebuilt = red if channel == 0 else green if channel == 1 else blue
                    if flags[place, 0]:
                        rebuilt *= albedo[row, column, channel]
                    d = d0 + open_d * (max(d0 + rebuilt, min(d0, zero)) - d0)
                if share > zero:
                    upper = maps[place, side, top, left, channel]
                    upper += u * (maps[place, side, top, right, channel] - upper)
                    lower = maps[place, side, bottom, left, channel]
                    lower += u * (maps[place, side, bottom, right, channel] - lower)
                    mirrored = upper + v * (lower - upper)
                    if flags[place, 1]:
                        mirrored *= reflection_albedo[row, column, channel]
                    r = r0 + share * (mirrored - r0)
                change = alpha * ((kd * d - d0) + (kr * r - r0))
                if change != zero:
                    picture[row, column, channel] += change
