"""`litrig amc …`: from a turn of a covered sphere to a material."""

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from processing.command_parts import (
    FOLDER,
    JSON,
    PATH,
    PICTURES,
    check_folder,
    check_output,
    echo_clipped,
    echo_facts,
    references,
)

if TYPE_CHECKING:
    from litrig.base.capture_folder.capture import Capture
    from litrig.base.progress import Report
    from processing.amc.build import AmcResult
    from processing.amc.model import Invariance
    from processing.amc.settings import Settings
    from processing.command_parts import Refer

_CIRCLE = click.option(
    "--circle", type=float, nargs=3, metavar="X Y R", help="The sphere's outline in pixels, from the upper left corner."
)
_DISTANCE = click.option(
    "--distance", type=float, metavar="RADII", help="Camera to the sphere's centre, in radii of the sphere."
)
_CAMERA = click.option(
    "--camera", type=PATH, metavar="CAMERA.toml", help="Calibrated camera: gives the distance, takes out distortion."
)
_NORMAL = click.option(
    "--normal",
    type=click.Choice(["rectified", "view", "camera"]),
    default="rectified",
    show_default=True,
    help="How a normal seen along an oblique ray is brought to the table; matters in perspective alone.",
)


def _parse_invariance(_context: click.Context, _option: click.Parameter, word: str) -> "str | int":
    if word in ("auto", "isotropic"):
        return word
    if not re.fullmatch("[0-9]{1,3}", word):
        raise click.BadParameter(f"{word!r} is neither auto, isotropic nor a whole number of up to three digits")
    return int(word)


def _refuse_two_distances(distance: float | None, camera: Path | None) -> None:
    if distance is not None and camera is not None:
        raise click.UsageError("--distance and --camera both say how far the camera stands; give one")


def _refuse_rank(output: Path, rank: int | None) -> None:
    if rank is not None and not output.name.lower().endswith(".exr"):
        raise click.UsageError("--rank is for a low-rank table; name the output X.amc.exr")


@click.group()
def amc() -> None:
    """Make Anisotropic MatCaps: the look of a material in one lighting, from a turn of a covered sphere."""


