"""Edits of shape as options of a command, and the recipe that they make."""

from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from processing.command_parts import PATH, Finite, FiniteRange

if TYPE_CHECKING:
    from processing.shape.editing.operations import Bump, Recipe


_ANY, _POSITIVE, _NOT_NEGATIVE = Finite(), FiniteRange(0, min_open=True), FiniteRange(0)
_OPTIONS = (
    click.option("--recipe", metavar="RECIPE", type=PATH, help="Carry out a .recipe.toml first."),
    click.option(
        "--normals",
        metavar="IMAGE",
        type=PATH,
        help="Take normals made elsewhere: EXR of signed components, or PNG or TIFF in which 0 to 1 is −1 to 1.",
    ),
    click.option(
        "--detail", metavar="IMAGE", type=PATH, help="Add a normal map as detail; its z is the surface's own normal."
    ),
    click.option(
        "--green-down", is_flag=True, help="Green of --normals and --detail counts downwards, as DirectX has it."
    ),
    click.option("--smooth", metavar="PX", type=_POSITIVE, help="Smooth normals over this radius, within depth."),
    click.option(
        "--emboss", metavar="BETA", type=FiniteRange(0, 1, min_open=True), help="Let it bulge: 0 to 1, 1 is no change."
    ),
    click.option("--bump", metavar="IMAGE", type=PATH, help="Raise by a height map, or a decal."),
    click.option("--bump-height", metavar="L", type=_ANY, help="Height of white; 5 % of the size if left out."),
    click.option("--bump-at", metavar="COLUMN ROW", type=_ANY, nargs=2, help="Its middle; the picture's if left out."),
    click.option("--bump-size", metavar="L", type=_POSITIVE, help="Its width; the picture's if left out."),
    click.option("--bump-turn", metavar="DEG", type=_ANY, help="Turn it counter-clockwise."),
    click.option("--bump-repeat", is_flag=True, help="Lay it like tiles."),
    click.option("--noise", metavar="HEIGHT SCALE", type=(_ANY, _POSITIVE), help="Raise by noise of this scale."),
    click.option("--seed", metavar="N", type=click.IntRange(0, (1 << 32) - 1), help="Another noise."),
    click.option(
        "--ripple",
        metavar="COLUMN ROW HEIGHT LENGTH",
        type=(_ANY, _ANY, _ANY, _POSITIVE),
        help="Raise by waves around a place, that fade.",
    ),
    click.option("--fade", metavar="L", type=_POSITIVE, help="Distance over which they fade; three waves if left out."),
    click.option(
        "--across",
        type=click.Choice(["screen", "positions"]),
        default="screen",
        show_default=True,
        help="Lay reliefs over the screen, lengths in pixels, or in the scene, in its unit.",
    ),
    click.option("--displace", is_flag=True, help="Move positions by reliefs in the scene, and derive normals anew."),
    click.option("--kd", "diffuse_factor", metavar="K", type=_NOT_NEGATIVE, help="Scale diffuse shading."),
    click.option("--kr", "reflection_factor", metavar="K", type=_NOT_NEGATIVE, help="Scale reflections."),
    click.option("--mask", metavar="IMAGE", type=PATH, help="Edit where this is white."),
    click.option(
        "--surface",
        "surfaces",
        metavar="ID",
        type=click.IntRange(1),
        multiple=True,
        help="Edit this surface; can be given again.",
    ),
    click.option("--strength", metavar="S", type=FiniteRange(0, 1), help="How far to go, 0 to 1."),
)


