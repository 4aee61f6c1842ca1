"""`litrig ptm lights`: light directions from mirror balls."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple

import click

from processing.command_parts import FOLDER, JSON, PATH, check_folder, check_output

if TYPE_CHECKING:
    from litrig.base.capture_folder.capture import CapturedFrame
    from processing.ptm.lights.estimate import Ways

DETECTIONS = ".detections.toml"


class _Frames(NamedTuple):
    balls: "list[CapturedFrame]"
    objects: "list[CapturedFrame]"
    folder: Path
    ball_folder: Path


@click.command(epilog="Example: litrig ptm lights coin -o coin/coin.lp --report coin.report")
@FOLDER
@click.option("-o", "--output", metavar="X.lp", type=PATH, required=True, help="The list of directions to write.")
@click.option(
    "--ball",
    "circles",
    type=float,
    nargs=3,
    multiple=True,
    metavar="X Y R",
    help="A ball's outline in pixels, from the upper left corner; once for each ball.",
)
@click.option(
    "--distance",
    type=float,
    metavar="RADII",
    help="Camera to the first ball's centre, in its radii; the camera is taken to aim at the picture's centre.",
)
@click.option(
    "--camera", type=PATH, metavar="CAMERA.toml", help="Calibrated camera: gives the perspective, takes out distortion."
)
@click.option(
    "--balls",
    "ball_folder",
    type=PATH,
    metavar="FOLDER2",
    help="The balls were photographed apart, under the same lights: their pictures.",
)
@click.option(
    "--role",
    type=click.Choice(["frame", "ball"]),
    default="frame",
    show_default=True,
    help="Which frames of a capture folder show the balls.",
)
@click.option("--edits", type=PATH, metavar="EDITS.toml", help="Detections to replay, moved or dropped by hand.")
@click.option("--report", "report_folder", type=PATH, metavar="DIR", help="Write a page that shows every detection.")
@JSON
def lights(
    folder: Path,
    output: Path,
    circles: tuple[tuple[float, float, float], ...],
    distance: float | None,
    camera: Path | None,
    ball_folder: Path | None,
    role: Literal["frame", "ball"],
    edits: Path | None,
    report_folder: Path | None,
    as_json: bool,
) -> None:
    """Find the light of every picture in FOLDER from the mirror balls in it, and write an .lp list.

    Balls and highlights are found by themselves. What was found is written to X.detections.toml beside the list; copy
    that, move or drop what is wrong, and give it back with --edits. Without --distance and --camera the pictures count
    as orthographic.

    A ball that was photographed once, before the object, is named by --balls or --role ball: its lights go to the
    pictures of the same name, else of the same commanded light, else in the same order.
    """
    from litrig.base.console import reporting
    from litrig.base.lp import write_lp
    from processing.ptm.lights.carry import carry, match_frames
    from processing.ptm.lights.edits import write_detections
    from processing.ptm.lights.estimate import estimate_lights
    from processing.ptm.lights.report import describe, facts
    from processing.ptm.lights.report_page import write_report

    if distance is not None and camera is not None:
        raise click.UsageError("--distance and --camera both say how far the camera stands; give one")
    if ball_folder is not None and role == "ball":
        raise click.UsageError("--balls and --role ball both say where the balls are; give one")
    check_output(output, ".lp")
    if report_folder is not None:
        check_folder(report_folder)
    frames = _read_frames(folder, ball_folder, role, output)
    ways = _ways(frames, circles, distance, camera, edits)
    places, rule = match_frames(*frames) if frames.objects else ([], "")
    with reporting() as report:
        session = estimate_lights([frame.path for frame in frames.balls], ways, report)
    found = session.directions()
    if frames.objects:
        found = carry(found, frames.balls, frames.objects, places)
    write_lp(output, found)
    detections = output.with_name(output.stem + DETECTIONS)
    if edits is None or edits.absolute() != detections.absolute():
        write_detections(detections, session.balls, session.frames(), _replay(folder, output))
    page = None if report_folder is None else write_report(report_folder, session)
    if as_json:
        click.echo(json.dumps({**facts(session), "carried": rule or None, "names": list(found.names or ())}))
        return
    for line in describe(session):
        click.echo(line)
    if rule:
        click.echo(f"carried from {frames.ball_folder} to {len(found)} pictures of {folder}, {rule}")
    click.echo(f"{output}: {len(found)} lights; detections in {detections}")
    if page is not None:
        click.echo(f"{page}: every detection")


def _replay(folder: Path, output: Path) -> str:
    return f"litrig ptm lights {folder} -o {output} --edits EDITS.toml"


def _read_frames(folder: Path, ball_folder: Path | None, role: str, output: Path) -> _Frames:
    """Tell the pictures of balls from those of the object; the latter are none where they are the same."""
    from litrig.base.capture_folder.capture import Role
    from litrig.base.capture_folder.reader import read_capture
    from litrig.base.errors import InputError

    capture = read_capture(folder, but_not=output)
    objects = list(capture.having(Role.FRAME))
    if ball_folder is not None:
        other = read_capture(ball_folder, but_not=output)
        balls = list(other.having(Role.BALL)) or list(other.having(Role.FRAME))
    elif role == "ball":
        balls = list(capture.having(Role.BALL))
    else:
        balls, objects = objects, []
    if not balls:
        raise InputError(f"{ball_folder or folder}: has no pictures of role {role}; shoot the ball, or name its folder")
    return _Frames(balls, objects, folder, ball_folder or folder)


def _ways(
    frames: _Frames,
    circles: tuple[tuple[float, float, float], ...],
    distance: float | None,
    camera: Path | None,
    edits: Path | None,
) -> "Ways":
    from litrig.base.camera_model import read_camera_model
    from processing.outline.circle import Circle
    from processing.ptm.lights.edits import read_edits
    from processing.ptm.lights.estimate import Ways

    names = [frame.path.name for frame in frames.balls]
    read = None if edits is None else read_edits(edits, names, frames.ball_folder)
    if circles and read is not None and read.ball:
        raise click.UsageError(f"--ball and {edits} both name the balls; leave one out")
    return Ways(
        circles=tuple(Circle(*circle) for circle in circles),
        camera=None if camera is None else read_camera_model(camera),
        distance_radii=distance,
        edits=read,
    )
