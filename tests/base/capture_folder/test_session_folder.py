"""A session's folder from its first second to the closed bag, and back."""

import errno
import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import bagit
import numpy as np
import pytest
import simplejpeg
from rocrate.rocrate import ROCrate

from litrig.base.capture_folder import layout
from litrig.base.capture_folder.crate import Description
from litrig.base.capture_folder.journal import encode_entry, read_journal
from litrig.base.capture_folder.lock import FolderLock
from litrig.base.capture_folder.reader import read_capture
from litrig.base.capture_folder.verify import verify_capture
from litrig.base.capture_folder.writer import CaptureFolderWriter
from litrig.base.errors import FormatError, InputError
from litrig.base.lights import Lights
from litrig.base.lp import read_lp
from tests.faults.disk_states import RecordingStore


def jpeg(brightness: int) -> bytes:
    return bytes(simplejpeg.encode_jpeg(np.full((8, 12, 3), brightness, np.uint8), 95))


def shoot(folder: Path, frames: int = 3, *, close: bool = True) -> None:
    session = {
        "session": {"object": "coin", "tangent_zero_deg": 12.5},
        "rig": {"sample": {"sphere_distance_radii": 8.0}},
    }
    plan = [{"step": step} for step in range(frames)]
    with CaptureFolderWriter.create(folder, "coin", session, plan) as writer:
        for step in range(frames):
            writer.add_frame(
                f"{step:06d}.jpg",
                jpeg(40 + step),
                np.zeros((6, 8, 3), np.uint8),
                step=step,
                role="frame",
                pose_after={"angle_deg": 120.0 * step},
                light=[0.0, 0.6, 0.8],
                verdict="good",
            )
        if close:
            names = tuple(f"{step:06d}.jpg" for step in range(frames))
            lights = Lights(names, np.array([[0.0, 0.6, 0.8]] * frames))
            about = Description("1", "2026-01-01T00:00:00+00:00", instruments=("camera /dev/video0",))
            writer.close(lights, about)


def test_the_library_of_congress_accepts_the_bag(tmp_path: Path) -> None:
    shoot(tmp_path / "s")
    bag = bagit.Bag(str(tmp_path / "s"))
    assert bag.validate()
    assert bag.info["External-Identifier"] == "coin"


def test_an_ro_crate_reader_finds_every_frame(tmp_path: Path) -> None:
    shoot(tmp_path / "s")
    crate = ROCrate(str(tmp_path / "s" / "data"))
    ids = {entity.id for entity in crate.data_entities}
    assert {f"frames/{step:06d}.jpg" for step in range(3)} <= ids
    assert crate.dereference("#session").type == "CreateAction"


def test_what_was_captured_is_read(tmp_path: Path) -> None:
    shoot(tmp_path / "s")
    capture = read_capture(tmp_path / "s")
    assert capture.object_id == "coin"
    assert capture.tangent_zero_deg == 12.5
    assert capture.sphere_distance_radii == 8.0
    assert [frame.angle_deg for frame in capture.frames] == [0, 120, 240]
    assert capture.frames[0].light is not None
    np.testing.assert_allclose(capture.frames[0].light, [0, 0.6, 0.8])
    assert read_lp(tmp_path / "s" / "data" / "coin.lp").names == tuple(frame.path.name for frame in capture.frames)


def test_the_journal_names_every_file_with_its_digest(tmp_path: Path) -> None:
    shoot(tmp_path / "s")
    entries = read_journal(tmp_path / "s" / layout.JOURNAL)
    assert [entry["ev"] for entry in entries] == ["session", "frame", "frame", "frame", "close"]
    assert [entry["seq"] for entry in entries] == list(range(5))
    assert all(entry["bytes"] == (tmp_path / "s" / entry["file"]).stat().st_size for entry in entries[1:4])
    assert [json.loads(line)["step"] for line in (tmp_path / "s" / layout.PLAN).read_text().splitlines()] == [0, 1, 2]


def test_a_closed_session_verifies(tmp_path: Path) -> None:
    shoot(tmp_path / "s")
    result = verify_capture(tmp_path / "s")
    assert (result.frames, result.closed, result.findings, result.orphans) == (3, True, (), ())


def test_an_open_session_says_so_and_can_be_read(tmp_path: Path) -> None:
    shoot(tmp_path / "s", close=False)
    assert verify_capture(tmp_path / "s").findings == ("the session was not closed: the bag has no manifest yet",)
    assert len(read_capture(tmp_path / "s").frames) == 3


