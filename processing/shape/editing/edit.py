"""Carry out a recipe: from the normals of a picture to others, and to factors of its shading."""

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.shape.buffers_exr import Tell
from processing.shape.editing.displace import displaced
from processing.shape.editing.operations import (
    AnyOperation,
    Bump,
    Emboss,
    Factors,
    Noise,
    Painted,
    Recipe,
    Ripple,
    Smooth,
)
from processing.shape.editing.pictures import height_map, mask_weights, painted_normals
from processing.shape.editing.places import Ground
from processing.shape.editing.reliefs import Heights, noise_heights, picture_heights, ripple_heights
from processing.shape.editing.smooth import smoothed
from processing.shape.editing.tilt import blended, detailed, emboss, tilted
from processing.shape.model import BACKGROUND, ShadingBuffers

F32 = NDArray[np.float32]


@dataclass(frozen=True)
class Edited:
    """What edits have made.

    Attributes
    ----------
    normals : (H, W, 3) float32, unit, view frame; bit by bit the picture's own where nothing was done
    positions : (H, W, 3) float32, as far as they were displaced
    diffuse_factor, reflection_factor : (H, W) float32, k_D and k_R
    """

    normals: F32
    positions: F32
    diffuse_factor: F32
    reflection_factor: F32


def edit(buffers: ShadingBuffers, recipe: Recipe, tell: Tell | None = None, *, is_frame: bool = False) -> Edited:
    """Carry out operations in their order, each on what the one before has left.

    Parameters
    ----------
    tell : called with each remark
    is_frame : the picture is one of a sequence, which a surface may enter and leave

    Raises
    ------
    InputError, FormatError
        A file that the recipe names cannot be used, a surface is not in the picture, or a place shows none.
    """
    tell = tell or (lambda _: None)
    ones = np.ones(buffers.shape, np.float32)
    state = Edited(buffers.normals, buffers.positions, ones, ones)
    for number, operation in enumerate(recipe.steps, 1):
        if operation.surfaces and not is_frame:
            check_surfaces(buffers, operation.surfaces, f"step {number}, {operation.op}")
        weight = _weight(buffers, operation)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            state = _done(buffers, state, operation, weight, tell)
    return state


def _weight(buffers: ShadingBuffers, operation: AnyOperation) -> F32:
    weight: F32 = (buffers.surfaces != BACKGROUND).astype(np.float32) * np.float32(operation.strength)
    if operation.surfaces:
        weight = np.where(np.isin(buffers.surfaces, operation.surfaces), weight, 0).astype(np.float32)
    if operation.mask is not None:
        weight = (weight * mask_weights(operation.mask, buffers)).astype(np.float32)
    return weight


def check_surfaces(buffers: ShadingBuffers, wanted: Collection[int], what: str) -> None:
    """Refuse numbers of surfaces that the picture does not show."""
    if strange := sorted(set(wanted) - set(buffers.seen)):
        raise InputError(
            f"{what}: no surface {strange[0]} in the picture; there are {', '.join(map(str, buffers.seen))}"
        )


def _done(buffers: ShadingBuffers, state: Edited, operation: AnyOperation, weight: F32, tell: Tell) -> Edited:
    eye: F32 | None = buffers.to_eye
    match operation:
        case Factors(diffuse=diffuse, reflection=reflection):
            k_d, k_r = (1 + weight * np.float32(k - 1) for k in (diffuse, reflection))
            return replace(
                state, diffuse_factor=state.diffuse_factor * k_d, reflection_factor=state.reflection_factor * k_r
            )
        case Emboss(beta=beta):
            new = emboss(state.normals, beta) if beta != 1 else state.normals
        case Smooth(radius=radius, depth_radius=depth_radius):
            new = smoothed(buffers, state.normals, radius, depth_radius)
        case Painted():
            new, painted = painted_normals(
                operation.file,
                buffers,
                green_is_down=operation.green == "down",
                in_surface=operation.space == "surface",
                tell=tell,
            )
            if operation.space == "surface":
                new = detailed(state.normals, new)
            else:
                eye = None  # they are taken as they are, as a renderer's bumps may look away at the rim
            weight = np.where(painted, weight, 0).astype(np.float32)
        case Bump() | Noise() | Ripple():
            heights = _heights(buffers, operation)
            if operation.displace:
                new, moved = displaced(buffers, state.normals, state.positions, heights.height * weight)
                _tell_lost(operation, new, weight, tell)
                normals = blended(state.normals, new, np.ones_like(weight), eye)
                moved = np.where(np.isfinite(moved).all(axis=-1, keepdims=True), moved, state.positions)
                return replace(state, normals=normals, positions=moved)
            new = tilted(state.normals, heights.gradient)
            new = np.where(np.any(heights.gradient != 0, axis=-1)[..., None], new, state.normals)
    _tell_lost(operation, new, weight, tell)
    return replace(state, normals=blended(state.normals, new, weight, eye))


def _tell_lost(operation: AnyOperation, new: F32, weight: F32, tell: Tell) -> None:
    """Say where an edit leads beyond what numbers hold; `blended` keeps the old normals there."""
    if lost := int(np.count_nonzero((weight > 0) & ~np.isfinite(new).all(axis=-1))):
        tell(f"{operation.op} leads beyond all numbers in {lost} pixels, which keep their normals")


def _heights(buffers: ShadingBuffers, relief: Bump | Noise | Ripple) -> Heights:
    ground = Ground.of(buffers, relief.across, None if isinstance(relief, Noise) else relief.at)
    match relief:
        case Bump():
            size = relief.size or float(buffers.shape[1])
            heights = height_map(relief.heights)
            height = size / 20 if relief.height is None else relief.height
            return picture_heights(ground, heights, height, size, relief.turn_deg, relief.repeat)
        case Noise():
            return noise_heights(ground, relief.height, relief.scale, relief.octaves, relief.seed)
        case Ripple():
            return ripple_heights(ground, relief.height, relief.wavelength, relief.fade, relief.phase_deg)
