"""`litrig matcap info`: what a decomposed MatCap is."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from processing.command_parts import JSON, PATH

if TYPE_CHECKING:
    from processing.matcap.model import Component


@click.command(epilog="Example: litrig matcap info gold.matcap.exr")
@click.argument("file", metavar="X.matcap.exr", type=PATH)
@JSON
def info(file: Path, as_json: bool) -> None:
    """Say what a decomposed MatCap holds: material, turn of the light, and what was added."""
    from processing.matcap.matcap_exr import read_matcap
    from processing.matcap.meaning import Meaning

    matcap = read_matcap(file)
    size = matcap.low.front.shape[0]
    if as_json:
        facts = Meaning.of(matcap).model_dump(mode="json")
        facts["map_size"] = size
        for which, component in (("low", matcap.low), ("high", matcap.high)):
            facts[which]["highlight"] = _highlight(component)
        click.echo(json.dumps(facts))
        return
    side = "unknown" if matcap.picture_size is None else f"{matcap.picture_size} × {matcap.picture_size} pixels"
    click.echo(f"{file}: maps of {size} × {size} texels, picture {side}, table normal {matcap.table_normal}")
    for which, component in (("low", matcap.low), ("high", matcap.high)):
        click.echo("\n".join(_lines(which, component)))
    if matcap.source:
        click.echo(f"source {matcap.source}")


def _lines(which: str, component: "Component") -> list[str]:
    colour = " ".join(f"{channel:.4g}" for channel in component.base_colour)
    sigma_deg = component.filter_size**0.5 * 57.29577951308232
    lines = [
        f"{which}: base colour {colour}, filter size {component.filter_size:.4g} rad² ({sigma_deg:.3g} deg), "
        f"slope {component.slope:.4g}"
    ]
    silhouette = component.silhouette
    if silhouette.rise or silhouette.slope:
        lines.append(
            f"  silhouette from {silhouette.start_deg:g} deg, rise {silhouette.rise:g}, slope {silhouette.slope:g}"
        )
    for name, turn in (("light", component.light_turn_deg), ("normals", component.normal_turn_deg)):
        if any(turn):
            lines.append(f"  {name} turned about {' '.join(f'{part:.4g}' for part in turn)} (axis by degrees)")
    lines += [f"  light: {light.shape}" for light in component.lights]
    lines += [f"  picture: {hung.picture.name or 'without a name'}" for hung in component.pictures]
    x, y, z = _highlight(component)
    lines.append(f"  main highlight from {x:+.3f} {y:+.3f} {z:+.3f}")
    return lines


def _highlight(component: "Component") -> Any:
    from processing.matcap.highlight import main_highlight
    from processing.matcap.render import turned

    direction = turned(main_highlight(component)[None], component.light_turn_deg)[0]
    return [float(part) for part in direction]
