import errno
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from litrig.base.capture_folder.journal import Journal, decode_entry, encode_entry, read_journal
from litrig.base.errors import FormatError, InputError
from litrig.base.store import DiskStore

scalars = st.none() | st.booleans() | st.integers(-(2**53), 2**53) | st.floats(allow_nan=False, allow_infinity=False)
leaves = scalars | st.text()
values = st.recursive(leaves, lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner), max_leaves=5)


@given(st.dictionaries(st.text().filter(lambda key: key != "crc"), values, min_size=1))
def test_what_is_written_is_read(entry: dict[str, object]) -> None:
    assert decode_entry(encode_entry(entry)) == entry


def test_every_single_flipped_bit_is_noticed() -> None:
    line = encode_entry({"ev": "frame", "angle_deg": 45.25, "file": "data/frames/000001.jpg"})
    for position in range(8 * len(line)):
        flipped = bytearray(line)
        flipped[position // 8] ^= 1 << position % 8
        assert decode_entry(bytes(flipped)) is None


def test_a_journal_cut_at_any_byte_opens_and_loses_the_torn_line_only(tmp_path: Path) -> None:
    path = tmp_path / "journal.jsonl"
    journal = Journal(path, wall_clock=lambda: "2026-01-01T00:00:00+00:00", monotonic_ns=lambda: 1)
    for step in range(3):
        journal.append("frame", step=step)
    content = path.read_bytes()
    ends = [position + 1 for position, byte in enumerate(content) if byte == ord("\n")]
    for cut in range(len(content) + 1):
        path.write_bytes(content[:cut])
        assert [entry["seq"] for entry in read_journal(path)] == list(range(sum(end <= cut for end in ends)))


def test_damage_in_the_middle_is_not_taken_for_a_torn_tail(tmp_path: Path) -> None:
    path = tmp_path / "journal.jsonl"
    lines = [encode_entry({"seq": seq}) for seq in range(3)]
    path.write_bytes(lines[0] + b"{}\n" + lines[2])
    with pytest.raises(FormatError, match="line 2: damaged in the middle"):
        read_journal(path)


def test_a_full_disk_leaves_whole_lines_only(tmp_path: Path) -> None:
    script = """
import resource, sys
import subprocess
import sys
from pathlib import Path
from litrig.base.capture_folder.journal import Journal
from litrig.base.errors import InputError
import signal
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
journal = Journal(Path(sys.argv[1]))
try:
    for step in range(100):
        journal.append("frame", step=step)
except InputError as error:
    print(step, error)
"""
    path = tmp_path / "journal.jsonl"
    result = subprocess.run([sys.executable, "-c", script, str(path)], capture_output=True, text=True, check=True)
    written, message = result.stdout.split(maxsplit=1)
    assert "journal.jsonl: cannot be written" in message
    assert [entry["step"] for entry in read_journal(path)] == list(range(int(written)))
    assert path.read_bytes().endswith(b"\n")


class FailingStore(DiskStore):
    """Writes half a line, and then cannot even shorten the file, until the disk is mended."""

    is_broken = False

    def append(self, path: Path, content: bytes) -> None:
        if not self.is_broken:
            super().append(path, content)
            return
        super().append(path, content[: len(content) // 2])
        raise OSError(errno.ENOSPC, "No space left on device")

    def cut(self, path: Path, size: int) -> None:
        if self.is_broken:
            raise OSError(errno.EIO, "Input/output error")
        super().cut(path, size)


def test_half_a_line_that_could_not_be_taken_back_is_cut_off_by_the_next(tmp_path: Path) -> None:
    path, store = tmp_path / "journal.jsonl", FailingStore()
    journal = Journal(path, store=store)
    journal.append("one")
    store.is_broken = True
    for _ in range(2):
        with pytest.raises(InputError, match="cannot be written"):
            journal.append("lost")
    store.is_broken = False
    journal.append("two")
    assert [(entry["seq"], entry["ev"]) for entry in read_journal(path)] == [(0, "one"), (1, "two")]


class InterruptedStore(DiskStore):
    """A Ctrl-C comes when a line is written and not yet synced."""

    interrupts = True

    def sync(self, path: Path) -> None:
        if self.interrupts:
            raise KeyboardInterrupt
        super().sync(path)


def test_a_line_that_was_interrupted_does_not_share_its_number_with_the_next(tmp_path: Path) -> None:
    path, store = tmp_path / "journal.jsonl", InterruptedStore()
    journal = Journal(path, store=store)
    with pytest.raises(KeyboardInterrupt):
        journal.append("interrupted")
    store.interrupts = False
    journal.append("stop")
    assert [(entry["seq"], entry["ev"]) for entry in read_journal(path)] == [(0, "stop")]
