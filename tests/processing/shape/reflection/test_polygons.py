import numpy as np
import pytest

from litrig.base.errors import InputError
from processing.shape.reflection.polygons import Smoothness, joined, polygons
from tests.processing.shape.reflection.balls import ball

UP = np.array([0, 0, 1], np.float32)


def facing(height: int, width: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return normals, directions to the eye, and positions a unit apart, of a wall seen straight."""
    rows, columns = np.indices((height, width))
    flat = np.broadcast_to(UP, (height, width, 3)).copy()
    return flat, flat.copy(), np.stack([columns, -rows, np.full_like(rows, -50)], axis=-1).astype(np.float32)


def test_a_whole_wall_is_quads() -> None:
    normals, to_eye, positions = facing(4, 6)
    found = polygons(*joined(np.ones((4, 6), bool), normals, to_eye, positions, Smoothness()))
    assert found.shape == (15, 4)
    assert [0, 1, 7, 6] in found.tolist()


def test_a_missing_corner_leaves_triangles() -> None:
    normals, to_eye, positions = facing(3, 3)
    used = np.ones((3, 3), bool)
    used[0, 0] = used[2, 2] = False
    found = polygons(*joined(used, normals, to_eye, positions, Smoothness()))
    quads, triangles = found[found[:, 3] >= 0], found[found[:, 3] < 0]
    assert quads.tolist() == [[1, 2, 5, 4], [3, 4, 7, 6]]
    assert sorted(sorted(corners[:3].tolist()) for corners in triangles) == [[1, 3, 4], [4, 5, 7]]


@pytest.mark.parametrize("angle_deg", [25.0, 35.0])
def test_a_fold_ends_a_patch_beyond_the_angle(angle_deg: float) -> None:
    normals, to_eye, positions = facing(2, 4)
    angle = np.radians(angle_deg)
    normals[:, 2:] = [np.sin(angle), 0, np.cos(angle)]
    found = polygons(*joined(np.ones((2, 4), bool), normals, to_eye, positions, Smoothness()))
    assert len(found) == (3 if angle_deg < 30 else 2)


@pytest.mark.parametrize("step", [2.0, 4.0])
def test_a_step_in_depth_ends_a_patch(step: float) -> None:
    normals, to_eye, positions = facing(2, 4)
    positions[:, 2:, 2] -= step
    found = polygons(*joined(np.ones((2, 4), bool), normals, to_eye, positions, Smoothness()))
    assert len(found) == (3 if step < 3 else 2)
    assert len(polygons(*joined(np.ones((2, 4), bool), normals, to_eye, None, Smoothness()))) == 3


def test_a_ball_is_one_patch_to_its_rim() -> None:
    """What its slant explains is no step."""
    seen = ball(60)
    across, down = joined(seen.used, seen.normals, seen.to_eye, seen.positions, Smoothness(normal_jump_deg=90))
    both = seen.used[:, :-1] & seen.used[:, 1:]
    assert across[both].mean() > 0.99
    assert down[seen.used[:-1] & seen.used[1:]].mean() > 0.99


@pytest.mark.parametrize("values", [(0.0, 3.0), (200.0, 3.0), (30.0, 0.0), (float("nan"), 3.0)])
def test_limits_that_mean_nothing_are_refused(values: tuple[float, float]) -> None:
    with pytest.raises(InputError, match="mean nothing"):
        Smoothness(*values)