def edit_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add options on edits, handed over as `make_recipe`.

    A recipe's edits come first; then normals, detail, smoothing, embossing, bump, noise, ripple and factors, in that
    order, to all of which mask, surfaces and strength apply.
    """
    names = [str(parameter.name) for parameter in _parameters()]

    @wraps(command)
    def told(*args: Any, **options: Any) -> Any:
        said = {name: options.pop(name) for name in names}
        _check_use(said)
        return command(*args, make_recipe=lambda: _recipe(said), **options)

    for option in reversed(_OPTIONS):
        told = option(told)
    return told


def _parameters() -> list[click.Parameter]:
    def nothing() -> None: ...

    for option in _OPTIONS:
        option(nothing)
    return list(nothing.__click_params__)  # type: ignore[attr-defined]  # click's own place for them


_NEEDS = {
    "green_down": ("normals", "detail"),
    "bump_height": ("bump",),
    "bump_at": ("bump",),
    "bump_size": ("bump",),
    "bump_turn": ("bump",),
    "bump_repeat": ("bump",),
    "seed": ("noise",),
    "fade": ("ripple",),
    "displace": ("bump", "noise", "ripple"),
}
_EDITS = ("normals", "detail", "smooth", "emboss", "bump", "noise", "ripple", "diffuse_factor", "reflection_factor")


def _check_use(said: dict[str, Any]) -> None:
    for name, others in _NEEDS.items():
        if said[name] not in (None, False) and all(said[other] is None for other in others):
            needed = " or ".join(f"--{other}" for other in others)
            raise click.UsageError(f"--{name.replace('_', '-')} is said of {needed}; give that too")
    if all(said[name] is None for name in _EDITS):
        idle = next((name for name in ("mask", "surfaces", "strength") if said[name] not in (None, ())), None)
        if idle is not None:
            raise click.UsageError(
                f"--{idle.removesuffix('s') if idle == 'surfaces' else idle} is said of an edit; give one"
            )
    if said["bump"] is not None and said["across"] == "positions" and said["bump_size"] is None:
        raise click.UsageError("a decal in the scene has a size in its unit; give --bump-size")
    if said["displace"] and said["across"] != "positions":
        raise click.UsageError("--displace moves positions; give --across positions too")


def _recipe(said: dict[str, Any]) -> "Recipe":
    """Make the recipe that the options say."""
    from processing.shape.editing import operations as op
    from processing.shape.editing.recipe_toml import read_recipe

    edits: list[op.AnyOperation] = list(read_recipe(said["recipe"]).steps) if said["recipe"] else []
    every = {
        "surfaces": said["surfaces"],
        "mask": said["mask"] and Path(said["mask"]).absolute(),
        "strength": 1.0 if said["strength"] is None else said["strength"],
    }
    relief = {**every, "across": said["across"], "displace": said["displace"]}
    green = "down" if said["green_down"] else "up"
    for name, space in (("normals", "view"), ("detail", "surface")):
        if said[name] is not None:
            edits.append(op.Painted(file=said[name].absolute(), space=space, green=green, **every))
    if said["smooth"] is not None:
        edits.append(op.Smooth(radius=said["smooth"], **every))
    if said["emboss"] is not None:
        edits.append(op.Emboss(beta=said["emboss"], **every))
    if said["bump"] is not None:
        edits.append(_bump(said, relief))
    if said["noise"] is not None:
        height, scale = said["noise"]
        edits.append(op.Noise(height=height, scale=scale, seed=said["seed"] or 0, **relief))
    if said["ripple"] is not None:
        column, row, height, length = said["ripple"]
        fade = said["fade"] or 3 * length
        edits.append(op.Ripple(at=(column, row), height=height, wavelength=length, fade=fade, **relief))
    factors = {"diffuse": said["diffuse_factor"], "reflection": said["reflection_factor"]}
    if any(factor is not None for factor in factors.values()):
        edits.append(op.Factors(**{name: 1.0 if k is None else k for name, k in factors.items()}, **every))
    return op.Recipe(steps=tuple(edits))


def _bump(said: dict[str, Any], relief: dict[str, Any]) -> "Bump":
    from processing.shape.editing.operations import Bump as BumpOperation

    return BumpOperation(
        heights=said["bump"].absolute(),
        height=said["bump_height"],
        at=said["bump_at"],
        size=said["bump_size"],
        turn_deg=said["bump_turn"] or 0.0,
        repeat=said["bump_repeat"],
        **relief,
    )
