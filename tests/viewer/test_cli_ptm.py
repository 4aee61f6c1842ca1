"""What `litrig render` shows of PTMs and their kin, as it is typed; and what it makes of light afterwards."""

from pathlib import Path

import numpy as np
import pytest

from litrig.base.errors import InputError
from litrig.base.pictures import read_linear
from litrig.base.radiometry import decode_srgb, encode_srgb, to_u8
from processing.ptm.basis import PTM, Basis
from processing.ptm.files.either import read_any, write_any
from processing.ptm.relighting.highlight import Highlight, shade
from processing.ptm.relighting.lights import lamps
from processing.ptm.relighting.many_lights import relight_by_many
from processing.ptm.relighting.normals import normals_of
from processing.ptm.relighting.relight import relight
from tests.processing.ptm.files.fitted import fitted
from tests.viewer.test_cli import SMALL, codes, run

LIGHT = ["--light", "0.4", "-0.3"]
DIRECTION = lamps([(0.4, -0.3)]).directions[0]
FORMS = {"x.ptm": PTM, "x.rti": Basis("hsh", 9), "x.ptm.exr": Basis("hsh", 16), "web": Basis("hsh", 4)}


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("materials")
    for name, basis in FORMS.items():
        write_any(folder / name, fitted(basis, "lrgb" if name == "x.ptm" else "rgb"))
    return folder


def near(picture: np.ndarray, values: np.ndarray) -> None:
    assert np.abs(picture.astype(int) - to_u8(values)).max() <= 1


@pytest.mark.parametrize("name", FORMS)
def test_every_form_is_drawn_flat_and_on_a_mesh(files: Path, tmp_path: Path, name: str) -> None:
    run(files / name, "-o", tmp_path / "x.png", *LIGHT)
    near(codes(tmp_path / "x.png"), relight(read_any(files / name), DIRECTION))
    run(files / name, "-o", tmp_path / "y.png", "--mesh", "ribbon", *LIGHT, *SMALL)
    assert codes(tmp_path / "y.png").std() > 20


def test_values_are_light_in_an_exr(files: Path, tmp_path: Path) -> None:
    run(files / "x.rti", "-o", tmp_path / "x.exr", *LIGHT)
    truth = decode_srgb(relight(read_any(files / "x.rti"), DIRECTION))
    np.testing.assert_allclose(read_linear(tmp_path / "x.exr"), truth, atol=1e-5)


def test_coloured_lights_add_up_as_light(files: Path, tmp_path: Path) -> None:
    lights = lamps([(0.4, -0.3), (-0.5, 0.5)], [(1, 0.5, 0.2), (0.1, 0.2, 0.8)])
    words = [
        *LIGHT,
        "--light",
        "-0.5",
        "0.5",
        "--light-colour",
        "1",
        "0.5",
        "0.2",
        "--light-colour",
        "0.1",
        "0.2",
        "0.8",
    ]
    run(files / "x.rti", "-o", tmp_path / "x.png", *words)
    near(codes(tmp_path / "x.png"), encode_srgb(relight_by_many(read_any(files / "x.rti"), lights)))


def test_a_highlight_is_as_litrig_ptm_relight_has_it(files: Path, tmp_path: Path) -> None:
    ptm = read_any(files / "x.ptm")
    run(files / "x.ptm", "-o", tmp_path / "x.png", *LIGHT, "--specular", "0.4", "30")
    near(codes(tmp_path / "x.png"), shade(ptm, DIRECTION, Highlight(normals_of(ptm), 0.4, 30)))


@pytest.mark.parametrize("where", [[], ["--mesh", "ribbon", *SMALL]], ids=["flat", "mesh"])
@pytest.mark.parametrize("option", [["--diffuse-gain", "2.5"], ["--specular", "0.5", "20"], ["--softness", "30"],
                                    ["--normals"], ["--exposure", "-2"], ["--tone", "filmic"], ["--tone", "reinhard"]],
                         ids=" ".join)  # fmt: skip
def test_every_option_changes_the_picture(files: Path, tmp_path: Path, where: list[str], option: list[str]) -> None:
    run(files / "x.ptm", "-o", tmp_path / "a.png", *where)
    run(files / "x.ptm", "-o", tmp_path / "b.png", *where, *option)
    assert np.abs(codes(tmp_path / "a.png").astype(int) - codes(tmp_path / "b.png")).max() > 20


def test_a_window_is_shown_texel_by_texel(files: Path, tmp_path: Path) -> None:
    run(files / "x.ptm", "-o", tmp_path / "a.png", *LIGHT)
    run(files / "x.ptm", "-o", tmp_path / "b.png", *LIGHT, "--window", 3, 20, 10, 8, "--zoom", 5)
    expected = np.kron(codes(tmp_path / "a.png")[20:28, 3:13], np.ones((5, 5, 1)))
    np.testing.assert_array_equal(codes(tmp_path / "b.png"), expected)


