import mmap
from pathlib import Path

import pytest

from firmware_sim.camera.shared_frame import HEADER_BYTES, LARGEST_PICTURE_BYTES, SharedFrame
from firmware_sim.camera.shim import compiled_shim
from firmware_sim.errors import SimToolError


def test_the_shim_is_compiled_once(tmp_path: Path) -> None:
    library = compiled_shim(tmp_path)
    assert library.read_bytes().startswith(b"\x7fELF")
    before = library.stat().st_mtime_ns
    assert compiled_shim(tmp_path) == library
    assert library.stat().st_mtime_ns == before
    assert list(tmp_path.iterdir()) == [library]


def test_without_a_compiler_the_message_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(SimToolError, match="apt-get install gcc libc6-dev"):
        compiled_shim(tmp_path / "cache")


def test_a_compiler_that_fails_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "false")
    with pytest.raises(SimToolError, match="cannot compile"):
        compiled_shim(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_picture_is_published_whole(tmp_path: Path) -> None:
    path = tmp_path / "frames"
    with SharedFrame(path, create=True) as ours, path.open("r+b") as file, mmap.mmap(file.fileno(), 0) as theirs:
        ours.publish(b"picture", stream=3, number=9, exposure_start_s=12.5)
        assert theirs[HEADER_BYTES : HEADER_BYTES + 7] == b"picture"
        read = {
            name: ours[name] for name in ("sequence", "picture_stream", "picture_bytes", "number", "exposure_start_ns")
        }
        assert read == {
            "sequence": 2,
            "picture_stream": 3,
            "picture_bytes": 7,
            "number": 9,
            "exposure_start_ns": 12_500_000_000,
        }


def test_a_picture_without_room_is_refused(tmp_path: Path) -> None:
    with SharedFrame(tmp_path / "frames", create=True) as shared:
        with pytest.raises(ValueError, match="exceeds the room"):
            shared.publish(bytes(LARGEST_PICTURE_BYTES + 1), 1, 1, 0.0)
        assert shared["sequence"] == 0
