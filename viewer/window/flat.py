"""A PTM as the picture that it is: a rectangle that faces the camera, panned and zoomed."""

import numpy as np

from processing.mesh.model import Mesh
from processing.reference.camera import Camera
from viewer.window.turn import Spot

Size = tuple[int, int]


def rectangle(size: Size) -> Mesh:
    """Make one with the sides of a picture, the longer from −1 to 1; its tangent points to the right."""
    half_x, half_y = (side / max(size) for side in size)
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], np.float32)
    facing, right = np.tile(np.eye(3, dtype=np.float32), (4, 1, 1))[:, [2, 0]].swapaxes(0, 1)
    return Mesh(
        positions=np.concatenate([corners * np.array([half_x, half_y], np.float32), np.zeros((4, 1), np.float32)], 1),
        normals=facing,
        tangents=right,
        uvs=(corners + 1) * np.float32(0.5),
        triangles=np.array([[0, 1, 2], [0, 2, 3]], np.int32),
    )


def flat_camera(picture: Size, size: Size, zoom: float, pan: Spot) -> Camera:
    """Look straight at the rectangle; at zoom 1 without pan it just fits.

    Parameters
    ----------
    picture : width and height of what the rectangle shows
    size : width and height of what is drawn, in pixels
    pan : where its middle is, in halves of the shorter side drawn
    """
    halves = np.array(size) / min(size)
    fit = float(np.min(halves / (np.array(picture) / max(picture)))) * zoom
    clip_from_view = np.diag([fit / halves[0], fit / halves[1], -1.0, 1.0])
    clip_from_view[:2, 3] = np.array(pan) / halves
    return Camera(np.eye(3), clip_from_view, None)