def test_exposure_is_in_stops_of_light(files: Path, tmp_path: Path) -> None:
    for name, option in (("a", []), ("b", ["--exposure", "1.5"])):
        run(files / "x.ptm", "-o", tmp_path / f"{name}.exr", *LIGHT, *option)
        run(
            files / "x.ptm",
            "-o",
            tmp_path / f"{name}m.exr",
            "--mesh",
            "torus",
            "--background",
            "#000000",
            *SMALL,
            *option,
        )
    for kind in ("", "m"):
        once, more = (read_linear(tmp_path / f"{name}{kind}.exr") for name in "ab")
        np.testing.assert_allclose(more, once * 2**1.5, rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("ending", ["png", "exr", "mp4"])
@pytest.mark.parametrize("where", [[], ["--mesh", "ribbon", *SMALL]], ids=["flat", "mesh"])
def test_the_same_file_gives_the_same_bytes(files: Path, tmp_path: Path, ending: str, where: list[str]) -> None:
    for name in "ab":
        motion = ["--tour", "4"] if ending == "mp4" else []
        run(files / "x.rti", "-o", tmp_path / f"{name}.{ending}", "--specular", "0.3", "20", *where, *motion)
    assert (tmp_path / f"a.{ending}").read_bytes() == (tmp_path / f"b.{ending}").read_bytes()


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        pytest.param(["x.rti", "--diffuse-gain", "2"], "is a HSH of 9 terms.*use --specular", id="gain of an HSH"),
        pytest.param(["x.rti", "--mesh", "torus", "--diffuse-gain", "2"], "is a HSH of 9 terms", id="on a mesh"),
        pytest.param(["x.ptm", "--window", "0", "0", "65", "9"], "not within the PTM's 64 × 64", id="a window beyond"),
        pytest.param(
            ["x.ptm", "--mesh", "torus", "--window", "0", "0", "5", "9"], "of a flat PTM", id="a window on it"
        ),
        pytest.param(["x.ptm", "--light-colour", "1", "1", "1", *LIGHT, *LIGHT], "2 of them and 1 col", id="colours"),
        pytest.param(["x.ptm", "--softness", "100"], r"outside 0\.\.90", id="softness"),
        pytest.param(["x.ptm", *(LIGHT * 5), "--softness", "5"], "80 are outside 1..64", id="soft lights"),
        pytest.param(["x.ptm", "--normals", "--exposure", "1"], "have no exposure", id="exposed normals"),
        pytest.param(
            ["x.ptm", "--mesh", "torus", "--normals", "--tone", "filmic"], "no tone; leave", id="on a mesh too"
        ),
        pytest.param(
            ["x.ptm", "--normals", *LIGHT], "the same under every light; leave out the lights", id="lit normals"
        ),
        pytest.param(["x.ptm", "--normals", "--tour", "4", "-o", "x.mp4"], "leave out --tour", id="normals on tour"),
        pytest.param(["x.ptm", "--exposure", "nan"], "exposure: nan", id="an exposure of nan"),
        pytest.param(["x.ptm", "--zoom", "0"], "a zoom of 0", id="no zoom"),
        pytest.param(["x.ptm", "--turntable", "4", "-o", "x.mp4"], "does not turn; use --tour", id="a flat turn"),
        pytest.param(["x.ptm", "--tour", "4"], "is no video; end the name in .mp4", id="a tour in a picture"),
        pytest.param(["x.ptm", "-o", "x.mp4"], "nothing moves", id="a still video"),
        pytest.param(["x.ptm", "-o", "x.mp4", "--tour", "1"], r"1 frames are outside 2\.\.", id="one frame"),
        pytest.param(["x.ptm", "-o", "x.mp4", "--tour", "3", "--fps", "0"], "0 frames a second", id="no speed"),
        pytest.param(
            ["x.ptm", "-o", "x.mp4", "--tour", "3", "--window", "0", "0", "5", "5"], "have to be even", id="odd sides"
        ),
        pytest.param(["x.ptm", "-o", "no/x.mp4", "--tour", "3"], "does not exist; create it", id="no folder"),
        pytest.param(
            ["x.ptm", "-o", "x.mp4", "--mesh", "torus", "--tour", "3", "--background", "transparent"],
            "cannot be transparent",
            id="a clear video",
        ),
    ],
)
def test_what_does_not_go_together_is_one_clear_error(
    files: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], reason: str
) -> None:
    monkeypatch.chdir(files)
    before = sorted(files.rglob("*"))
    out = [] if "-o" in arguments else ["-o", str(tmp_path / "x.png")]
    with pytest.raises(InputError, match=reason) as caught:
        run(*arguments, *out)
    assert "\n" not in str(caught.value)
    assert sorted(files.rglob("*")) == before and not any(tmp_path.iterdir())
