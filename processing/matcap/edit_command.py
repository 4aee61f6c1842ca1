"""`litrig matcap edit`: light and material of a decomposed MatCap changed."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from processing.command_parts import PATH, PICTURES, check_output

if TYPE_CHECKING:
    from processing.matcap.recipe.operations import Operation

_WHICH = click.Choice(["low", "high", "both"])
_NUMBERS = 3


@click.command(
    epilog="\b\nExample: litrig matcap edit gold.matcap.exr -o turned.png --rotate y 30\n"
    "Example: litrig matcap edit gold.matcap.exr -o matt.matcap.exr --roughness 20 --save-recipe matt.recipe.toml"
)
@click.argument("file", metavar="X.matcap.exr", type=PATH)
@click.option(
    "-o",
    "--output",
    metavar="Y",
    type=PATH,
    required=True,
    help="Y.matcap.exr for the edited MatCap; any other picture ending for its ball, at the source's size.",
)
@click.option("--recipe", "recipes", metavar="R", type=PATH, multiple=True, help="Steps to do first, X.recipe.toml.")
@click.option(
    "--rotate",
    metavar="AXIS DEG",
    type=(str, float),
    multiple=True,
    help="Turn the light about x, y, z or an axis like 1,1,0, counter-clockwise seen against it.",
)
@click.option(
    "--rotate-normals",
    metavar="AXIS DEG",
    type=(str, float),
    multiple=True,
    help="The same for the normals before warping, as the paper words it: where nothing new comes into view, the "
    "picture turns.",
)
@click.option(
    "--align", metavar="FILE", type=PATH, help="Turn the light so that the main highlight is where FILE's is."
)
@click.option(
    "--align-at", metavar="X Y", type=(float, float), help="Turn the light so that the main highlight is seen there."
)
@click.option("--take-low", metavar="FILE", type=PATH, help="Take the low frequencies of another MatCap.")
@click.option("--take-high", metavar="FILE", type=PATH, help="Take the high frequencies of another MatCap.")
@click.option(
    "--roughness",
    metavar="DEG",
    type=float,
    help="New filter size of the high frequencies, as its standard deviation; litrig matcap info tells the old one.",
)
@click.option("--low-roughness", metavar="DEG", type=float, help="The same of the low frequencies.")
@click.option(
    "--colour", metavar="R G B", type=(float, float, float), help="Base colour, linear, of the --colour-of component."
)
@click.option("--hue", metavar="DEG", type=float, default=0.0, help="Turn the base colour's hue.")
@click.option("--saturation", metavar="F", type=float, default=1.0, help="Scale the base colour's saturation.")
@click.option("--value", metavar="F", type=float, default=1.0, help="Scale the base colour's value.")
@click.option("--colour-of", type=_WHICH, default="both", show_default=True, help="Whose base colour is changed.")
@click.option("--gain", metavar="LOW HIGH", type=(float, float), help="Scale the two components.")
@click.option(
    "--silhouette",
    metavar="START RISE SLOPE",
    type=(float, float, float),
    help="Add to the base colour from START degrees off the view axis on, up to RISE at the silhouette, arriving with "
    "SLOPE a radian.",
)
@click.option("--silhouette-of", type=_WHICH, default="both", show_default=True, help="Who gets the silhouette.")
@click.option(
    "--paint",
    metavar="X Y DEG R G B",
    type=(float, float, float, float, float, float),
    multiple=True,
    help="Add a Gaussian reflection to the high frequencies, seen at X, Y on the ball (−1..1), as wide as DEG in the "
    "light. Recipes have discs, lines, edges and pictures too.",
)
@click.option("--save-recipe", metavar="R", type=PATH, help="Write all steps that were done as X.recipe.toml.")
def edit(file: Path, output: Path, recipes: tuple[Path, ...], save_recipe: Path | None, **options: Any) -> None:
    """Change the light and the material of a decomposed MatCap.

    Recipes come first, then options in the order of this list. Without any, a picture is the one that was taken apart.
    """
    from litrig.base.console import reporting
    from processing.matcap.matcap_exr import ENDING, read_matcap, write_matcap
    from processing.matcap.picture_file import write_disc
    from processing.matcap.recipe.apply import apply_recipe
    from processing.matcap.recipe.recipe_toml import Recipe, read_recipe, rebased, write_recipe
    from processing.recipe_toml import ENDING as RECIPE_ENDING

    check_output(output, ENDING, *PICTURES)
    if save_recipe is not None:
        check_output(save_recipe, RECIPE_ENDING)
    wanted = [(read_recipe(path), path.parent, str(path)) for path in recipes]
    wanted.append((Recipe(steps=_steps(options)), Path(), str(file)))
    matcap = read_matcap(file)
    with reporting() as report:
        for recipe, folder, source in wanted:
            matcap = apply_recipe(matcap, recipe, folder, source, report)
    if output.name.lower().endswith(ENDING):
        write_matcap(output, matcap)
    else:
        write_disc(output, matcap)
    count = sum(len(recipe.steps) for recipe, _, _ in wanted)
    if save_recipe is not None:
        moved = [step for recipe, folder, _ in wanted for step in rebased(recipe, folder, save_recipe.parent).steps]
        write_recipe(save_recipe, Recipe(steps=tuple(moved)))
    click.echo(f"{output}: {count} {'step' if count == 1 else 'steps'} on {file}")


def _steps(options: dict[str, Any]) -> "tuple[Operation, ...]":
    """Make operations of what was typed."""
    from pydantic import ValidationError

    from processing.matcap.recipe.operations import (
        Align,
        Colour,
        Gain,
        One,
        Outline,
        Paint,
        Rotate,
        Roughness,
        Take,
        Turns,
        Which,
    )

    steps: list[Operation] = []
    try:
        for one, name in ((One.LOW, "take_low"), (One.HIGH, "take_high")):
            if options[name] is not None:
                steps.append(Take(component=one, from_file=str(options[name])))
        for name, turns in (("rotate", Turns.LIGHT), ("rotate_normals", Turns.NORMALS)):
            steps += [Rotate(axis=_axis(axis), degrees=degrees, turns=turns) for axis, degrees in options[name]]
        if options["align"] is not None:
            steps.append(Align(to_file=str(options["align"])))
        if options["align_at"] is not None:
            steps.append(Align(at=options["align_at"]))
        for which, name in ((Which.HIGH, "roughness"), (Which.LOW, "low_roughness")):
            if options[name] is not None:
                steps.append(Roughness(component=which, degrees=options[name]))
        colour = Colour(
            component=Which(options["colour_of"]),
            base_colour=options["colour"],
            hue_deg=options["hue"],
            saturation=options["saturation"],
            value=options["value"],
        )
        if colour != Colour(component=colour.component):
            steps.append(colour)
        if options["gain"] is not None:
            low, high = options["gain"]
            steps.append(Gain(low=low, high=high))
        if options["silhouette"] is not None:
            start, rise, slope = options["silhouette"]
            which = Which(options["silhouette_of"])
            steps.append(Outline(component=which, start_deg=start, rise=rise, slope=slope))
        for x, y, size, *colours in options["paint"]:
            red, green, blue = colours
            steps.append(Paint(at=(x, y), size_deg=size, colour=(red, green, blue)))
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        told = f"{place}: {first['msg']}" if place else first["msg"]
        raise click.UsageError(told.replace("Value error, ", "")) from error
    return tuple(steps)


def _axis(text: str) -> Any:
    if text in ("x", "y", "z"):
        return text
    try:
        parts = tuple(float(part) for part in text.split(","))
    except ValueError:
        parts = ()
    if len(parts) != _NUMBERS or not all(map(math.isfinite, parts)):
        raise click.UsageError(f"{text!r} is no axis; give x, y, z or three numbers like 1,1,0")
    return parts
