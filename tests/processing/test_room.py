import errno
import mmap
from pathlib import Path

import numpy as np
import pytest

from litrig.base.errors import InputError
from processing import room as rooms
from processing.room import Room, make_room

SHAPE = (5, 7, 7, 3)


@pytest.fixture(params=["memory", "file"])
def room(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Room:
    if request.param == "file":
        monkeypatch.setattr(rooms, "MOST_IN_MEMORY_BYTES", 0)
    made = make_room(SHAPE)
    assert (made.file is None) == (request.param == "memory")
    return made


def test_room_is_black_at_first(room: Room) -> None:
    assert room.array.shape == SHAPE
    assert not room.array.any()


def test_what_is_released_is_still_there(room: Room) -> None:
    values = np.random.default_rng(1).random(SHAPE, np.float32)
    room.array[:] = values
    room.release()
    np.testing.assert_array_equal(room.array, values)


def test_rows_are_those_of_the_array(room: Room) -> None:
    room.array[:] = np.random.default_rng(2).random(SHAPE, np.float32)
    for rows in (slice(0, 3), slice(3, 6), slice(6, 9)):
        np.testing.assert_array_equal(room.rows(rows), room.array[:, rows])


def test_rows_that_are_put_are_in_the_array_and_nothing_else_changes(room: Room) -> None:
    room.array[:] = 1
    values = np.random.default_rng(3).random((2, 3, 7, 3), np.float32)
    room.put_rows(slice(4, 9), values)
    expected = np.ones(SHAPE, np.float32)
    expected[:2, 4:] = values
    np.testing.assert_array_equal(room.array, expected)


def test_many_slices_take_no_memory_once_they_are_released() -> None:
    """That of the process, as the system counts it."""
    room = make_room((90, 512, 512, 3))
    assert room.array.nbytes > rooms.MOST_IN_MEMORY_BYTES
    before = _resident_bytes()
    for one in room.array:
        one[:] = 1
        room.release()
    assert _resident_bytes() - before < 32 << 20
    assert room.array[-1, -1, -1, -1] == 1


def test_the_file_goes_with_the_array(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rooms, "MOST_IN_MEMORY_BYTES", 0)
    before = len(list(Path("/proc/self/fd").iterdir()))
    array = make_room(SHAPE).array
    assert len(list(Path("/proc/self/fd").iterdir())) > before
    array[:] = 1  # the room itself is gone
    del array
    assert len(list(Path("/proc/self/fd").iterdir())) == before


def test_a_full_disk_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(rooms, "MOST_IN_MEMORY_BYTES", 0)
    monkeypatch.setattr("os.posix_fallocate", full)
    with pytest.raises(InputError, match=r"no 0 MiB for a while \(No space left on device\).*TMPDIR"):
        make_room(SHAPE)


def _resident_bytes() -> int:
    return int(Path("/proc/self/statm").read_text().split()[1]) * mmap.PAGESIZE
