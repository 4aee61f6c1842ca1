import os
from pathlib import Path

import pytest

from litrig.base.errors import InputError
from litrig.base.files import making_folder, read_limited, replacing, resolve_inside, write_atomically


def test_a_file_is_replaced_whole(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    write_atomically(path, b"old")
    write_atomically(path, b"new")
    assert path.read_bytes() == b"new"
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.txt"]


def test_a_failed_write_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    write_atomically(path, b"old")
    with pytest.raises(RuntimeError), replacing(path) as temporary:
        temporary.write_bytes(b"half")
        raise RuntimeError
    assert path.read_bytes() == b"old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.txt"]


def test_a_missing_folder_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="nowhere does not exist"):
        write_atomically(tmp_path / "nowhere" / "a.txt", b"")


def test_a_full_disk_is_an_error_with_a_reason(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="No space left"), replacing(tmp_path / "a.txt") as temporary:
        temporary.symlink_to("/dev/full")
        temporary.write_bytes(b"more than nothing" * 4096)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["y" * 251 + ".png", "y." + "p" * 253], ids=["a stem of 251", "an ending of 253"])
def test_a_name_as_long_as_names_can_be_is_written_or_refused_in_one_piece(tmp_path: Path, name: str) -> None:
    try:
        write_atomically(tmp_path / name, b"whole")
    except InputError as error:
        assert "File name too long" in str(error)
    else:
        assert (tmp_path / name).read_bytes() == b"whole"
    assert [entry.name for entry in tmp_path.iterdir()] in ([], [name])


def test_a_long_stem_is_no_hindrance(tmp_path: Path) -> None:
    write_atomically(tmp_path / ("y" * 246 + ".png"), b"whole")


def test_a_name_too_long_is_an_error_with_a_reason(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="File name too long"):
        write_atomically(tmp_path / ("y" * 300), b"")


def test_two_files_can_be_written_at_once(tmp_path: Path) -> None:
    with replacing(tmp_path / "a.txt") as first, replacing(tmp_path / "b.txt") as second:
        first.write_bytes(b"a")
        second.write_bytes(b"b")
    assert [(tmp_path / name).read_bytes() for name in ("a.txt", "b.txt")] == [b"a", b"b"]


def test_what_is_read_has_an_end(tmp_path: Path) -> None:
    (tmp_path / "large").write_bytes(b"12345")
    os.mkfifo(tmp_path / "pipe")
    reasons = {
        tmp_path / "large": "larger than 4 bytes",
        tmp_path / "pipe": "is a device or a pipe; name a file",
        Path("/dev/zero"): "is a device or a pipe; name a file",
        tmp_path: "is a folder; name a file",
        tmp_path / "gone": "no such file; check the path",
        tmp_path / ("y" * 300): "File name too long",
    }
    for path, reason in reasons.items():
        with pytest.raises(InputError, match=f"{path}: .*{reason}"):
            read_limited(path, 4)
    assert read_limited(tmp_path / "large", 5) == b"12345"


@pytest.mark.parametrize("name", ["../a", "/etc/passwd", "data/../../a", "link/a"])
def test_names_from_files_cannot_leave_their_folder(tmp_path: Path, name: str) -> None:
    root = tmp_path / "root"
    root.mkdir()
    (root / "link").symlink_to(tmp_path)
    with pytest.raises(InputError, match="outside itself"):
        resolve_inside(root, name)


def test_names_inside_resolve(tmp_path: Path) -> None:
    assert resolve_inside(tmp_path, "data/a.jpg") == tmp_path.resolve() / "data" / "a.jpg"


def test_a_folder_takes_the_place_of_one_that_may_go(tmp_path: Path) -> None:
    place = tmp_path / "r"
    for round_ in ("first", "second"):
        with making_folder(place, lambda folder: (folder / "first").exists()) as temporary:
            (temporary / round_).write_text(round_)
    assert [path.name for path in place.iterdir()] == ["second"]
    with pytest.raises(InputError, match="holds files already"), making_folder(place, lambda _: False):
        raise AssertionError
    with pytest.raises(InputError, match="full"), making_folder(place, lambda _: True) as temporary:
        (temporary / "third").write_text("third")
        raise OSError(28, "full")
    assert [path.name for path in place.iterdir()] == ["second"]
    assert [path.name for path in tmp_path.iterdir()] == ["r"]
