"""Materials that are damaged, cut short or made to harm, given to the command: one line, status 1, nothing left."""

import json
import math
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from litrig.commands import run
from processing.ptm.basis import PTM, Basis
from processing.ptm.files.either import write_any
from tests.processing.ptm.files.fitted import small
from tests.processing.ptm.files.jpeg_ptm import packed_ptm

COMMANDS = {
    "convert": lambda file, out: ["ptm", "convert", file, out / "y.ptm.exr"],
    "relight": lambda file, out: ["ptm", "relight", file, "--light", "0", "0", "-o", out / "y.png"],
    "render": lambda file, out: ["render", file, "-o", out / "y.png"],
}
HUGE = b"PTM_1.2\nPTM_FORMAT_RGB\n707106 707106\n1 1 1 1 1 1\n0 0 0 0 0 0\n"
Harm = Callable[[bytes], bytes]


def litrig(monkeypatch: pytest.MonkeyPatch, *words: object) -> int:
    monkeypatch.setattr(sys, "argv", ["litrig", *map(str, words)])
    return run()


@cache
def whole(name: str) -> dict[str, bytes]:
    """A good material, as the bytes of its file, or of each file in its folder."""
    if name == "packed.ptm":
        return {"": packed_ptm(np.arange(9 * 64, dtype=np.int64).astype(np.uint8).reshape(9, 8, 8))}
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / name
        write_any(place, small(Basis("hsh", 4) if name.endswith(".rti") else PTM, "lrgb"))
        return {f.name: f.read_bytes() for f in place.iterdir()} if place.is_dir() else {"": place.read_bytes()}


def without(_: bytes) -> bytes:
    return b""


def half(content: bytes) -> bytes:
    return content[: len(content) // 2]


def noise(content: bytes) -> bytes:
    return bytes(np.random.default_rng(5).integers(0, 256, len(content), dtype=np.uint8))


def other(old: bytes, new: bytes) -> Harm:
    def change(content: bytes) -> bytes:
        assert old in content
        return content.replace(old, new, 1)

    return change


def info(**changes: Any) -> Harm:
    return lambda content: json.dumps({**json.loads(content), **changes}).encode()


CASES = [
    *[pytest.param(name, "", harm, name, id=f"{name} {harm.__name__}")
      for name in ("x.ptm", "x.rti", "x.ptm.exr", "packed.ptm") for harm in (without, half, noise)],
    *[pytest.param("web", file, harm, f"web/{file}", id=f"web/{file} {harm.__name__}")
      for file in ("info.json", "plane_1.jpg") for harm in (without, half, noise)],
    pytest.param("x.ptm", "", lambda _: HUGE, "claims 707106 × 707106", id="ptm: 61 bytes ask for 9 TB"),
    pytest.param("x.ptm", "", other(b"5\n3\n", b"20000\n20000\n"), "cut short, copy it again", id="ptm: gigabytes"),
    pytest.param("x.rti", "", other(b"5 3 3", b"900000 900000 3"), "claims 900000 × 900000", id="rti: terabytes"),
    pytest.param("x.rti", "", other(b"5 3 3", b"20000 20000 3"), "cut short, copy it again", id="rti: gigabytes"),
    pytest.param("packed.ptm", "", other(b"8\n8\n", b"20000\n20000\n"), "8 × 8 pixels, where", id="packed: gigabytes"),
    pytest.param("web", "info.json", info(width=20000, height=20000), "5 × 3 pixels, where", id="web: gigabytes"),
    pytest.param("web", "info.json", info(width=10**400), "web/info.json: width", id="web: a number of 400 digits"),
    pytest.param("web", "info.json", lambda _: b'{"a":' * 99_999, "recursion limit", id="web: nested without end"),
    pytest.param("web", "info.json", info(materials=[{"scale": [math.nan], "bias": [0]}]), "finite", id="web: NaN"),
    pytest.param("web", "info.json", info(nplanes=8), "8 planes make no lrgb ptm", id="web: a plane short"),
    pytest.param("web", "info.json", info(type="rbf"), "type is 'rbf'; ptm and hsh are read", id="web: another basis"),
    pytest.param("x.ptm", "", other(b"LRGB", b"LUM"), "PTM_FORMAT_LUM, which is not read", id="ptm: a rare kind"),
]  # fmt: skip


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize(("name", "part", "harm", "reason"), CASES)
def test_a_malformed_material_is_one_line_and_leaves_nothing(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
    name: str,
    part: str,
    harm: Harm,
    reason: str,
    command: str,
) -> None:
    file = tmp_path / name
    for place, content in whole(name).items():
        (file / place).parent.mkdir(exist_ok=True)
        (file / place if place else file).write_bytes(harm(content) if place == part else content)
    (tmp_path / "out").mkdir()
    assert litrig(monkeypatch, *COMMANDS[command](file, tmp_path / "out")) == 1
    said = capfd.readouterr()
    assert said.out == ""
    assert said.err.startswith("litrig: ")
    assert said.err.count("\n") == 1
    assert name in said.err
    assert reason in said.err
    assert not list((tmp_path / "out").iterdir())


@pytest.mark.parametrize(
    ("target", "reason"),
    [
        pytest.param(
            "y.rti", "holds HSH of 4 terms and HSH of 9 terms, not PTM of 6 terms; end the name in", id="basis"
        ),
        pytest.param("y.jpg", "cannot be written as .jpg; end the name in", id="a picture"),
        pytest.param("no/y.ptm", "does not exist; create it first", id="no folder"),
        pytest.param("full", "holds files already, which are never mixed", id="a folder in use"),
        pytest.param("y" * 300, "File name too long", id="a name too long"),
    ],
)
def test_a_target_that_cannot_be_is_one_line(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
    target: str,
    reason: str,
) -> None:
    write_any(tmp_path / "x.ptm", small(PTM, "lrgb"))
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "thesis.txt").write_text("mine")
    before = sorted(tmp_path.rglob("*"))
    assert litrig(monkeypatch, "ptm", "convert", tmp_path / "x.ptm", tmp_path / target) == 1
    said = capfd.readouterr().err
    assert said.startswith("litrig: ")
    assert said.count("\n") == 1
    assert reason in said
    assert sorted(tmp_path.rglob("*")) == before
