"""Sets of pictures and lights that cannot be fitted, given to the command: one line, status 1, nothing left."""

import shutil
import struct
import sys
import zlib
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from litrig.commands import run
from tests.processing.ptm.relief import dome, write_relief

LIGHTS = dome(9)
Harm = Callable[[Path], object]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("whole") / "set"
    write_relief(folder, LIGHTS, 24)
    return folder


def lp(change: Callable[[list[str]], list[str]]) -> Harm:
    """Change the lines of the list."""

    def harm(folder: Path) -> None:
        path = folder / "relief.lp"
        path.write_text("\n".join(change(path.read_text().splitlines())) + "\n")

    return harm


def line(place: int, text: str) -> Harm:
    return lp(lambda lines: [*lines[:place], text, *lines[place + 1 :]])


def lights(change: Callable[[int], str]) -> Harm:
    """Give each picture another light."""
    return lp(lambda lines: [lines[0], *(f"light_{index:03d}.png {change(index)}" for index in range(9))])


def picture(content: Callable[[bytes], bytes]) -> Harm:
    def harm(folder: Path) -> None:
        path = folder / "light_004.png"
        path.write_bytes(content(path.read_bytes()))

    return harm


def bomb(_: bytes) -> bytes:
    """A PNG of a hundred bytes that claims 30000 × 30000 pixels."""

    def chunk(kind: bytes, body: bytes) -> bytes:
        return struct.pack(">L", len(body)) + kind + body + struct.pack(">L", zlib.crc32(kind + body))

    head = struct.pack(">2L5B", 30_000, 30_000, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(b"")) + chunk(b"IEND", b"")


def larger(folder: Path) -> None:
    cv2.imwrite(str(folder / "light_004.png"), np.zeros((24, 30, 3), np.uint8))


def deeper(folder: Path) -> None:
    cv2.imwrite(str(folder / "light_004.png"), np.zeros((24, 24, 3), np.uint16))


def emptied(folder: Path) -> None:
    for path in folder.iterdir():
        path.unlink()


CASES = [
    pytest.param(lambda folder: (folder / "relief.lp").unlink(), "its light is not known; put an .lp", id="no .lp"),
    pytest.param(line(0, "12"), "promises 12 lights and has 9", id="count and lines differ"),
    pytest.param(line(3, "light_002.png 0 0 0"), "light_002.png has no length", id="zero vector"),
    pytest.param(line(3, "light_002.png 0 x 1"), "line 4: expected `name x y z`", id="not a number"),
    pytest.param(line(3, "light_002.png nan 0 1"), "line 4", id="NaN"),
    pytest.param(line(3, "light_77.png 0 0 1"), "light_77.png, not found in", id="a picture that is not there"),
    pytest.param(line(3, "light_003.png 0 0 1"), "light_003.png", id="a picture twice"),
    pytest.param(line(3, "light_002.png 0.6 0 -0.8"), "not above the horizon", id="a light from below"),
    pytest.param(lights(lambda _: "0.3 0.3 0.9"), "1 direction, which cannot carry", id="all lights equal"),
    pytest.param(
        lights(lambda index: f"{np.cos(index)} {np.sin(index)} 1"), "on one ring, 45 deg", id="one ring of elevation"
    ),
    pytest.param(lights(lambda index: f"{index / 9} 0 1"), "in one line", id="an arc"),
    pytest.param(lp(lambda lines: ["5", *lines[1:6]]), "5 lights from 5 directions", id="too few lights"),
    pytest.param(lambda folder: (folder / "relief.lp").write_bytes(b""), "relief.lp: empty", id="empty .lp"),
    pytest.param(lambda folder: (folder / "relief.lp").write_bytes(bytes(range(256)) * 9), "relief.lp", id="no text"),
    pytest.param(lambda folder: (folder / "b.lp").write_text("1\na 0 0 1"), "keep one .lp", id="two lists"),
    pytest.param(picture(lambda content: content[:-20]), "light_004.png: PNG cut short", id="cut short"),
    pytest.param(picture(lambda content: content[:30]), "light_004.png: PNG cut short", id="header alone"),
    pytest.param(picture(lambda _: b""), "light_004.png", id="empty picture"),
    pytest.param(picture(lambda _: b"GIF89a" * 40), "light_004.png", id="another format"),
    pytest.param(picture(bomb), "claims 30000 × 30000 pixels", id="a bomb"),
    pytest.param(larger, "light_004.png: is 30 × 24 pixels", id="another size"),
    pytest.param(deeper, "light_004.png: holds uint16 values", id="another depth"),
    pytest.param(lambda folder: (folder / "light_004.png").unlink(), "light_004.png", id="a picture gone"),
    pytest.param(emptied, "holds no picture", id="empty folder"),
    pytest.param(shutil.rmtree, "no such folder", id="no folder"),
]


@pytest.mark.parametrize(("harm", "reason"), CASES)
def test_a_set_that_cannot_be_fitted_is_one_line_and_leaves_nothing(
    whole: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
    harm: Harm,
    reason: str,
) -> None:
    folder, out = tmp_path / "set", tmp_path / "out"
    shutil.copytree(whole, folder)
    out.mkdir()
    harm(folder)
    monkeypatch.setattr(sys, "argv", ["litrig", "ptm", "fit", str(folder), "-o", str(out / "x.ptm")])
    assert run() == 1
    errors = [said for said in capfd.readouterr().err.splitlines() if said.startswith("litrig: ")]
    assert len(errors) == 1
    assert str(folder) in errors[0]
    assert reason in errors[0]
    assert list(out.iterdir()) == []


@pytest.mark.parametrize(
    "harm",
    [
        pytest.param(lp(lambda lines: lines[1:]), id="no count"),
        pytest.param(lp(lambda lines: [line.replace(" 0.", " 0,") for line in lines]), id="decimal commas"),
        pytest.param(lp(lambda lines: ["\r".join([line, ""]) for line in lines]), id="CRLF"),
        pytest.param(
            lp(lambda lines: [lines[0], *(rf"C:\scans\may 4\{line}" for line in lines[1:])]), id="Windows paths"
        ),
        pytest.param(lp(lambda lines: [lines[0], *reversed(lines[1:])]), id="in another order"),
    ],
)
def test_lists_as_they_are_met_give_the_same_fit(
    whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, harm: Harm
) -> None:
    shutil.copytree(whole, tmp_path / "set")
    harm(tmp_path / "set")
    for folder, name in ((whole, "a.ptm"), (tmp_path / "set", "b.ptm")):
        monkeypatch.setattr(sys, "argv", ["litrig", "ptm", "fit", str(folder), "-o", str(tmp_path / name)])
        assert run() == 0
    a, b = ((tmp_path / name).read_bytes().split(b"#litrig")[0] for name in ("a.ptm", "b.ptm"))
    codes = [np.frombuffer(content[-24 * 24 * 9 - 1 : -1], np.uint8).astype(int) for content in (a, b)]
    assert np.abs(codes[0] - codes[1]).max() <= 1
