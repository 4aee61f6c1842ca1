"""Tables and pictures that are damaged, cut short or made to harm, given to `litrig render`: one line, or a picture."""

import struct
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from litrig.base.pictures import write_picture
from litrig.commands import run
from processing.amc.files.either import write_any
from processing.amc.isotropic import isotropic_matcap
from processing.matcap.matcap_exr import write_matcap
from tests.processing.matcap.maps import analytic
from tests.viewer.analytic import brushed_amc

NAMES = ("x.amc.ktx2", "x.amc.exr", "x.matcap.exr", "x.exr", "x.png")
FLIPS = 6
Harm = Callable[[bytes], bytes]


def render(monkeypatch: pytest.MonkeyPatch, file: Path, out: Path) -> int:
    words = ["litrig", "render", str(file), "-o", str(out), "--size", "40", "30", "--supersample", "1"]
    monkeypatch.setattr(sys, "argv", words)
    return run()


@cache
def whole(name: str) -> bytes:
    amc = brushed_amc(16, 6)
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / name
        if name == "x.matcap.exr":
            write_matcap(place, analytic(16))
        elif ".amc." in name:
            write_any(place, amc, rank=3) if name.endswith(".exr") else write_any(place, amc)
        else:
            write_picture(place, isotropic_matcap(amc))
        return place.read_bytes()


def without(_: bytes) -> bytes:
    return b""


def head_alone(content: bytes) -> bytes:
    return content[:60]


def half(content: bytes) -> bytes:
    return content[: len(content) // 2]


def all_but_the_end(content: bytes) -> bytes:
    return content[: -max(1, len(content) // 50)]


def noise(content: bytes) -> bytes:
    return bytes(np.random.default_rng(5).integers(0, 256, len(content), dtype=np.uint8))


def larger_windows(content: bytes) -> bytes:
    """Let every window of an EXR reach to 2·10⁹."""
    changed = bytearray(content)
    for word in (b"dataWindow\0box2i\0", b"displayWindow\0box2i\0"):
        start = 0
        while (start := changed.find(word, start)) >= 0:
            start += len(word) + 4
            changed[start : start + 16] = struct.pack("<4i", 0, 0, 2_000_000_000, 2_000_000_000)
    return bytes(changed)


def wide_windows(content: bytes) -> bytes:
    """Let every window of an EXR have ten gigapixels: within what the format allows, and beyond the memory."""
    return larger_windows(content).replace(
        struct.pack("<2i", 2_000_000_000, 2_000_000_000), struct.pack("<2i", 99_999, 99_999)
    )


def texels_without_end(content: bytes) -> bytes:
    """Let a KTX2 claim 2³¹ texels each way."""
    return content[:20] + struct.pack("<3I", 1 << 31, 1 << 31, 1 << 31) + content[32:]


CASES = [
    *[(name, harm) for name in NAMES for harm in (without, head_alone, half, all_but_the_end, noise)],
    *[(name, harm) for name in NAMES if name.endswith(".exr") for harm in (larger_windows, wide_windows)],
    ("x.amc.ktx2", texels_without_end),
]


@pytest.mark.parametrize(("name", "harm"), CASES, ids=lambda value: getattr(value, "__name__", value))
def test_a_malformed_table_is_one_line_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], name: str, harm: Harm
) -> None:
    (tmp_path / name).write_bytes(harm(whole(name)))
    assert render(monkeypatch, tmp_path / name, tmp_path / "y.png") == 1
    said = capfd.readouterr()
    assert said.out == ""
    assert said.err.startswith("litrig: ") and said.err.count("\n") == 1
    assert name in said.err
    assert sorted(path.name for path in tmp_path.iterdir()) == [name]


@pytest.mark.parametrize("name", NAMES)
def test_a_flipped_bit_is_one_line_or_a_picture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], name: str
) -> None:
    content = whole(name)
    random = np.random.default_rng(len(name))
    for place in random.integers(0, len(content), FLIPS):
        changed = bytearray(content)
        changed[place] ^= 1 << int(random.integers(0, 8))
        (tmp_path / name).write_bytes(bytes(changed))
        (tmp_path / "y.png").unlink(missing_ok=True)
        status = render(monkeypatch, tmp_path / name, tmp_path / "y.png")
        said = capfd.readouterr().err
        assert (status, said.count("\n")) in ((0, 0), (1, 1)), f"byte {place}: {said}"
        assert (tmp_path / "y.png").exists() == (status == 0)
