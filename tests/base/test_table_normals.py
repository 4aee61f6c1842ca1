import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from litrig.base.table_normals import TableNormal, rotate_smallest, table_normals, table_tangents

Vector = NDArray[np.float64]
Z = np.array([0.0, 0.0, 1.0])


def unit(x: float, y: float, z: float) -> Vector:
    vector = np.array([x, y, z])
    return vector / float(np.linalg.norm(vector))


facing = st.tuples(st.floats(-0.7, 0.7), st.floats(-0.7, 0.7), st.floats(0.5, 1)).map(lambda v: unit(*v))


@pytest.mark.parametrize("kind", TableNormal)
@given(normal=facing)
def test_an_orthographic_view_changes_nothing(kind: TableNormal, normal: Vector) -> None:
    np.testing.assert_allclose(table_normals(normal, Z, kind), normal, atol=1e-9)


@given(normal=facing, to_eye=facing)
def test_rectified_keeps_what_a_mirror_shows(normal: Vector, to_eye: Vector) -> None:
    seen = 2 * (normal @ to_eye) * normal - to_eye
    turned = table_normals(normal, to_eye, TableNormal.RECTIFIED)
    np.testing.assert_allclose(2 * turned[2] * turned - Z, seen, atol=1e-9)


@given(normal=facing, to_eye=facing)
def test_view_keeps_the_angle_to_the_eye(normal: Vector, to_eye: Vector) -> None:
    turned = table_normals(normal, to_eye, TableNormal.VIEW)
    assert turned[2] == pytest.approx(normal @ to_eye, abs=1e-9)


@given(normal=facing, to_eye=facing, other=facing)
def test_tangents_stay_unit_and_tangent(normal: Vector, to_eye: Vector, other: Vector) -> None:
    tangent = np.cross(normal, other)
    if np.linalg.norm(tangent) < 1e-3:
        return
    tangent /= np.linalg.norm(tangent)
    turned = table_normals(normal, to_eye, TableNormal.RECTIFIED)
    table_tangent = table_tangents(tangent, normal, turned)
    assert np.linalg.norm(table_tangent) == pytest.approx(1, abs=1e-9)
    assert table_tangent @ turned == pytest.approx(0, abs=1e-9)


@given(source=facing, target=facing)
def test_the_smallest_rotation_takes_source_to_target_and_leaves_the_axis(source: Vector, target: Vector) -> None:
    np.testing.assert_allclose(rotate_smallest(source, source, target), target, atol=1e-9)
    axis = np.cross(source, target)
    np.testing.assert_allclose(rotate_smallest(axis, source, target), axis, atol=1e-9)
