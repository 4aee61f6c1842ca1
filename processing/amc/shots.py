"""The pictures of one turn, with the sphere found in them, and the slices that they give."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from litrig.base.camera_model import CameraModel
from litrig.base.capture_folder.capture import Capture, CapturedFrame, Role
from litrig.base.errors import InputError
from litrig.base.progress import Progress, Report
from processing.amc.geometry import SphereView, texel_plane
from processing.amc.harmonics import check_angles
from processing.amc.noise import difference_gain
from processing.amc.resample import make_resampler
from processing.amc.settings import Settings
from processing.amc.table import Series
from processing.amc.tangent_turn import TangentTurn
from processing.composite import pictures_of
from processing.outline.circle import Circle
from processing.outline.orbit import Orbit, Outline, find_outline
from processing.room import Room, make_room
from processing.stack import Stack, Window
from processing.undistort import undistortion

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

_MARGIN_PX = 3
_TOUCHED = 0.01
"""Share of a texel that a mark must cover to count."""


@dataclass(frozen=True)
class Slices:
    """What the pictures say of every table normal.

    Attributes
    ----------
    room : where they are
    valid : (S, S) bool, texels that were seen
    turn : (S, S) from the tangent's picture angle to the table's
    difference_gain : what `noise_variance` must know of the resampling
    """

    room: Room
    valid: NDArray[np.bool_]
    turn: TangentTurn
    difference_gain: float

    @property
    def light(self) -> F32:
        """Linear light (N, S, S, 3) float32, black outside `valid`."""
        return self.room.array

    @property
    def normals(self) -> F64:
        """True normals (S, S, 3) of the texels, in the view frame."""
        flat = np.sqrt(1 - self.turn.normal_z**2)
        x, y = flat * np.cos(self.turn.azimuth_rad), flat * np.sin(self.turn.azimuth_rad)
        return np.stack([x, y, self.turn.normal_z], axis=-1)


@dataclass(frozen=True)
class Shots:
    """Pictures of one turn of the sphere.

    Attributes
    ----------
    stack : the pictures by rising tangent angle
    tangents_deg : (N,) tangent angle of each
    first : which of them was shot first
    series : what their angles can tell
    outline : where the sphere is in each
    distance_radii : camera to sphere centre; None for orthographic pictures
    source : digest of the frames
    """

    stack: Stack
    tangents_deg: F64
    first: int
    series: Series
    outline: Outline
    distance_radii: float | None
    source: str

    def slices(self, view: SphereView, size: int, report: Report) -> Slices:
        """Resample every picture for one kind of table normal."""
        window, (left, top) = self._window()
        circle = self.outline.circle
        resampler = make_resampler(Circle(circle.x_px - left, circle.y_px - top, circle.radius_px), view, size)
        room = make_room((len(self.stack), size, size, 3))

        def resample(index: int, part: F32) -> None:
            resampler(part, self._shift_px(index), out=room.array[index])
            room.release()

        for index, _ in enumerate(self.stack.each(window, resample)):
            report(Progress("resampling", index + 1, len(self.stack), self.stack.paths[index].name))
        shape = (window[0].stop - window[0].start, window[1].stop - window[1].start)
        turn = _tangent_turn(view, size)
        return Slices(room, resampler.valid, turn, difference_gain(resampler, shape))

    def marked(self, mask: Mask, view: SphereView, size: int) -> Mask:
        """Follow a mask (H, W) over the picture that was shot first through all slices (the AMC paper, section 5.1).

        Returns
        -------
        marked : (N, S, S) bool, texels that the turned mask touches
        """
        if mask.shape != self.stack.shape:
            (height, width), (wanted_height, wanted_width) = mask.shape, self.stack.shape
            raise InputError(
                f"the mask has {width} × {height} pixels, the pictures have {wanted_width} × {wanted_height}; "
                f"paint it over {self.stack.paths[self.first]}"
            )
        where = self.outline.circle_at(float(self.series.angles_rad[self.first]))
        resampler = make_resampler(where, view, size)
        light = self.stack.corrected(np.repeat(mask.astype(np.float32)[..., None], 3, axis=-1))[..., 0]
        marked = np.zeros((len(self.stack), size, size), bool)
        for index, turn_deg in enumerate(self.tangents_deg - self.tangents_deg[self.first]):
            # OpenCV turns counter-clockwise as seen, about a point that it counts from the first pixel's centre.
            back = cv2.getRotationMatrix2D((where.x_px - 0.5, where.y_px - 0.5), float(turn_deg), 1.0)
            turned = np.asarray(cv2.warpAffine(light, back, mask.shape[::-1]), np.float32)
            marked[index] = resampler(np.repeat(turned[..., None], 3, axis=-1))[..., 0] > _TOUCHED
        return marked

    def _shift_px(self, index: int) -> tuple[float, float]:
        circle = self.outline.circle_at(float(np.radians(self.tangents_deg[index])))
        return circle.x_px - self.outline.circle.x_px, circle.y_px - self.outline.circle.y_px

    def _window(self) -> tuple[Window, tuple[int, int]]:
        """Cut out what holds the sphere wherever it is; also the window's left and upper edge."""
        circle, (height, width) = self.outline.circle, self.stack.shape
        reach = circle.radius_px + self.outline.orbit.offset_px + _MARGIN_PX
        left, right = max(0, int(circle.x_px - reach)), min(width, int(np.ceil(circle.x_px + reach)))
        top, bottom = max(0, int(circle.y_px - reach)), min(height, int(np.ceil(circle.y_px + reach)))
        return (slice(top, bottom), slice(left, right)), (left, top)


