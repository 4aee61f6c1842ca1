"""`litrig matcap split`."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from processing.command_parts import (
    JSON,
    PATH,
    PICTURES,
    FiniteRange,
    check_kept,
    check_output,
    echo_clipped,
    echo_facts,
)

if TYPE_CHECKING:
    from processing.matcap.separation.blend import Blend
    from processing.matcap.separation.separate import Form, Separation


_OPTIONS = {
    "form": "--form",
    "mask": "--mask",
    "rim_px": "--rim",
    "floor": "--floor",
    "percent": "--percentile",
    "tolerance": "--tolerance",
}


@dataclass(frozen=True)
class Separate:
    """How pictures are to be read and taken apart, as the options of a separation say."""

    form: "Form"
    mask: Path | None
    rim_px: float | None
    floor: float | None
    percent: float
    tolerance: float
    said: tuple[str, ...]
    """Which of the options were given."""

    def __call__(self, image: Path) -> "Separation":
        from processing.matcap.disc_file import read_disc
        from processing.matcap.separation.known import Ignored
        from processing.matcap.separation.separate import separate

        disc = read_disc(image, self.mask)
        return separate(
            disc.colours,
            form=self.form,
            covered=disc.covered,
            ignored=Ignored(self.rim_px, self.floor, self.percent),
            tolerance=self.tolerance,
            source=str(image),
        )

    def refuse_for_layers(self, image: Path) -> None:
        """Refuse options that would change nothing, for the layers are there."""
        from litrig.base.errors import InputError

        if self.said:
            raise InputError(f"{image}: is taken as it is, a layer or two already; leave out {', '.join(self.said)}")


def separating(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options of a separation, handed over as `separated`, which reads a picture and takes it apart."""

    @click.option(
        "--form",
        type=click.Choice(["continuous", "discrete"]),
        default="continuous",
        show_default=True,
        help="continuous: held against light from every direction. discrete: against the directions of pixels, as in "
        "the paper; darker, and the more so the smaller the picture.",
    )
    @click.option("--mask", metavar="IMAGE", type=PATH, help="What is dark in it is no data; of the picture's size.")
    @click.option(
        "--rim",
        "rim_px",
        type=FiniteRange(0, 1000),
        metavar="PX",
        help="Pixels this near to the rim are no data. By default those that a background reaches.",
    )
    @click.option(
        "--floor",
        type=FiniteRange(0, 1e6),
        metavar="V",
        help="Values up to this, in linear light, hold nothing down. One black pixel blackens half a sphere: 0 lets "
        "black ink pass.",
    )
    @click.option(
        "--percentile",
        "percent",
        type=FiniteRange(0, 100, max_open=True),
        default=0.0,
        metavar="P",
        help="Nor do the darkest P of a hundred pixels of each channel.",
    )
    @click.option(
        "--tolerance",
        type=FiniteRange(0, 1),
        default=1e-4,
        show_default=True,
        metavar="SHARE",
        help="How exact the continuous form is, in parts of the brightest value. 0 takes the longer, the smoother the "
        "picture.",
    )
    @wraps(command)
    def with_separation(*args: Any, **options: Any) -> Any:
        source = click.get_current_context().get_parameter_source
        said = tuple(name for key, name in _OPTIONS.items() if source(key) is ParameterSource.COMMANDLINE)
        separated = Separate(**{key: options.pop(key) for key in _OPTIONS}, said=said)
        return command(*args, separated=separated, **options)

    return with_separation


@click.command(epilog="Example: litrig matcap split clay.png -o clay.low.png clay.high.png")
@click.argument("image", metavar="IMAGE", type=PATH)
@click.option(
    "-o",
    "--output",
    "outputs",
    metavar="LOW HIGH",
    nargs=2,
    type=PATH,
    required=True,
    help="What to write: .exr keeps linear light as it is; .png, .jpg and .tif hold 8 bits.",
)
@click.option(
    "--blend",
    type=click.Choice(["add", "screen", "lighten"]),
    default="add",
    show_default=True,
    help="How HIGH over LOW makes IMAGE again, in linear light: sum, 1 − (1 − LOW)(1 − HIGH), or the brighter one.",
)
@JSON
@separating
def split(image: Path, outputs: tuple[Path, Path], blend: "Blend", as_json: bool, separated: Separate) -> None:
    """Split a MatCap into low and high frequencies, akin to diffuse light and gloss.

    IMAGE is square, the disc inscribed in it; what lies outside, and what is not opaque, is no data. LOW is the
    brightest matt shading that fits under it.
    """
    from processing.matcap.disc_file import write_layers

    for output in outputs:
        check_output(output, *PICTURES)
    check_kept(outputs, [image])
    separation = separated(image)
    whole = (separation.low + separation.high).astype("float32")
    echo_clipped(outputs[0], whole)
    write_layers(*outputs, separation.low, whole, blend)
    total = float(whole.sum())
    echo_facts(
        {
            "low": str(outputs[0]),
            "high": str(outputs[1]),
            "size": len(whole),
            "pixels": int(separation.known.sum()),
            "share_of_light_in_low": round(float(separation.low.sum()) / total, 4) if total else 0.0,
        },
        as_json,
    )