def test_every_change_is_found_at_once(tmp_path: Path) -> None:
    folder = tmp_path / "s"
    shoot(folder)
    frames = sorted((folder / layout.FRAMES).iterdir())
    content = bytearray(frames[0].read_bytes())
    content[30] ^= 1
    frames[0].write_bytes(content)
    frames[1].unlink()
    (folder / "data" / "foreign.txt").write_text("x")
    findings = "\n".join(verify_capture(folder).findings)
    assert "000000.jpg: changed" in findings
    assert "000001.jpg: in the journal, not on the disk" in findings
    assert "foreign.txt: on the disk, not in the manifest" in findings


def test_a_changed_frame_is_not_processed(tmp_path: Path) -> None:
    shoot(tmp_path / "s")
    frame = tmp_path / "s" / layout.FRAMES / "000001.jpg"
    frame.write_bytes(frame.read_bytes() + b"x")
    with pytest.raises(FormatError, match=r"000001\.jpg: changed since it was captured"):
        read_capture(tmp_path / "s")


def test_a_frame_that_no_line_speaks_of_is_an_orphan_and_left_alone(tmp_path: Path) -> None:
    shoot(tmp_path / "s", close=False)
    orphan = tmp_path / "s" / layout.FRAMES / "000003.jpg"
    orphan.write_bytes(jpeg(1))
    assert verify_capture(tmp_path / "s").orphans == ("data/frames/000003.jpg",)
    assert orphan.exists()
    assert len(read_capture(tmp_path / "s").frames) == 3


def test_a_folder_with_something_in_it_is_refused_and_untouched(tmp_path: Path) -> None:
    folder = tmp_path / "s"
    folder.mkdir()
    (folder / "mine.txt").write_text("mine")
    with pytest.raises(InputError, match="not empty"):
        shoot(folder)
    assert [entry.name for entry in folder.iterdir()] == ["mine.txt"]


def test_a_frame_is_never_overwritten(tmp_path: Path) -> None:
    with CaptureFolderWriter.create(tmp_path / "s", "coin", {}, []) as writer:
        writer.add_frame("a.jpg", jpeg(1), np.zeros((6, 8, 3), np.uint8), step=0)
        with pytest.raises(InputError, match="never overwritten"):
            writer.add_frame("a.jpg", jpeg(2), np.zeros((6, 8, 3), np.uint8), step=0)


def test_the_journal_cannot_name_files_outside_the_folder(tmp_path: Path) -> None:
    with CaptureFolderWriter.create(tmp_path / "s", "coin", {}, []) as writer:
        writer.record("frame", step=0, file="../../etc/passwd", sha256="0", verdict="good")
    with pytest.raises(InputError, match="outside itself"):
        read_capture(tmp_path / "s")
    assert "outside itself" in verify_capture(tmp_path / "s").findings[0]


def changed_frame(folder: Path) -> None:
    (folder / layout.FRAMES / "000001.jpg").write_bytes(b"x")


def missing_frame(folder: Path) -> None:
    (folder / layout.FRAMES / "000001.jpg").unlink()


def changed_settings(folder: Path) -> None:
    with (folder / layout.SESSION).open("a") as file:
        file.write("# a word more\n")


@pytest.mark.parametrize(
    ("harm", "finding"),
    [
        pytest.param(changed_frame, "data/frames/000001.jpg: changed since it was captured", id="changed frame"),
        pytest.param(missing_frame, "data/frames/000001.jpg: in the journal, not on the disk", id="missing frame"),
        pytest.param(changed_settings, "data/session.toml: changed since the session began", id="changed settings"),
        pytest.param(
            lambda folder: (folder / layout.SESSION).unlink(), "data/session.toml: not on the disk", id="no settings"
        ),
        pytest.param(
            lambda folder: (folder / layout.TAG_MANIFEST).unlink(),
            "tagmanifest-sha256.txt: missing, so that the bag is not complete; restore it from a copy",
            id="no tag manifest",
        ),
        pytest.param(
            lambda folder: (folder / layout.MANIFEST).unlink(),
            "manifest-sha256.txt: missing, so that the bag is not complete; restore it from a copy",
            id="no manifest",
        ),
    ],
)
def test_each_harm_is_found_once(tmp_path: Path, harm: Any, finding: str) -> None:
    shoot(tmp_path / "s")
    harm(tmp_path / "s")
    assert verify_capture(tmp_path / "s").findings == (finding,)


