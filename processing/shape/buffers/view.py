"""From where a rendered picture is seen: positions in the view frame, or what stands in for them."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from processing.shape.buffers.camera import CameraSaid, axes_seen, focal_px, positions_from_depth, world_to_camera
from processing.shape.buffers.channels import Stored
from processing.shape.buffers.layers import Found
from processing.shape.buffers.pixels import Pixels, Tell

F32 = NDArray[np.float32]


@dataclass(frozen=True)
class View:
    """Positions, and what takes normals where they are.

    Attributes
    ----------
    positions : (H, W, 3) float32, view frame
    turn : (3, 3), rows of normals are multiplied by it
    orthographic : all is seen along −z
    """

    positions: F32
    turn: NDArray[np.float64]
    orthographic: bool


def view_of(
    path: Path,
    stored: Stored,
    found: Mapping[str, Found],
    made: Mapping[str, F32],
    said: CameraSaid,
    pixels: Pixels,
    tell: Tell,
) -> View:
    """Bring positions into the view frame, and say how normals turn with them.

    Parameters
    ----------
    made : buffers as stored, among them positions or depth, if there are any
    """
    matrix = world_to_camera(path, stored.header, said)
    turn = np.eye(3) if matrix is None else matrix[:3, :3]
    shift = np.zeros(3) if matrix is None else matrix[3, :3]
    on_axis = np.broadcast_to(np.array([0, 0, -1], np.float32), made["normal"].shape)
    if "position" in made:
        pixels.check_numbers("position", made["position"])
        stored_positions = np.where(pixels.shown[..., None], made["position"], 0)
        positions = (stored_positions @ turn + shift).astype(np.float32)
        if not said.orthographic:
            pixels.check_apart(positions)
            signs = axes_seen(positions, pixels.shown)
            if np.any(signs < 0):
                tell("the camera's own axes are not right, up and back; " + _flipped(signs))
            positions, turn = (positions * signs).astype(np.float32), turn * signs
        return View(positions, turn, said.orthographic)
    if "depth" not in made:
        tell("no positions and no depth: everything is seen along one direction, as from far away")
        return View(on_axis, turn, True)
    pixels.check_numbers("depth", made["depth"])
    depth = np.abs(made["depth"])
    focal = None if said.orthographic else focal_px(stored.header, depth.shape[1], said)
    if focal is None:
        if not said.orthographic:
            tell("depth, but no field of view: everything is seen along one direction; say --fov DEG")
        depth = np.where(pixels.shown, depth, 1)
        return View((on_axis * depth[..., None]).astype(np.float32), turn, True)
    along_ray = said.depth_along_ray or _is_distance(found["depth"], stored)
    positions = positions_from_depth(depth, focal, along_ray)
    pixels.check_apart(positions)
    return View(positions, turn, False)


def _is_distance(depth: Found, stored: Stored) -> bool:
    """Tell whether depth is measured along rays, as mitsuba does, and calls it T."""
    return f"{depth.recipe.terms[0]}.T" in stored.planes


def _flipped(signs: NDArray[np.float64]) -> str:
    return f"{' and '.join(axis for axis, sign in zip('xyz', signs, strict=True) if sign < 0)} turned round"
