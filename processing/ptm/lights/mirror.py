"""A mirror ball as a compass: which direction a place in its picture mirrors.

The camera stands at the origin of the view frame (x right, y up, z from the sample to the camera) and looks along −z;
the ball has radius 1. A ray u through the outline touches the ball, so that u·c = cos βmax for the axis c of its cone,
and the centre is d = 1/sin βmax away. A ray inside meets the ball at the point with normal n, and comes, mirrored, from
r = 2(n·v)n − v, where v = −u goes back to the camera.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from litrig.base.camera_model import FARTHEST_RADII, CameraModel
from litrig.base.errors import InputError
from processing.outline.circle import Circle

F64 = NDArray[np.float64]

_OUTLINE_POINTS = 360
_MOST_ROUNDS, _CLOSE = 50, 1e-12


@dataclass(frozen=True)
class Mirror:
    """A ball in the pictures, and how the camera sees it.

    Attributes
    ----------
    circle : its outline; away from the camera's axis that is an ellipse with this centre and this mean radius
    camera : pinhole model of the pictures, whose distortion has been taken out; None for orthographic pictures
    """

    circle: Circle
    camera: CameraModel | None = None

    def directions(self, places_px: F64) -> F64:
        """Return where the light comes from that is seen at these places.

        Parameters
        ----------
        places_px : (N, 2) x and y in the picture, inside the outline; places outside count as on it

        Returns
        -------
        directions : (N, 3) float64, unit, view frame, ball to light; the light is taken to be far away
        """
        normals, to_eye = self._seen(places_px)
        mirrored: F64 = 2 * np.sum(normals * to_eye, axis=-1, keepdims=True) * normals - to_eye
        return mirrored

    def facing(self, places_px: F64) -> F64:
        """Return the cosine (N,) between normal and ray: 1 where the ball faces the camera, 0 at its rim."""
        normals, to_eye = self._seen(places_px)
        cosine: F64 = np.sum(normals * to_eye, axis=-1)
        return cosine

    @property
    def distance_radii(self) -> float | None:
        """Distance from the camera to the ball's centre in radii; None for orthographic pictures."""
        return None if self.camera is None else float(np.linalg.norm(self._centre))

    def _seen(self, places_px: F64) -> tuple[F64, F64]:
        """Return the normals that are seen at places, and the unit vectors from there to the eye; (N, 3) each."""
        if self.camera is None:
            return self._seen_from_afar(places_px)
        rays = self._rays(places_px)
        along = rays @ self._centre
        miss2 = np.maximum(along**2 - (self._centre @ self._centre - 1), 0)
        normals = (along - np.sqrt(miss2))[:, None] * rays - self._centre
        return normals / np.linalg.norm(normals, axis=-1, keepdims=True), -rays

    def _seen_from_afar(self, places_px: F64) -> tuple[F64, F64]:
        across = (places_px - [self.circle.x_px, self.circle.y_px]) * [1, -1] / self.circle.radius_px
        across = across / np.maximum(np.linalg.norm(across, axis=-1, keepdims=True), 1)
        height = np.sqrt(np.maximum(1 - np.sum(across**2, axis=-1), 0))
        to_eye = np.tile([0.0, 0.0, 1.0], (len(places_px), 1))
        return np.column_stack([across, height]), to_eye

    @cached_property
    def _centre(self) -> F64:
        """Fit the cone of the outline: u·w = 1 with w = c/cos βmax, linear in w and exact for the true ellipse."""
        turn = 2 * np.pi * np.arange(_OUTLINE_POINTS) / _OUTLINE_POINTS
        amount, towards = stretch(self.circle, self.camera)
        radius_px = self.circle.radius_px * (1 + amount * np.cos(2 * (turn - towards)))
        around = radius_px[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        rays = self._rays(around + np.array([self.circle.x_px, self.circle.y_px]))
        slant = np.linalg.lstsq(rays, np.ones(len(rays)), rcond=None)[0]
        length = np.linalg.norm(slant)
        centre: F64 = slant / np.sqrt(length**2 - 1)  # c·d, for d = 1/√(1 − cos²) and |w| = 1/cos
        return centre

    def _rays(self, places_px: F64) -> F64:
        assert self.camera is not None  # noqa: S101  # for the type checker: no rays without a camera
        x = (places_px[:, 0] - self.camera.centre_x_px) / self.camera.focal_x_px
        y = (self.camera.centre_y_px - places_px[:, 1]) / self.camera.focal_y_px
        rays = np.stack([x, y, np.full_like(x, -1.0)], axis=1)
        return np.asarray(rays / np.linalg.norm(rays, axis=1, keepdims=True))


def stretch(circle: Circle, camera: CameraModel | None) -> tuple[float, float]:
    """Return how far a ball's outline is from a circle: ε and φ₀ in ρ(φ) = r·(1 + ε cos 2(φ − φ₀)), y downwards.

    A cone of half-angle β whose axis is θ off the camera's makes an ellipse with its long axis towards the principal
    point, and the ratio of its axes is cos β/√(cos² β − sin² θ).
    """
    if camera is None:
        return 0.0, 0.0
    focal_px = (camera.focal_x_px + camera.focal_y_px) / 2
    x, y = circle.x_px - camera.centre_x_px, circle.y_px - camera.centre_y_px
    off2 = np.sin(np.arctan(np.hypot(x, y) / focal_px)) ** 2
    cos2 = 1 / (1 + (circle.radius_px / focal_px) ** 2)
    if off2 >= cos2:
        return 0.0, 0.0
    ratio = np.sqrt(cos2 / (cos2 - off2))
    return float((ratio - 1) / (ratio + 1)), float(np.arctan2(y, x))


def camera_at(distance_radii: float, circle: Circle, shape: tuple[int, int]) -> CameraModel:
    """Return the pinhole camera whose axis meets the picture's centre, and which sees this ball from that distance.

    Parameters
    ----------
    distance_radii : camera to the ball's centre, in its radii
    shape : height and width of the pictures

    Raises
    ------
    InputError
        The distance is one that a camera cannot have.
    """
    if not 1 < distance_radii <= FARTHEST_RADII:
        raise InputError(
            f"the camera cannot stand {distance_radii:g} radii from the ball's centre; measure again, in radii of the "
            f"ball (more than 1, at most {FARTHEST_RADII:g})"
        )
    height, width = shape
    focal_px = circle.radius_px * np.sqrt(distance_radii**2 - 1)
    for _ in range(_MOST_ROUNDS):
        camera = CameraModel(
            width=width,
            height=height,
            focal_x_px=focal_px,
            focal_y_px=focal_px,
            centre_x_px=width / 2,
            centre_y_px=height / 2,
        )
        found = Mirror(circle, camera).distance_radii or distance_radii
        if abs(found / distance_radii - 1) < _CLOSE:
            break
        # Away from the axis a ball's picture is larger than on it.
        focal_px *= np.sqrt((distance_radii**2 - 1) / (found**2 - 1))
    return camera
