"""From a turn of pictures to an Anisotropic MatCap (the AMC paper, sections 4 and 5).

Pictures → slices of table normals (`resample`) → Fourier series over the measured tangent angles (`harmonics`) →
the tangent's own turn in perspective → R (`invariance`) → even slices. All in linear light.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from litrig.base.camera_model import CameraModel, sphere_distance_radii
from litrig.base.capture_folder.capture import Capture, CapturedFrame, Role
from litrig.base.capture_folder.session_file import LARGEST_ANGLE_DEG
from litrig.base.errors import InputError
from litrig.base.progress import Progress, Report, silent
from litrig.base.table_normals import TableNormal
from processing.amc.circle import Circle, find_circle
from processing.amc.geometry import SphereView, texel_plane
from processing.amc.harmonics import check_angles, even_slices, fit_harmonics, warp_harmonics
from processing.amc.invariance import THRESHOLD, InvarianceReport, find_invariance
from processing.amc.model import Amc, Invariance
from processing.amc.resample import Resampler, dilate, make_resampler
from processing.amc.undistort import undistortion
from processing.stack import Stack

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
C64 = NDArray[np.complex64]

LARGEST_SIZE = 1024
# The rim is steep: a tenth of a pixel in the circle shows there as a change over k.
_TRUSTED_RADIUS = 0.9


@dataclass(frozen=True)
class AmcResult:
    """An AMC and how it came about.

    Attributes
    ----------
    amc : the table
    circle : the sphere's silhouette, found or given
    distance_radii : camera to sphere centre that was used; None for orthographic
    invariance : what the test over k said, also when R was prescribed
    """

    amc: Amc
    circle: Circle
    distance_radii: float | None
    invariance: InvarianceReport


def build(
    capture: Capture,
    *,
    size: int = 128,
    depth: int | None = None,
    invariance: Literal["auto"] | Invariance = "auto",
    threshold: float = THRESHOLD,
    circle: Circle | None = None,
    distance_radii: float | None = None,
    camera: CameraModel | None = None,
    table_normal: TableNormal = TableNormal.RECTIFIED,
    tangent_zero_deg: float | None = None,
    report: Report = silent,
) -> AmcResult:
    """Build the table from one turn of the sphere.

    Parameters
    ----------
    capture : frames with turntable angles, counter-clockwise as the camera sees them
    size : S, texels along the normal's x and y
    depth : D, slices stored; by default as many as were captured, divided by R
    invariance : R, "isotropic", or "auto" to find it
    threshold : for "auto", share of the variation's energy that may contradict an R
    circle : silhouette in the pictures (undistorted ones, with `camera`); found when None
    distance_radii : camera to sphere centre; by default from `camera`, then from the capture, else orthographic
    camera : lens model, whose distortion is taken out
    table_normal : how normals of a perspective picture are brought to the table
    tangent_zero_deg : tangent angle at turntable zero; by default the capture's

    Raises
    ------
    InputError
        Frames without an angle, fewer than eight, a gap between angles, a sphere that is not found or is cut by the
        border, or a value out of range.
    """
    _check_options(size, depth, invariance, threshold)
    _check_measures(table_normal, distance_radii, tangent_zero_deg)
    paths, tangents_deg = _slices_in_order(capture, tangent_zero_deg)
    highest = check_angles(np.radians(tangents_deg), str(capture.folder))
    stack = Stack(paths, undistortion(camera))
    circle = (circle or find_circle(stack, report)).inside(stack.shape, str(capture.folder))
    distance = _distance(circle, distance_radii, camera, capture)
    view = SphereView(table_normal, distance)
    resampler = make_resampler(circle, view, size)
    slices = _resample(stack, resampler, report)
    pictured = fit_harmonics(slices, np.radians(tangents_deg), highest)
    turn = _tangent_turn(view, size)
    harmonics = pictured if view.keeps_normals else warp_harmonics(pictured, *turn)
    evidence = _find_invariance(pictured, harmonics, turn, resampler.valid, threshold)
    chosen = evidence.found if invariance == "auto" else invariance
    table = _table(harmonics, chosen, depth or _default_depth(len(stack), chosen))
    amc = Amc(
        slices=dilate(table, resampler.valid),
        valid=np.broadcast_to(resampler.valid, table.shape[:3]),
        invariance=chosen,
        table_normal=table_normal,
        slice_angles_deg=tuple(float(angle) for angle in tangents_deg),
        source=capture.digest,
    )
    return AmcResult(amc, circle, distance, evidence)


def _check_options(size: int, depth: int | None, invariance: Literal["auto"] | Invariance, threshold: float) -> None:
    if not 4 <= size <= LARGEST_SIZE:
        raise InputError(f"a table of {size} texels a side; choose 4 to {LARGEST_SIZE}")
    if depth is not None and not 1 <= depth <= LARGEST_SIZE:
        raise InputError(f"a depth of {depth} slices; choose 1 to {LARGEST_SIZE}")
    if not 0 <= threshold <= 1:
        raise InputError(f"a threshold of {threshold:g}; it is a share, choose 0 to 1")
    if isinstance(invariance, int) and not 1 <= invariance <= 12:
        raise InputError(f"an invariance of {invariance}; choose 1 to 12, isotropic or auto")


def _check_measures(table_normal: TableNormal, distance_radii: float | None, tangent_zero_deg: float | None) -> None:
    SphereView(table_normal, distance_radii)  # refuses a distance that cannot be before the sphere is looked for
    if tangent_zero_deg is not None and not abs(tangent_zero_deg) <= LARGEST_ANGLE_DEG:
        raise InputError(
            f"a tangent at {tangent_zero_deg:g} deg; choose -{LARGEST_ANGLE_DEG:g} to {LARGEST_ANGLE_DEG:g}"
        )


def _slices_in_order(capture: Capture, tangent_zero_deg: float | None) -> tuple[list[Path], F64]:
    """Return pictures and tangent angles by rising turntable angle."""
    frames = sorted(capture.having(Role.FRAME), key=lambda frame: _angle_deg(capture, frame))
    zero_deg = capture.tangent_zero_deg if tangent_zero_deg is None else tangent_zero_deg
    return [frame.path for frame in frames], np.array([_angle_deg(capture, frame) + zero_deg for frame in frames])


def _angle_deg(capture: Capture, frame: CapturedFrame) -> float:
    if frame.angle_deg is None:
        raise InputError(
            f"{frame.path}: has no turntable angle; name one for every picture in {capture.folder / 'angles.csv'}"
        )
    return frame.angle_deg


def _distance(circle: Circle, given: float | None, camera: CameraModel | None, capture: Capture) -> float | None:
    if given is not None:
        return given
    if camera is not None:
        return sphere_distance_radii(circle.radius_px, (camera.focal_x_px + camera.focal_y_px) / 2)
    return capture.sphere_distance_radii


def _resample(stack: Stack, resampler: Resampler, report: Report) -> F32:
    slices = np.zeros((len(stack), *resampler.valid.shape, 3), np.float32)
    for index in range(len(stack)):
        slices[index] = resampler(stack.linear(index))
        report(Progress("resampling", index + 1, len(stack), stack.paths[index].name))
    return slices


def _tangent_turn(view: SphereView, size: int) -> tuple[F64, F64, F64]:
    """Return n_z, n′_z and azimuth of every texel, (S, S) each."""
    n_x, n_y = texel_plane(size)
    table_angle = np.minimum(np.arcsin(np.minimum(np.hypot(n_x, n_y), 1)), view.largest_table_angle_rad())
    return np.cos(view.true_angle_rad(table_angle)), np.cos(table_angle), np.arctan2(n_y, n_x)


def _find_invariance(
    pictured: C64, over_k: C64, turn: tuple[F64, F64, F64], valid: NDArray[np.bool_], threshold: float
) -> InvarianceReport:
    """Ask at every second texel of every second row, away from the rim."""
    normal_z, _, azimuth_rad = (part[::2, ::2] for part in turn)
    n_x, n_y = texel_plane(len(valid))
    trusted = (valid & (np.hypot(n_x, n_y) <= _TRUSTED_RADIUS))[::2, ::2]
    # Turned until the normal is z, the tangent lies in the surface's plane and in the picture's alike.
    over_plane = warp_harmonics(pictured[:, ::2, ::2], normal_z, np.ones_like(normal_z), azimuth_rad)
    return find_invariance(over_k[:, ::2, ::2][:, trusted], over_plane[:, trusted], threshold)


def _default_depth(captured: int, invariance: Invariance) -> int:
    return 1 if invariance == "isotropic" else max(1, -(-captured // invariance))


def _table(harmonics: C64, invariance: Invariance, depth: int) -> F32:
    """Even slices of light; a series undershoots zero beside a sharp highlight, and light does not."""
    repeats = 1 if invariance == "isotropic" else invariance
    even = even_slices(harmonics, 1 if invariance == "isotropic" else depth, repeats)
    return np.maximum(even, 0)