@amc.command(epilog="Example: litrig amc build brushed-session -o brushed.amc.ktx2")
@FOLDER
@click.option(
    "-o",
    "--output",
    metavar="X.amc.ktx2",
    type=PATH,
    required=True,
    help="The file to write: .amc.ktx2, or .amc.exr for a low-rank table.",
)
@click.option("--size", type=int, default=128, show_default=True, help="Texels along each side of a slice.")
@click.option("--depth", type=int, metavar="D", help="Slices to store; by default the captured ones divided by R.")
@click.option("--rank", type=click.IntRange(1), metavar="N", help="Most pictures of a low-rank table. [12]")
@click.option(
    "--invariance",
    metavar="auto|isotropic|N",
    callback=_parse_invariance,
    default="auto",
    show_default=True,
    help="How often the material repeats in a turn, R: most cloth and brushed metal do twice. auto finds it.",
)
@click.option(
    "--threshold", type=float, metavar="T", help="For auto: the share of change, 0..1, that may contradict an R. [0.05]"
)
@click.option("--repeats-up-to", type=int, metavar="N", help="For auto: the largest R to try. [4]")
@_CIRCLE
@_DISTANCE
@_CAMERA
@_NORMAL
@click.option(
    "--tangent-zero",
    type=float,
    metavar="DEG",
    help="Direction of brushing or thread at turntable zero; by default what the session says.",
)
@click.option(
    "--tangent-angle",
    type=click.Choice(["picture", "surface"]),
    help="What a slice stands for: the angle of the tangent's picture, or its angle in the surface. By default the "
    "picture's, except for an R of 3 or more, which is exact in the surface alone.",
)
@click.option("--clockwise", is_flag=True, help="The turntable's angles count clockwise as the camera sees it.")
@click.option(
    "--even", is_flag=True, help="Pictures without angles are spread evenly over one turn, in the order of their names."
)
@click.option(
    "--mask", type=PATH, metavar="IMAGE", help="White where the first picture shows no material; followed round."
)
@click.option(
    "--defects",
    type=click.Choice(["find", "ignore"]),
    default="find",
    show_default=True,
    help="Look for folds, cuts and hot pixels, and fill them from what else was seen.",
)
@click.option(
    "--weave",
    type=click.Choice(["keep", "average"]),
    default="keep",
    show_default=True,
    help="Texture that turns with the sample: keep it, or average it out.",
)
@click.option("--split", is_flag=True, help="Write X.low.amc.ktx2 and X.high.amc.ktx2: diffuse light apart from gloss.")
@click.option(
    "--unlit",
    type=PATH,
    metavar="FOLDER",
    help="The same turn without the key light: also write X.unlit.amc.ktx2, for shadows.",
)
@click.option(
    "--report", "report_folder", type=PATH, metavar="DIR", help="Write a page about the build, DIR/index.html."
)
@click.option(
    "--under",
    type=(float, float),
    metavar="AZIMUTH ELEVATION",
    help="Of a session under many lights, the one to build from, in degrees.",
)
@references
@JSON
def build(
    folder: Path,
    output: Path,
    rank: int | None,
    even: bool,
    mask: Path | None,
    split: bool,
    unlit: Path | None,
    report_folder: Path | None,
    under: tuple[float, float] | None,
    refer: "Refer",
    as_json: bool,
    **choices: Any,
) -> None:
    """Build an Anisotropic MatCap from FOLDER.

    FOLDER is a capture folder, or holds pictures and an angles.csv with a line `name,deg` for each. The sphere is
    found by itself; what was found is printed.
    """
    from litrig.base.capture_folder.reader import unnamed_pictures
    from litrig.base.console import reporting
    from processing.amc.files.either import ENDINGS, beside, write_any
    from processing.amc.report import describe, facts

    _refuse_two_distances(choices["distance"], choices["camera"])
    if split and unlit is not None:
        raise click.UsageError("--split and --unlit make pairs of their own; give one")
    check_output(output, *ENDINGS)
    _refuse_rank(output, rank)
    if report_folder is not None:
        check_folder(report_folder)
    settings = _settings(**choices)
    with reporting() as report:
        folders = {"": folder} if unlit is None else {"": folder, "unlit": unlit}
        turns = {name: _read_turn(turn, even, under, refer) for name, turn in folders.items()}
        results = _results(turns, mask, split, settings, report)
        paths = {name: beside(output, name) for name in results}
        for name, result in results.items():
            write_any(paths[name], result.amc, rank=rank)
        if report_folder is not None:
            from processing.amc.report_page import write_report

            write_report(report_folder, results)
    left_out = {str(turn.folder): names for turn in turns.values() if (names := unnamed_pictures(turn))}
    if as_json:
        tables = [{"file": str(paths[name]), **facts(results[name])} for name in results]
        echo_facts({"tables": tables, "left_out": left_out}, as_json)
        return
    for turn_folder, names in left_out.items():
        click.echo(
            f"{turn_folder}: {len(names)} pictures are not named in its list of angles, and left out: {names[0]} …"
        )
    for name, result in results.items():
        for line in describe(result):
            click.echo(line)
        depth, height, width, _ = result.amc.slices.shape
        click.echo(f"{paths[name]}: {depth} {'slice' if depth == 1 else 'slices'} of {width} × {height}")


def _results(
    turns: "dict[str, Capture]", mask_path: Path | None, split: bool, settings: "Settings", report: "Report"
) -> "dict[str, AmcResult]":
    """Build one table or two, by what stands between name and ending of their files."""
    from processing.amc.build import build, build_split, build_unlit
    from processing.amc.flaws.mask import read_mask

    mask = None if mask_path is None else read_mask(mask_path)
    if split:
        return dict(zip(("low", "high"), build_split(turns[""], settings, mask=mask, report=report), strict=True))
    results = {"": build(turns[""], settings, mask=mask, report=report)}
    if "unlit" in turns:
        results["unlit"] = build_unlit(results[""], turns["unlit"], settings, mask=mask, report=report)
    return results


def _settings(
    size: int,
    depth: int | None,
    invariance: 'Literal["auto"] | Invariance',
    threshold: float | None,
    repeats_up_to: int | None,
    circle: tuple[float, float, float] | None,
    distance: float | None,
    camera: Path | None,
    normal: str,
    tangent_zero: float | None,
    tangent_angle: str | None,
    clockwise: bool,
    defects: Literal["find", "ignore"],
    weave: Literal["keep", "average"],
) -> "Settings":
    from litrig.base.camera_model import read_camera_model
    from litrig.base.table_normals import TableNormal
    from processing.amc.invariance import MOST_REPEATS, THRESHOLD
    from processing.amc.model import TangentAngle
    from processing.amc.settings import Settings
    from processing.outline.circle import Circle

    return Settings(
        size=size,
        depth=depth,
        invariance=invariance,
        threshold=THRESHOLD if threshold is None else threshold,
        most_repeats=MOST_REPEATS if repeats_up_to is None else repeats_up_to,
        circle=None if circle is None else Circle(*circle),
        distance_radii=distance,
        camera=None if camera is None else read_camera_model(camera),
        table_normal=TableNormal(normal),
        tangent_angle=None if tangent_angle is None else TangentAngle(tangent_angle),
        tangent_zero_deg=tangent_zero,
        clockwise=clockwise,
        weave=weave,
        defects=defects,
    )


