from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.errors import FormatError, InputError
from litrig.base.pictures import write_exr
from processing.decoded import decoded, spread
from processing.stack import Space, Stack

RANDOM = np.random.default_rng(3)


def write(folder: Path, count: int, kind: str = "png", dtype: type = np.uint8) -> list[Path]:
    paths = [folder / f"{index}.{kind}" for index in range(count)]
    for path in paths:
        codes = RANDOM.integers(0, np.iinfo(dtype).max, (12, 17, 3), dtype)
        cv2.imwrite(str(path), codes)
    return paths


@pytest.mark.parametrize("budget_bytes", [10**9, 1], ids=["in memory", "spooled"])
@pytest.mark.parametrize("space", ["srgb", "linear"])
@pytest.mark.parametrize(
    ("kind", "dtype"), [("png", np.uint8), ("png", np.uint16), ("jpg", np.uint8)], ids=["8 bits", "16 bits", "JPEG"]
)
def test_pixels_are_what_the_stack_reads(
    kind: str, dtype: type, space: Space, budget_bytes: int, tmp_path: Path
) -> None:
    stack = Stack(write(tmp_path, 5, kind, dtype))
    expected = np.stack([stack.frame(index, space) for index in range(5)]).reshape(5, -1, 3)
    pictures = decoded(stack, space, budget_bytes=budget_bytes)
    assert pictures.spooled == (budget_bytes == 1)
    assert pictures.values.dtype == dtype
    assert pictures.pixels(20, 90) == pytest.approx(expected[:, 20:90], abs=1e-6)
    chosen = np.array([3, 77, 203])
    assert pictures.at(chosen) == pytest.approx(expected[:, chosen], abs=1e-6)


@pytest.mark.parametrize("space", ["srgb", "linear"])
def test_light_beyond_codes_is_kept_as_floats(space: Space, tmp_path: Path) -> None:
    light: NDArray[np.float32] = np.full((4, 5, 3), 0.25, np.float32)
    light[0, 0] = 3.0
    write_exr(tmp_path / "a.exr", {"RGB": light}, {"litrig.kind": "picture"})
    values = decoded(Stack([tmp_path / "a.exr"]), space).pixels(0, 20)[0]
    assert values[0, 0] == pytest.approx(3.0 if space == "linear" else 1.0)
    assert values[7, 1] == pytest.approx(0.25 if space == "linear" else 0.537, abs=1e-3)


def test_a_picture_of_another_depth_is_named(tmp_path: Path) -> None:
    (tmp_path / "deep").mkdir()
    stack = Stack([*write(tmp_path, 1), *write(tmp_path / "deep", 1, dtype=np.uint16)])
    with pytest.raises(FormatError, match=r"deep/0\.png: holds uint16 values.*uint8"):
        decoded(stack, "srgb")


def test_a_damaged_picture_is_named(tmp_path: Path) -> None:
    paths = write(tmp_path, 3, "jpg")
    paths[1].write_bytes(paths[1].read_bytes()[:-30])
    with pytest.raises(FormatError, match=r"1\.jpg"):
        decoded(Stack(paths), "srgb")


def test_a_spool_that_has_no_room_says_what_to_do(tmp_path: Path) -> None:
    stack = Stack(write(tmp_path, 2))
    with pytest.raises(InputError, match=r"nowhere: has no 0 MiB.*--spool"):
        decoded(stack, "srgb", budget_bytes=1, spool=tmp_path / "nowhere")


def test_the_spool_leaves_nothing_behind(tmp_path: Path) -> None:
    spool = tmp_path / "spool"
    spool.mkdir()
    pictures = decoded(Stack(write(tmp_path, 2)), "srgb", budget_bytes=1, spool=spool)
    assert pictures.spooled
    assert list(spool.iterdir()) == []


def test_a_sample_is_spread_and_the_same_each_time() -> None:
    pixels = spread((500, 400), 3000)
    assert len(pixels) == pytest.approx(3000, rel=0.05)
    assert np.array_equal(pixels, spread((500, 400), 3000))
    assert len(np.unique(pixels)) == len(pixels)
    rows, columns = np.divmod(pixels, 400)
    assert (rows.min(), rows.max()) == (0, 499)
    assert columns.mean() == pytest.approx(200, abs=10)
    assert np.array_equal(spread((9, 9), 100), np.arange(81))