def test_changed_settings_are_not_relied_on(tmp_path: Path) -> None:
    shoot(tmp_path / "s")
    changed_settings(tmp_path / "s")
    with pytest.raises(FormatError, match=r"session\.toml: changed since the session began"):
        read_capture(tmp_path / "s")


@pytest.mark.parametrize(
    ("session", "reason"),
    [
        pytest.param({"session": 3}, "session: Input should be a valid dictionary", id="no table"),
        pytest.param({"session": {"tangent_zero_deg": "x"}}, "session.tangent_zero_deg: .*number", id="tangent"),
        pytest.param({"session": {"tangent_zero_deg": 1e300}}, "session.tangent_zero_deg: .*3600", id="far tangent"),
        pytest.param({"rig": {"sample": {"sphere_distance_radii": "x"}}}, "sphere_distance_radii: ", id="distance"),
    ],
)
def test_settings_of_the_wrong_kind_are_named(tmp_path: Path, session: Mapping[str, Any], reason: str) -> None:
    with CaptureFolderWriter.create(tmp_path / "s", "coin", session, []) as writer:
        writer.add_frame("a.jpg", jpeg(1), np.zeros((6, 8, 3), np.uint8), step=0, verdict="good")
    with pytest.raises(InputError, match=rf"session\.toml: .*{reason}"):
        read_capture(tmp_path / "s")


@pytest.mark.parametrize(
    ("entry", "reason"),
    [
        pytest.param({}, "names no event", id="no event"),
        pytest.param(
            {"ev": "frame", "step": 0, "sha256": "0", "verdict": "good"}, "file: Field required", id="no file"
        ),
        pytest.param({"ev": "frame", "step": 0, "file": "a", "sha256": "0", "role": "x"}, "role: ", id="unknown role"),
        pytest.param({"ev": "frame", "step": 0, "file": "a", "sha256": "0", "light": [1]}, "light", id="half a light"),
        pytest.param(
            {"ev": "frame", "step": 0, "file": "a", "sha256": "0", "pose_after": 4}, "pose_after", id="no pose"
        ),
    ],
)
def test_a_whole_line_that_says_too_little_is_named(tmp_path: Path, entry: Mapping[str, Any], reason: str) -> None:
    shoot(tmp_path / "s", close=False)
    with (tmp_path / "s" / layout.JOURNAL).open("ab") as journal:
        journal.write(encode_entry({"seq": 4, **entry}))
    for read in (read_capture, verify_capture):
        with pytest.raises(FormatError, match=rf"journal\.jsonl, line 5: .*{reason}"):
            read(tmp_path / "s")


def full_disk() -> Iterator[Mapping[str, Any]]:
    yield {"step": 0}
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.mark.parametrize("stood", [False, True], ids=["absent before", "empty before"])
def test_a_disk_that_is_full_at_the_start_leaves_nothing(tmp_path: Path, stood: bool) -> None:
    if stood:
        (tmp_path / "new").mkdir()
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(InputError, match="No space left"):
        CaptureFolderWriter.create(tmp_path / "new" if stood else tmp_path / "new" / "s", "coin", {}, full_disk())
    assert sorted(tmp_path.rglob("*")) == before


def test_a_thumbnail_that_cannot_be_written_fails_no_session(tmp_path: Path) -> None:
    with CaptureFolderWriter.create(tmp_path / "s", "coin", {}, []) as writer:
        (tmp_path / "s" / layout.THUMBS).rmdir()
        writer.add_frame("a.jpg", jpeg(1), np.zeros((6, 8, 3), np.uint8), step=0, verdict="good")
    assert len(read_capture(tmp_path / "s").frames) == 1


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        pytest.param("file", "is a file; a session needs a folder", id="a file"),
        pytest.param("y" * 300, "File name too long", id="a name too long"),
        pytest.param("file/x", "cannot be created .Not a directory", id="below a file"),
    ],
)
def test_a_folder_that_cannot_be_is_refused(tmp_path: Path, name: str, reason: str) -> None:
    (tmp_path / "file").write_bytes(b"mine")
    with pytest.raises(InputError, match=reason):
        shoot(tmp_path / name)
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [("file", b"mine")]


