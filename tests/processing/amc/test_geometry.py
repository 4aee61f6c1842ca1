import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.table_normals import TableNormal, table_normals
from processing.amc.geometry import SphereView, texel_plane

KINDS = st.sampled_from(list(TableNormal))
DISTANCES = st.floats(1.05, 200)
SHARES = st.floats(0, 0.999)


def to_eye(angle_rad: float, distance: float) -> NDArray[np.float64]:
    ray = np.array([0.0, 0.0, distance]) - np.array([math.sin(angle_rad), 0.0, math.cos(angle_rad)])
    return np.asarray(ray / np.linalg.norm(ray))


@given(KINDS, DISTANCES, SHARES)
def test_the_true_normal_goes_back_to_its_table_normal(kind: TableNormal, distance: float, share: float) -> None:
    true_rad = share * math.acos(1 / distance)
    normal = np.array([math.sin(true_rad), 0.0, math.cos(true_rad)])
    turned = table_normals(normal, to_eye(true_rad, distance), kind)
    table_rad = np.array([math.atan2(turned[0], turned[2])])
    assert SphereView(kind, distance).true_angle_rad(table_rad)[0] == pytest.approx(true_rad, abs=1e-6)


@given(KINDS, DISTANCES, SHARES)
def test_a_point_is_seen_where_its_ray_meets_the_picture(kind: TableNormal, distance: float, share: float) -> None:
    true_rad = share * math.acos(1 / distance)
    slope = math.sin(true_rad) / (distance - math.cos(true_rad))
    silhouette_slope = math.tan(math.asin(1 / distance))
    seen = SphereView(kind, distance).image_radius(np.array([true_rad]))[0]
    assert seen == pytest.approx(slope / silhouette_slope, abs=1e-9)


@given(KINDS, DISTANCES)
def test_the_silhouette_is_the_last_that_is_seen(kind: TableNormal, distance: float) -> None:
    view = SphereView(kind, distance)
    rim = view.true_angle_rad(np.array([view.largest_table_angle_rad(), math.pi / 2]))
    assert view.image_radius(rim) == pytest.approx([1, 1])


@pytest.mark.parametrize(
    ("kind", "largest_deg"),
    [
        pytest.param(TableNormal.CAMERA, 60, id="camera: normals with n_z < 1/d are hidden"),
        pytest.param(TableNormal.RECTIFIED, 75, id="rectified: half the ray's angle is given back"),
        pytest.param(TableNormal.VIEW, 90, id="view: the silhouette is the table's edge"),
    ],
)
def test_largest_table_angle_at_two_radii(kind: TableNormal, largest_deg: float) -> None:
    assert math.degrees(SphereView(kind, 2.0).largest_table_angle_rad()) == pytest.approx(largest_deg)


def test_without_perspective_a_normal_is_seen_at_its_sine() -> None:
    view = SphereView()
    angles = np.array([0.0, 0.5, 1.5])
    assert view.true_angle_rad(angles) == pytest.approx(angles)
    assert view.image_radius(angles) == pytest.approx(np.sin(angles))


@pytest.mark.parametrize("distance", [1.0, 0.0, -3.0, math.nan, math.inf, 1e300])
def test_a_camera_inside_the_sphere_or_beyond_all_measure_is_refused(distance: float) -> None:
    with pytest.raises(InputError, match="radii"):
        SphereView(TableNormal.RECTIFIED, distance)


def test_texel_centres_run_from_left_to_right_and_from_top_to_bottom() -> None:
    n_x, n_y = texel_plane(4)
    assert n_x[0] == pytest.approx([-0.75, -0.25, 0.25, 0.75])
    assert n_y[:, 0] == pytest.approx([0.75, 0.25, -0.25, -0.75])


def test_the_parts_of_a_texel_surround_its_centre() -> None:
    n_x, n_y = texel_plane(4, 3)
    assert n_x.shape == (12, 12)
    assert n_x[0, 3:6].mean() == pytest.approx(-0.25)
    assert n_y[3:6, 0].mean() == pytest.approx(0.25)
