"""The oracle of turned light: MatCaps of rendered spheres against renders in turned surroundings, and of parts."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from litrig.base.pictures import write_picture
from processing.matcap.disc import disc_normals
from processing.matcap.separation.separate import Form
from tests.oracle.shoot import Studio
from tests.oracle.turned_light import (
    ANGLES_DEG,
    BALLS,
    F32,
    Axis,
    Quality,
    ball,
    errors,
    layers_and_parts,
    noise,
    separation,
    taken_apart,
    turned,
)

AXES: tuple[Axis, ...] = ("y", "x")
FORMS: tuple[Form, ...] = ("continuous", "discrete")
ALPHAS = (0.06, 0.12, 0.25)
TURNS_PICTURE, PARTS_PICTURE = "matcap-turned.png", "matcap-parts.png"
_GAP_PX, _DRAWN_PX = 4, 160
_BRIGHTER = np.float32(2)
"""What is drawn of plastic, which is dark."""


def quality_of(studio: Studio) -> Quality:
    """Return what the studio affords for a picture that is taken apart."""
    return Quality(studio.variant, studio.side_px, 2 * studio.samples)


def filters(studio: Studio) -> str:
    """Say what filters are estimated."""
    lines = [
        "| ball | ν high | μ high | α²/2 of its microfacets |",
        "| --- | --- | --- | --- |",
    ]
    for name, material in BALLS.items():
        high = taken_apart(quality_of(studio), name).high
        numbers = (high.filter_size, high.slope, material["alpha"] ** 2 / 2)
        lines.append(f"| {name} | " + " | ".join(f"{number:.4f}" for number in numbers) + " |")
    return "\n".join(lines)


def turns(studio: Studio) -> str:
    """Turn the light of every ball about both axes."""
    lines = ["| ball | turn | light turned | picture turned | mirrored hemisphere | noise of the truth |"]
    lines.append("| --- |" + " --- |" * 5)
    quality = quality_of(studio)
    for name in BALLS:
        floor = noise(quality, name)
        for axis in AXES:
            for angle_deg in ANGLES_DEG:
                found = errors(quality, name, turned(quality, name, axis, angle_deg))
                figures = " | ".join(f"{error:.3f}" for error in (*found, floor))
                lines.append(f"| {name} | {axis}, {angle_deg:.0f}° | {figures} |")
    return "\n".join(lines)


def parts(studio: Studio) -> str:
    """Compare low and high frequencies with diffuse and specular light."""
    heads = ("low", "whole", "mean of low", "high", "whole", "mean of high", "correlation")
    lines = ["| roughness | form | " + " | ".join(heads) + " |", "| --- | --- |" + " --- |" * len(heads)]
    for alpha in ALPHAS:
        for form in FORMS:
            figures = " | ".join(f"{figure:.3f}" for figure in separation(quality_of(studio), alpha, form))
            lines.append(f"| {alpha:g} | {form} | {figures} |")
    return "\n".join(lines)


def draw(studio: Studio, folder: Path) -> None:
    """Draw the spheres: in the manner of the MatCap paper's figures 12 and 8."""
    quality = quality_of(studio)._replace(side_px=_DRAWN_PX)
    names, angle_deg = ("gold", "plastic"), 60.0
    rows = [[ball(quality, name).picture, *turned(quality, name, axis, angle_deg)] for name in names for axis in AXES]
    write_picture(folder / TURNS_PICTURE, _sheet(rows))
    parts = [list(layers_and_parts(quality, alpha, "continuous")) for alpha in ALPHAS[1:]]
    write_picture(folder / PARTS_PICTURE, _sheet([[_BRIGHTER * part for part in row] for row in parts]))


def _sheet(rows: list[list[F32]]) -> F32:
    def joined(pictures: list[F32], axis: int) -> Iterator[F32]:
        for index, picture in enumerate(pictures):
            if index:
                shape = list(picture.shape)
                shape[axis] = _GAP_PX
                yield np.zeros(shape, np.float32)
            yield picture

    _, inside = disc_normals(len(rows[0][0]))
    discs = [[picture * inside[..., None] for picture in row] for row in rows]
    lines = [np.concatenate(list(joined(row, 1)), axis=1) for row in discs]
    return np.concatenate(list(joined(lines, 0)), axis=0)