def test_what_was_shot_at_one_pose_is_one_picture(tmp_path: Path) -> None:
    with CaptureFolderWriter.create(tmp_path / "s", "coin", {}, []) as writer:
        for step, (turn, ev) in enumerate([(0, -2.0), (0, 0.0), (0, 2.0), (1, 0.0), (1, 0.0)]):
            writer.add_frame(
                f"{step}.jpg",
                jpeg(40 + step),
                np.zeros((6, 8, 3), np.uint8),
                step=step,
                role="frame",
                pose_goal={"angle_deg": 90.0 + 360 * turn},
                pose_after={"angle_deg": 90.0 + 360 * turn + 0.1 * step},
                exposure_ev=ev,
                verdict="good",
            )
    (frame,) = read_capture(tmp_path / "s").frames
    assert frame.path.name == "1.jpg"
    assert [exposure.exposure_ev for exposure in frame.exposures] == [-2.0, 0.0, 2.0, 0.0, 0.0]
    assert frame.angle_deg == pytest.approx(90.2)


def test_a_frame_that_was_called_back_counts_no_longer_until_it_is_shot_again(tmp_path: Path) -> None:
    thumb = np.zeros((6, 8, 3), np.uint8)
    with CaptureFolderWriter.create(tmp_path / "s", "coin", {}, []) as writer:
        for step in range(3):
            writer.add_frame(f"{step}.jpg", jpeg(40 + step), thumb, step=step, verdict="good")
        writer.record("recall", steps=[1, 2], reason="slipped")
        writer.add_frame("2_try2.jpg", jpeg(50), thumb, step=2, verdict="good")
    assert [frame.path.name for frame in read_capture(tmp_path / "s").frames] == ["0.jpg", "2_try2.jpg"]


def test_what_a_kill_left_of_a_tag_file_is_taken_away_when_the_session_goes_on(tmp_path: Path) -> None:
    shoot(tmp_path / "s", close=False)
    (tmp_path / "s" / ".123-4.part.txt").write_text("half a manifest")
    with CaptureFolderWriter.reopen(tmp_path / "s", FolderLock(tmp_path / "s")) as writer:
        writer.close(None, Description("1", "2026-01-01T00:00:00+00:00"))
    assert verify_capture(tmp_path / "s").findings == ()


def test_a_closed_bag_is_opened_before_its_journal_grows(tmp_path: Path) -> None:
    shoot(tmp_path / "s")
    before = (tmp_path / "s" / layout.JOURNAL).read_bytes()
    store = RecordingStore()
    with CaptureFolderWriter.reopen(tmp_path / "s", FolderLock(tmp_path / "s"), store=store):
        pass
    kinds = [operation.kind for operation in store.operations]
    assert kinds[:3] == ["remove", "sync_folder", "remove"], "the tag manifest goes first, and for good"
    assert kinds.index("append") > max(place for place, kind in enumerate(kinds) if kind == "remove")
    assert (tmp_path / "s" / layout.JOURNAL).read_bytes() != before


def test_a_manifest_vouches_only_for_what_is_durable(tmp_path: Path) -> None:
    shoot(tmp_path / "s", close=False)
    store = RecordingStore()
    with CaptureFolderWriter.reopen(tmp_path / "s", FolderLock(tmp_path / "s"), store=store) as writer:
        writer.close(None, Description("1", "2026-01-01T00:00:00+00:00"))
    synced = {operation.path for operation in store.operations if operation.kind in ("sync", "sync_folder")}
    thumbs = tmp_path / "s" / layout.THUMBS
    assert {thumbs, *thumbs.iterdir()} <= synced


def test_a_frame_that_rotted_and_was_shot_again_leaves_a_valid_bag_that_says_so(tmp_path: Path) -> None:
    shoot(tmp_path / "s")
    changed_frame(tmp_path / "s")
    (tmp_path / "s" / layout.FRAMES / "000002.jpg").unlink()
    harmed = [f"{layout.FRAMES}/000001.jpg", f"{layout.FRAMES}/000002.jpg"]
    with CaptureFolderWriter.reopen(tmp_path / "s", FolderLock(tmp_path / "s")) as writer:
        writer.recall([1, 2], "not as it was shot", harmed)
        for step in (1, 2):
            name = writer.unused_name(f"00000{step}", ".jpg")
            writer.add_frame(name, jpeg(60 + step), np.zeros((6, 8, 3), np.uint8), step=step, verdict="good")
        writer.close(None, Description("1", "2026-01-01T00:00:00+00:00"))
    result = verify_capture(tmp_path / "s")
    assert result.findings == ()
    assert result.harmed == tuple(harmed)
    assert [frame.path.name for frame in read_capture(tmp_path / "s").frames] == [
        "000000.jpg",
        "000001_try2.jpg",
        "000002_try2.jpg",
    ]
    assert bagit.Bag(str(tmp_path / "s")).validate()
