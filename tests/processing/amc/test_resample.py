import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.table_normals import TableNormal
from processing.amc.geometry import SphereView
from processing.amc.resample import dilate, make_resampler
from processing.outline.circle import Circle


def picture_of_normals(circle: tuple[float, float, float], shape: tuple[int, int]) -> NDArray[np.float32]:
    """An orthographic picture whose colour is its normal's n_x and n_y, and 1."""
    x = (np.arange(shape[1]) + 0.5 - circle[0]) / circle[2] + np.zeros((shape[0], 1))
    y = -(np.arange(shape[0])[:, None] + 0.5 - circle[1]) / circle[2] + np.zeros(shape[1])
    return np.stack([x, y, np.ones_like(x)], axis=-1).astype(np.float32)


@pytest.mark.parametrize("size", [8, 33, 128], ids=["coarse", "odd", "finer than the picture"])
def test_a_texel_shows_its_own_normal(size: int) -> None:
    circle = (61.3, 48.6, 40.2)
    table = make_resampler(Circle(*circle), SphereView(), size)(picture_of_normals(circle, (100, 120)))
    line = (2 * np.arange(size) + 1) / size - 1
    inner = np.hypot(line[None, :], line[:, None]) < 0.95 - 2 / size
    assert table[..., 0][inner] == pytest.approx(np.broadcast_to(line, (size, size))[inner], abs=1e-4)
    assert table[..., 1][inner] == pytest.approx(np.broadcast_to(-line[:, None], (size, size))[inner], abs=1e-4)


def test_a_texel_is_the_mean_of_its_area() -> None:
    """A checkerboard of single pixels is grey in texels of several pixels, not black or white."""
    board = np.indices((200, 200)).sum(axis=0) % 2
    table = make_resampler(Circle(100, 100, 96), SphereView(), 24)(np.repeat(board[..., None], 3, 2).astype(np.float32))
    assert table[8:16, 8:16] == pytest.approx(0.5, abs=0.05)


def test_a_sphere_that_moved_gives_the_same_slice() -> None:
    still, moved = (61.3, 48.6, 40.2), (64.05, 46.85, 40.2)
    resample = make_resampler(Circle(*still), SphereView(), 33)
    shift = (moved[0] - still[0], moved[1] - still[1])
    assert resample(picture_of_normals(moved, (100, 120)), shift) == pytest.approx(
        resample(picture_of_normals(still, (100, 120))), abs=1e-5
    )


def test_a_picture_goes_on_beyond_its_border_as_it_ends_there() -> None:
    """A ball that its photograph cuts by part of a pixel is resampled all the same."""
    ramp = np.broadcast_to(np.arange(20, dtype=np.float32)[:, None, None], (20, 20, 3))
    resample = make_resampler(Circle(10, 10, 14), SphereView(), 40)
    column = resample(ramp)[:, 20, 0]
    assert column[resample.valid[:, 20]][:2] == pytest.approx(0)
    assert column[resample.valid[:, 20]][-2:] == pytest.approx(19)


def test_a_picture_of_a_single_row_is_refused() -> None:
    with pytest.raises(InputError, match="9 × 1 pixels"):
        make_resampler(Circle(10, 10, 8), SphereView(), 8)(np.zeros((1, 9, 3), np.float32))


def test_what_lies_outside_the_sphere_does_not_get_in() -> None:
    inside = np.hypot(*(np.indices((100, 100)) + 0.5 - 50)) < 40
    picture = np.where(inside[..., None], 0.25, 1).astype(np.float32).repeat(3, 2)
    resample = make_resampler(Circle(50, 50, 40), SphereView(), 32)
    assert resample(picture)[resample.valid] == pytest.approx(0.25)
    assert not resample(picture)[~resample.valid].any()
    assert not resample.valid[0, 0]
    assert resample.valid[16, 16]


def test_normals_that_the_camera_cannot_see_are_invalid() -> None:
    line = (2 * np.arange(64) + 1) / 64 - 1
    radius = np.hypot(line[None, :], line[:, None])
    valid = make_resampler(Circle(200, 200, 190), SphereView(TableNormal.CAMERA, 2.0), 64).valid
    rim = np.sqrt(1 - 1 / 2.0**2)
    assert valid[radius < rim - 0.04].all()
    assert not valid[radius > rim + 0.04].any()


def test_colours_are_carried_outwards() -> None:
    valid = np.zeros((5, 5), bool)
    valid[2, 1:4] = True
    slices = np.zeros((2, 5, 5, 3), np.float32)
    slices[0, 2, 1:4] = 0.5
    slices[1, 2, 1:4] = 0.75
    carried = dilate(slices, valid)
    assert carried[0] == pytest.approx(0.5)
    assert carried[1] == pytest.approx(0.75)
