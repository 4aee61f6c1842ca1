import io
import os
import pickle
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from firmware_sim.scene.frame_cache import DIGEST_BYTES, FrameCache, file_bytes
from firmware_sim.scene.pose import F32, Pose

SIZE = (6, 8)
POSE = Pose(5.625, 0, 0, 1)


def frame(seed: int = 0) -> F32:
    return np.random.default_rng(seed).random((*SIZE, 3), np.float32)


def cache_in(root: Path, **changes: object) -> FrameCache:
    options: dict[str, object] = {"scene": "a sphere", "renderer": "mitsuba 3"}
    return FrameCache(root, **(options | changes))  # type: ignore[arg-type]


def test_a_picture_comes_back_in_another_process_s_cache(tmp_path: Path) -> None:
    cache_in(tmp_path).store(POSE, SIZE, frame())
    loaded = cache_in(tmp_path).load(POSE, SIZE)
    assert loaded is not None
    assert loaded.dtype == np.float32
    np.testing.assert_allclose(loaded, frame(), rtol=2**-11)
    assert [path.suffix for path in tmp_path.rglob("*") if path.is_file()] == [".npy"]


def test_the_length_of_a_file_is_known_before_it_is_read(tmp_path: Path) -> None:
    cache = cache_in(tmp_path)
    cache.store(POSE, SIZE, frame())
    assert cache.path(POSE, SIZE).stat().st_size == file_bytes(SIZE)


def test_light_beyond_half_floats_stays_finite(tmp_path: Path) -> None:
    cache = cache_in(tmp_path)
    cache.store(POSE, SIZE, frame() + np.float32(1e6))
    loaded = cache.load(POSE, SIZE)
    assert loaded is not None
    assert np.isfinite(loaded).all()


@pytest.mark.parametrize(
    "changes",
    [
        pytest.param({"scene": "another sphere"}, id="of another scene"),
        pytest.param({"renderer": "mitsuba 4"}, id="of another renderer"),
    ],
)
def test_a_picture_is_not_shown_for_one(tmp_path: Path, changes: dict[str, object]) -> None:
    cache_in(tmp_path).store(POSE, SIZE, frame())
    assert cache_in(tmp_path, **changes).load(POSE, SIZE) is None


def test_a_picture_is_not_shown_for_another_pose_or_size(tmp_path: Path) -> None:
    cache = cache_in(tmp_path)
    cache.store(POSE, SIZE, frame())
    assert cache.load(POSE._replace(turntable_deg=5.626), SIZE) is None
    assert cache.load(POSE, (8, 6)) is None


def flipped(content: bytes) -> bytes:
    return content[:200] + bytes([content[200] ^ 1]) + content[201:]


def pickled(content: bytes) -> bytes:
    body = pickle.dumps({"shape": 1})
    return body + bytes(len(content) - len(body))


def of_another_size(content: bytes) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, np.zeros((8, 6, 3), np.float16))
    return buffer.getvalue() + content[-DIGEST_BYTES:]


@pytest.mark.parametrize(
    "damage",
    [
        pytest.param(lambda content: content[:-1], id="cut short"),
        pytest.param(lambda content: b"", id="empty"),
        pytest.param(flipped, id="one bit is wrong"),
        pytest.param(pickled, id="something else"),
        pytest.param(of_another_size, id="the digest of something else"),
    ],
)
def test_a_damaged_picture_is_not_there(tmp_path: Path, damage: Callable[[bytes], bytes]) -> None:
    cache = cache_in(tmp_path)
    cache.store(POSE, SIZE, frame())
    path = cache.path(POSE, SIZE)
    path.write_bytes(damage(path.read_bytes()))
    assert cache.load(POSE, SIZE) is None
    assert not path.exists()


def test_what_was_not_used_for_longest_goes_first(tmp_path: Path) -> None:
    other = cache_in(tmp_path, scene="another", limit_bytes=3 * file_bytes(SIZE))
    cache = cache_in(tmp_path, limit_bytes=3 * file_bytes(SIZE))
    poses = [Pose(angle, 0, 0, 1) for angle in (0.0, 1.0, 2.0)]
    other.store(POSE, SIZE, frame())
    for pose in poses[:2]:
        cache.store(pose, SIZE, frame())
    for age, path in enumerate([cache.path(poses[1], SIZE), other.path(POSE, SIZE), cache.path(poses[0], SIZE)]):
        os.utime(path, (1000 + age, 1000 + age))
    assert cache.load(poses[1], SIZE) is not None  # oldest, and just used
    cache.store(poses[2], SIZE, frame())
    assert other.load(POSE, SIZE) is None
    assert sorted(cache.poses(SIZE)) == poses


def test_the_poses_of_a_size_can_be_listed(tmp_path: Path) -> None:
    cache = cache_in(tmp_path)
    assert cache.poses(SIZE) == []
    poses = [Pose(0, 0, 0, 0), Pose(5.625, 330, 41.23, 0.502)]
    for pose in poses:
        cache.store(pose, SIZE, frame())
    cache.path(POSE, SIZE).with_name("notes.txt").write_text("not a picture")
    cache.path(POSE, SIZE).with_name("1_2.npy").write_text("not a pose")
    assert sorted(cache.poses(SIZE)) == poses
    assert cache.poses((8, 6)) == []
