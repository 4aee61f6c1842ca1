"""`litrig ptm lights` end to end."""

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from click.testing import CliRunner, Result

from litrig.base.capture_folder.writer import CaptureFolderWriter
from litrig.base.directions import angle_between_deg
from litrig.base.errors import ConfigError, FormatError, InputError
from litrig.base.lp import read_lp
from litrig.base.pictures import read_codes, write_codes
from processing.ptm.cli import ptm
from tests.processing.ptm.lights.mirror_balls import Balls, lamps

LIGHTS = lamps(6)
SCENE = Balls(balls=((40.3, 38.8, 27.6), (118, 78, 31)), dark=(3,), second={4: (-0.5, -0.4, 0.77)}, samples=2)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return SCENE.shoot(tmp_path_factory.mktemp("balls"), LIGHTS)


@pytest.fixture(scope="module")
def found(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """The list, with its detections beside it, and what the command said."""
    out = tmp_path_factory.mktemp("found") / "balls.lp"
    result = run(folder, "-o", out, "--report", out.parent / "page")
    assert result.exit_code == 0
    return out, result.output


def run(*arguments: object) -> Result:
    """Run the command; what it raises is raised here."""
    return CliRunner().invoke(ptm, ["lights", *(str(word) for word in arguments)], catch_exceptions=False)


def changed(found: Path, to: Path, **changes: object) -> Path:
    """Copy detections, with other tables in place of the same name."""
    table = tomllib.loads(found.with_name("balls.detections.toml").read_text())
    to.write_text(tomli_w.dumps({**table, **changes}))
    return to


def detections(found: Path) -> list[dict[str, object]]:
    frames = tomllib.loads(found.with_name("balls.detections.toml").read_text())["frame"]
    assert isinstance(frames, list)
    return frames


def test_the_list_holds_the_lights(found: tuple[Path, str]) -> None:
    lights = read_lp(found[0])
    assert lights.names == tuple(f"light_{n:02d}.png" for n in (0, 1, 2, 4, 5))
    # Of the two lamps in the fourth picture either may win; it is flagged.
    errors = [angle_between_deg(lights.directions[place], LIGHTS[n]) for place, n in ((0, 0), (1, 1), (2, 2), (4, 5))]
    assert np.mean(errors) < 1


def test_it_says_what_was_found_and_what_wants_a_look(found: tuple[Path, str]) -> None:
    for words in (
        "ball 1: centre ",
        "ball 2: centre ",
        "orthographic",
        "lights: 5 of 6",
        "residual between balls: ",
        "look at light_04.png: double",
        "left out light_03.png: shadowed",
        str(found[0]),
    ):
        assert words in found[1]


def test_the_page_shows_every_detection(found: tuple[Path, str]) -> None:
    page = found[0].parent / "page"
    text = (page / "index.html").read_text()
    for words in ("light_03.png", "left out: shadowed", "double", "ball_1.png", "ball_2.png", "directions.png"):
        assert words in text
    sheet = read_codes(page / "ball_2.png")
    green = (sheet[..., 1] > 200) & (sheet[..., 0] < 130)
    orange = (sheet[..., 0] > 200) & (sheet[..., 2] < 110)
    assert green.any()
    assert orange.any()


def test_json_says_the_same(folder: Path, tmp_path: Path) -> None:
    balls = [word for x, y, radius in SCENE.balls for word in ("--ball", x, y, radius)]
    facts = json.loads(run(folder, "-o", tmp_path / "x.lp", *balls, "--json").stdout)
    assert [ball["circle_px"] for ball in facts["balls"]] == [list(ball) for ball in SCENE.balls]
    assert facts["lights"][3]["left_out"] == "shadowed"
    assert facts["lights"][3]["direction"] is None
    assert facts["lights"][4]["flags"] == ["double"]
    assert len(facts["lights"][0]["highlights"]) == 2
    assert np.linalg.norm(facts["lights"][0]["direction"]) == pytest.approx(1)


def test_detections_replayed_give_the_same_list(folder: Path, found: tuple[Path, str], tmp_path: Path) -> None:
    edits = changed(found[0], tmp_path / "edits.toml")
    run(folder, "-o", tmp_path / "balls.lp", "--edits", edits)
    assert (tmp_path / "balls.lp").read_bytes() == found[0].read_bytes()
    again, before = (path.with_name("balls.detections.toml") for path in (tmp_path / "balls.lp", found[0]))
    assert tomllib.loads(again.read_text()) == tomllib.loads(before.read_text())


def test_detections_replayed_from_a_distance_keep_their_camera(folder: Path, tmp_path: Path) -> None:
    first, second = tmp_path / "a.lp", tmp_path / "b.lp"
    run(folder, "-o", first, "--distance", 9)
    run(folder, "-o", second, "--edits", tmp_path / "a.detections.toml")
    assert second.read_bytes() == first.read_bytes()
    orthographic = tmp_path / "c.lp"
    run(folder, "-o", orthographic)
    assert orthographic.read_bytes() != first.read_bytes()


def test_a_detection_can_be_moved_and_dropped(folder: Path, found: tuple[Path, str], tmp_path: Path) -> None:
    frames = detections(found[0])
    frames[0]["drop"] = True
    frames[1]["highlight"] = [{"ball": 1, "x_px": 118.0, "y_px": 78.0}]
    edits = changed(found[0], tmp_path / "edits.toml", frame=frames[:2])
    result = run(folder, "-o", tmp_path / "x.lp", "--edits", edits)
    assert "left out light_00.png: dropped" in result.output
    lights = read_lp(tmp_path / "x.lp")
    assert (lights.names or ("",))[0] == "light_01.png"
    # The middle of a ball mirrors the camera; the larger ball comes first.
    assert lights.directions[0] == pytest.approx([0, 0, 1], abs=0.002)
    # Frames that the edits do not name are looked at as before.
    before = read_lp(found[0])
    np.testing.assert_array_equal(lights.directions[1:], before.directions[2:])


def test_edits_replayed_in_place_are_not_overwritten(folder: Path, found: tuple[Path, str], tmp_path: Path) -> None:
    edits = changed(found[0], tmp_path / "x.detections.toml", frame=[{"name": "light_00.png", "drop": True}])
    before = edits.read_bytes()
    run(folder, "-o", tmp_path / "x.lp", "--edits", edits)
    assert edits.read_bytes() == before


@pytest.mark.parametrize(
    ("text", "error", "message"),
    [
        pytest.param("balls = 1", ConfigError, "unknown key 'balls'", id="unknown key"),
        pytest.param('[[frame]]\nname = "x.png"', InputError, r"names x.png, which is not among", id="no such picture"),
        pytest.param(
            '[[frame]]\nname = "light_00.png"\n[[frame.highlight]]\nx_px = 3.0\ny_px = 4.0',
            ConfigError,
            r"no \[\[ball\]\] is named",
            id="highlight without a ball",
        ),
        pytest.param(
            "[[ball]]\nx_px = 40.0\ny_px = 39.0\nradius_px = 27.0\n"
            '[[frame]]\nname = "light_00.png"\n[[frame.highlight]]\nball = 2\nx_px = 40.0\ny_px = 40.0',
            ConfigError,
            "a highlight in ball 2 of 1",
            id="no such ball",
        ),
        pytest.param(
            "[[ball]]\nx_px = 40.0\ny_px = 39.0\nradius_px = 27.0\n"
            '[[frame]]\nname = "light_00.png"\n[[frame.highlight]]\nx_px = 80.0\ny_px = 40.0',
            InputError,
            "lies beside ball 1; move it inside",
            id="beside the ball",
        ),
        pytest.param(
            '[[frame]]\nname = "light_00.png"\n[[frame]]\nname = "light_00.png"',
            ConfigError,
            "light_00.png stands twice",
            id="twice",
        ),
    ],
)
def test_edits_that_cannot_be_are_named(
    folder: Path, tmp_path: Path, text: str, error: type[InputError], message: str
) -> None:
    edits = tmp_path / "edits.toml"
    edits.write_text(text)
    with pytest.raises(error, match=rf"edits.toml.*{message}"):
        run(folder, "-o", tmp_path / "x.lp", "--edits", edits)
    assert not (tmp_path / "x.lp").exists()


def test_a_list_of_an_earlier_run_does_not_hide_pictures(tmp_path: Path) -> None:
    scene = Balls(samples=2)
    folder = scene.shoot(tmp_path / "s", LIGHTS[:4])
    ball = ("--ball", *scene.balls[0])
    (tmp_path / "drop.toml").write_text('[[frame]]\nname = "light_01.png"\ndrop = true\n')
    run(folder, "-o", folder / "s.lp", *ball, "--edits", tmp_path / "drop.toml")
    assert len(read_lp(folder / "s.lp")) == 3
    run(folder, "-o", folder / "s.lp", *ball)
    assert len(read_lp(folder / "s.lp")) == 4


def test_a_ball_photographed_first_lights_the_object(tmp_path: Path) -> None:
    scene = Balls(samples=2)
    balls, coin = scene.shoot(tmp_path / "balls", LIGHTS[:4], stem="ball"), tmp_path / "coin"
    coin.mkdir()
    for name in "abcd":
        write_codes(coin / f"{name}.png", np.full((20, 30, 3), 90, np.uint8))
    result = run(coin, "-o", tmp_path / "coin.lp", "--balls", balls, "--ball", *scene.balls[0])
    assert f"carried from {balls} to 4 pictures of {coin}, by order" in result.output
    assert read_lp(tmp_path / "coin.lp").names == ("a.png", "b.png", "c.png", "d.png")


def test_a_session_keeps_its_ball_frames_apart(tmp_path: Path) -> None:
    scene = Balls(samples=2)
    balls = scene.shoot(tmp_path / "balls", LIGHTS[:4], ".jpg")
    session = tmp_path / "session"
    small = np.zeros((6, 8, 3), np.uint8)
    commanded = [[0.0, 0.6, 0.8], [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8], [0.0, -0.6, 0.8]]
    with CaptureFolderWriter.create(session, "coin", {"session": {"object": "coin"}}, []) as writer:
        for step, (path, light) in enumerate(zip(sorted(balls.glob("*.jpg")), commanded, strict=True)):
            for place, role in ((step, "ball"), (7 - step, "frame")):
                about = {"step": place, "role": role, "light": light, "verdict": "good"}
                writer.add_frame(f"{place:06d}.jpg", path.read_bytes(), small, **about)
    result = run(session, "-o", tmp_path / "coin.lp", "--role", "ball", "--ball", *scene.balls[0])
    assert "by commanded light" in result.output
    lights = read_lp(tmp_path / "coin.lp")
    assert lights.names == ("000004.jpg", "000005.jpg", "000006.jpg", "000007.jpg")
    for direction, truth in zip(lights.directions, LIGHTS[3::-1], strict=True):
        assert angle_between_deg(direction, truth) < 1.5


def test_no_ball_is_refused(tmp_path: Path) -> None:
    for index in range(4):
        write_codes(tmp_path / f"{index}.png", np.full((60, 80, 3), 90, np.uint8))
    with pytest.raises(InputError, match=r"no mirror ball found.*--ball X Y R, or shoot one"):
        run(tmp_path, "-o", tmp_path / "x.lp")
    assert not list(tmp_path.glob("x*"))


@pytest.mark.parametrize(
    ("ball", "message"),
    [
        pytest.param(
            (150, 60, 40), r"light_00.png: a ball with centre 150, 60.*not inside the 160 × 120", id="outside"
        ),
        pytest.param((80, 60, 1), "shows no highlight; give --ball X Y R", id="too small"),
        pytest.param((80, 60, "nan"), "shows no highlight; give --ball X Y R", id="no number"),
        pytest.param((118, 30, 12), r"light_00.png and the 5 other pictures show no light \(shadowed\)", id="no ball"),
    ],
)
def test_a_ball_that_is_none_is_named(
    folder: Path, tmp_path: Path, ball: tuple[object, object, object], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        run(folder, "-o", tmp_path / "x.lp", "--ball", *ball)
    assert not list(tmp_path.iterdir())


def test_pictures_that_are_missing_or_of_another_size_are_named(folder: Path, tmp_path: Path) -> None:
    copy = Balls(samples=1).shoot(tmp_path / "copy", LIGHTS[:4])
    ball = ("--ball", *Balls().balls[0])
    (copy / "a.lp").write_text("1\nlight_77.png 0 0 1\n")
    with pytest.raises(InputError, match=r"a.lp: names light_77.png, not found in"):
        run(copy, "-o", tmp_path / "x.lp", *ball)
    (copy / "a.lp").unlink()
    write_codes(copy / "light_02.png", np.zeros((10, 10, 3), np.uint8))
    with pytest.raises(FormatError, match=r"light_02.png: is 10 × 10 pixels"):
        run(copy, "-o", tmp_path / "x.lp", *ball)
    with pytest.raises(InputError, match=r"nowhere: no such folder"):
        run(folder, "-o", tmp_path / "x.lp", "--balls", tmp_path / "nowhere")


def test_a_camera_of_another_size_is_refused(folder: Path, tmp_path: Path) -> None:
    camera = tmp_path / "camera.toml"
    camera.write_text(
        "width = 80\nheight = 60\nfocal_x_px = 300\nfocal_y_px = 300\ncentre_x_px = 40\ncentre_y_px = 30\n"
    )
    with pytest.raises(InputError, match=r"light_00.png: is 160 × 120 pixels, the camera model is for 80 × 60"):
        run(folder, "-o", tmp_path / "x.lp", "--camera", camera)


def test_two_ways_to_say_one_thing_are_wrong_usage(folder: Path, found: tuple[Path, str], tmp_path: Path) -> None:
    camera = tmp_path / "camera.toml"
    edits = changed(found[0], tmp_path / "edits.toml")
    for words in (
        ("--distance", 5, "--camera", camera),
        ("--balls", folder, "--role", "ball"),
        ("--ball", 40, 40, 20, "--edits", edits),
    ):
        assert run(folder, "-o", tmp_path / "x.lp", *words).exit_code == 2


def test_a_session_without_ball_frames_says_so(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"has no pictures of role ball; shoot the ball, or name its folder"):
        run(folder, "-o", tmp_path / "x.lp", "--role", "ball")