def find_shots(capture: Capture, settings: Settings, report: Report) -> Shots:
    """Put the frames of a capture in order and find the sphere in them.

    Raises
    ------
    InputError
        Frames without an angle, fewer than eight, a gap between angles, pictures of unlike sizes, a sphere that is not
        found or is cut by the border.
    """
    frames = list(capture.having(Role.FRAME))
    sign = -1 if settings.clockwise else 1
    angles_deg = np.array([sign * _angle_deg(capture, frame) for frame in frames])
    order = np.argsort(angles_deg, kind="stable")
    zero_deg = capture.tangent_zero_deg if settings.tangent_zero_deg is None else settings.tangent_zero_deg
    tangents_deg = angles_deg[order] + zero_deg
    series = Series(np.radians(tangents_deg), check_angles(np.radians(tangents_deg), str(capture.folder)))
    stack = Stack(pictures_of(capture, [frames[index] for index in order]), undistortion(settings.camera))
    source = str(capture.folder)
    given = settings.circle
    outline = find_outline(stack, series.angles_rad, report) if given is None else _held(given)
    for angle_rad in series.angles_rad:
        outline.circle_at(float(angle_rad)).inside(stack.shape, source)
    distance = _distance(outline.circle, settings.distance_radii, settings.camera, capture)
    return Shots(stack, tangents_deg, int(np.argmin(order)), series, outline, distance, capture.digest)


def _held(circle: Circle) -> Outline:
    """Take the user's word that this is where the sphere is."""
    return Outline(circle, Orbit(circle.x_px, circle.y_px, 0.0, 0.0, circle.radius_px, 0.0, 0.0))


def _angle_deg(capture: Capture, frame: CapturedFrame) -> float:
    if frame.angle_deg is None and frame.light is not None:
        raise InputError(f"{capture.folder}: was shot under many lights, not in a turn; give it to litrig ptm fit")
    if frame.angle_deg is None:
        raise InputError(
            f"{frame.path}: has no turntable angle; name one for every picture in {capture.folder / 'angles.csv'}, or "
            "give --even if they are evenly spread over one turn, in the order of their names"
        )
    return frame.angle_deg


def _distance(circle: Circle, given: float | None, camera: CameraModel | None, capture: Capture) -> float | None:
    if given is not None:
        return given
    if camera is not None:
        return camera.sphere_distance_radii(circle.radius_px)
    return capture.sphere_distance_radii


def _tangent_turn(view: SphereView, size: int) -> TangentTurn:
    n_x, n_y = texel_plane(size)
    table_angle = np.minimum(np.arcsin(np.minimum(np.hypot(n_x, n_y), 1)), view.largest_table_angle_rad())
    turned_z = np.cos(table_angle)
    normal_z = turned_z if view.keeps_normals else np.cos(view.true_angle_rad(table_angle))
    return TangentTurn(normal_z, turned_z, np.arctan2(n_y, n_x))