def _read_turn(folder: Path, even: bool, under: tuple[float, float] | None, refer: "Refer") -> "Capture":
    from litrig.base.capture_folder.reader import read_capture, turn_evenly
    from litrig.base.capture_folder.select import under_one_light
    from litrig.base.directions import direction_from_angles

    light = None if under is None else direction_from_angles(*under)
    capture = refer(under_one_light(read_capture(folder), light))
    return turn_evenly(capture) if even else capture


@amc.command(name="info", epilog="Example: litrig amc info brushed.amc.ktx2 --json")
@click.argument("file", metavar="X", type=PATH)
@JSON
def amc_info(file: Path, as_json: bool) -> None:
    """Say what an Anisotropic MatCap file holds and what it was made from."""
    from processing.amc.files.either import describe_file

    echo_facts(describe_file(file), as_json)


@amc.command(epilog="Example: litrig amc convert brushed.amc.ktx2 brushed.amc.exr --rank 10")
@click.argument("source", metavar="A", type=PATH)
@click.argument("output", metavar="B", type=PATH)
@click.option("--rank", type=click.IntRange(1), metavar="N", help="Pictures of a low-rank table. [12]")
def convert(source: Path, output: Path, rank: int | None) -> None:
    """Turn a table into a low-rank one, X.amc.exr, or back into X.amc.ktx2."""
    import numpy as np

    from processing.amc.files.either import ENDINGS, read_any, write_any

    check_output(output, *ENDINGS)
    _refuse_rank(output, rank)
    table = read_any(source)
    write_any(output, table, rank=rank)
    lost = np.abs(read_any(output).slices - table.slices)[table.valid]
    click.echo(
        f"{output}: {output.stat().st_size:,} bytes, from {source.stat().st_size:,}; off by {lost.max():.2g} at most"
    )


@amc.command(epilog="Example: litrig amc isotropic satin.amc.ktx2 -o satin.png")
@click.argument("file", metavar="X", type=PATH)
@click.option("-o", "--output", metavar="IMAGE", type=PATH, required=True, help="PNG, JPEG, TIFF or EXR to write.")
def isotropic(file: Path, output: Path) -> None:
    """Average an Anisotropic MatCap over all tangents: the isotropic MatCap that differs least from it."""
    from litrig.base.pictures import write_picture
    from processing.amc.files.either import read_any
    from processing.amc.isotropic import isotropic_matcap

    check_output(output, *PICTURES)
    picture = isotropic_matcap(read_any(file))
    write_picture(output, picture)
    echo_clipped(output, picture)
    click.echo(f"{output}: {picture.shape[1]} × {picture.shape[0]} pixels")


@amc.command(epilog="Example: litrig amc matcap brass-ball.jpg -o brass.png --distance 9")
@click.argument("photo", metavar="PHOTO", type=PATH)
@click.option("-o", "--output", metavar="IMAGE", type=PATH, required=True, help="PNG, JPEG, TIFF or EXR to write.")
@click.option("--size", type=click.IntRange(4, 2048), default=512, show_default=True, help="Pixels along each side.")
@_CIRCLE
@_DISTANCE
@_CAMERA
@_NORMAL
def matcap(
    photo: Path,
    output: Path,
    size: int,
    circle: tuple[float, float, float] | None,
    distance: float | None,
    camera: Path | None,
    normal: str,
) -> None:
    """Make an isotropic MatCap from one photograph of a ball.

    The ball is found by itself; its disc fills the picture that is written.
    """
    from litrig.base.camera_model import read_camera_model
    from litrig.base.pictures import write_picture
    from litrig.base.table_normals import TableNormal
    from processing.amc.geometry import SphereView
    from processing.amc.photo import find_ball, matcap_from_photo
    from processing.outline.circle import Circle
    from processing.stack import Stack
    from processing.undistort import undistortion

    _refuse_two_distances(distance, camera)
    check_output(output, *PICTURES)
    lens = None if camera is None else read_camera_model(camera)
    picture = Stack([photo], undistortion(lens)).linear(0)
    height, width, _ = picture.shape
    ball = find_ball(picture, str(photo)) if circle is None else Circle(*circle).inside((height, width), str(photo))
    if lens is not None:
        distance = lens.sphere_distance_radii(ball.radius_px)
    made = matcap_from_photo(picture, ball, SphereView(TableNormal(normal), distance), size)
    write_picture(output, made.colours)
    echo_clipped(output, made.colours)
    click.echo(f"ball: {ball}")
    click.echo(f"{output}: {size} × {size} pixels")
