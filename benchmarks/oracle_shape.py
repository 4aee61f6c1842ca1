"""The oracle of shape editing: environments, edited pictures, reflections of neighbours, as Markdown and pictures."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from firmware_sim.mitsuba.variants import FAST
from litrig.base.contact_sheet import contact_sheet
from litrig.base.pictures import read_codes, write_codes
from litrig.base.radiometry import encode_srgb, to_u8
from tests.oracle.shape_measure import (
    POSES,
    RED,
    TABLE_TOP,
    Ball,
    Edit,
    Quality,
    edit,
    neighbours,
    on_a_floor,
    rebuilt,
    residuals,
)
from tests.oracle.shape_scenes import Probe

U8 = NDArray[np.uint8]
SIDE_PX, SAMPLES, MANY_SAMPLES = 128, 256, 1024
PROBES: tuple[Probe, ...] = get_args(Probe)
BOOST = 4.0
NO_LLVM = "Not measured: without LLVM these pictures take hours."
TEXT = """\
Pictures are of {side} × {side} pixels with {samples} samples a pixel, {many_samples} in the first two sections, with
all the noise that this leaves. mitsuba does not tell diffuse from reflected light; an integrator of ours does so by the
lobes of the first surface that the camera sees, and follows the paths from there with mitsuba's own. It also tells
which share of a lobe's rays meets the thing itself, as occlusion, and the normals with their bumps. The buffers are
files that mitsuba writes; all editing is by `litrig shape reconstruct` and `recompose`.

### Environments

A thing half matt and half metal (GGX, roughness .12) is lit by a soft sky or by a room with windows, and nothing
shadows it or mirrors in it, as in the paper's figure 6. The truth is a ball of the same material, seen from far away.
Figures are RMS errors relative to the truth's RMS, over the whole ball and over what the thing's pixels tell of it; on
such a ball all mirrored directions have equal areas.

{environments}

![Environments](pictures/oracle-shape-environments.jpg)

A row each: the thing; diffuse light on the ball, reconstructed, and the difference, {boost:g} times; the same for
reflected light.

### Diffuse light in shadow

The same things of white plastic, with their own shadows. "Brightest" is by how much a pixel is brighter than the fit at
most, relative to the RMS of the shading: nothing for the quadratic program, which so leaves what shadows took as
residuals of one sign (figure 2). "Bias" and "error" are of the environment beside a ball in no shadow. The program lies
above the noise of every pixel as well, and so above the truth; least squares lies in the middle of noise and shadows.
Recomposition takes differences of D alone.

{residuals}

![Residuals](pictures/oracle-shape-residuals.jpg)

Quadratic program above, least squares below: shading over the Gauss map; the fit on a ball; what it leaves of the
shading (blue: darker than the fit, red: brighter).

### Bumps after rendering

One thing of glossy red plastic on a grey floor, and all that is mirrored between them, as in figure 9. Voronoi bumps
are laid on it in mitsuba; ours is the smooth picture with the bumped normals. PSNR is in linear light over the pixels
whose normals turn by more than a degree. "Diffuse only" leaves reflections as they were; "noise" compares two renders
of the truth. Goal: at least 3 dB over the better of leaving the shading alone and diffuse only, for the ball among
windows. Where reflections are soft, or weak beside diffuse light, shading diffuse light alone comes near already.

{bumps}

![Bumps](pictures/oracle-shape-bumps.jpg)

As rendered; ours; the truth; the difference, {boost:g} times.

### Things that mirror one another

A brass ball, a red teapot and a white vase stand together (figure 11). Each is edited alone; all other pixels keep
their bits. What the others add to a thing's reflections is the difference to pictures without them: the columns on
neighbours correlate it with the true one, in the edited picture, in the picture as rendered (which knows nothing of the
bumps), and in the environment, whose truth is a small ball of the same material in the thing's place.

{table_top}

![Things that mirror one another](pictures/oracle-shape-table-top.jpg)

As rendered; ours; the truth; the difference, {boost:g} times; reflected light that was reconstructed; the ball in its
place."""


def sections(variant: str, folder: Path, pictures: Path) -> str:
    """Measure everything, write the pictures, and return the text."""
    if variant != FAST:
        return NO_LLVM
    quality = Quality(variant, SIDE_PX, SAMPLES, folder)
    unshadowed = Quality(variant, SIDE_PX, MANY_SAMPLES, folder)
    return TEXT.format(
        side=SIDE_PX,
        samples=SAMPLES,
        many_samples=MANY_SAMPLES,
        boost=BOOST,
        environments=_environments(unshadowed, pictures / "oracle-shape-environments.jpg"),
        residuals=_residuals(unshadowed, pictures / "oracle-shape-residuals.jpg"),
        bumps=_bumps(quality, pictures / "oracle-shape-bumps.jpg"),
        table_top=_table_top(quality, pictures / "oracle-shape-table-top.jpg"),
    )


def _environments(quality: Quality, picture: Path) -> str:
    rows, cells = [], []
    for probe in PROBES:
        for shape in POSES:
            found = rebuilt(quality, shape, probe)
            errors = [f"{ball.error(where):.3f}" for ball in found[:2] for where in (ball.whole, ball.told)]
            rows.append((shape, probe, *errors, f"{found.coverage:.0%}".replace("%", " %")))
            cells += [_shown(found.picture), *_balls(found.diffuse), *_balls(found.reflection)]
    write_codes(picture, contact_sheet(cells, 7, SIDE_PX))
    headings = ("diffuse: ball", "told", "reflection: ball", "told", "directions told")
    return _table(("thing", "light", *headings), rows)


def _balls(ball: Ball) -> list[U8]:
    away = BOOST * np.abs(ball.ours - ball.truth)
    return [_shown(np.where(ball.whole[..., None], one, 0)) for one in (ball.truth, ball.ours, away)]


def _residuals(quality: Quality, picture: Path) -> str:
    rows = []
    for shape in POSES:
        for probe in PROBES:
            for method in ("qp", "ls"):
                found = residuals(quality, shape, probe, method)
                rows.append((shape, probe, method, *(f"{round(figure, 3) + 0.0:.3f}" for figure in found)))
    # The first three cells of a report of one surface.
    sheets = [read_codes(quality.folder / f"shadowed-teapot-soft-{method}.png") for method in ("qp", "ls")]
    parts = [np.asarray(sheet[:, : sheet.shape[1] // 2], np.uint8) for sheet in sheets]
    write_codes(picture, contact_sheet(parts, 1, parts[0].shape[1]))
    return _table(("thing", "light", "fit", "brightest", "bias", "error"), rows)


def _bumps(quality: Quality, picture: Path) -> str:
    rows, cells = [], []
    for probe in PROBES:
        for shape in RED:
            found = edit(quality, on_a_floor(shape, probe), 0, f"{shape}-{probe}-floor")
            rows.append((shape, probe, *_figures(found)))
            cells += _beside(found)
    write_codes(picture, contact_sheet(cells, 4, SIDE_PX))
    return _table(("thing", "light", *_HEADINGS), rows)


def _table_top(quality: Quality, picture: Path) -> str:
    rows, cells = [], []
    for index, thing in enumerate(TABLE_TOP.things):
        found, among = neighbours(quality, TABLE_TOP, index, f"table-{index}")
        kept = "all" if found.others_kept else "not all"
        correlations = (f"{figure:.2f}" for figure in among[:3])
        rows.append((f"{thing.material} {thing.shape}", *_figures(found), kept, *correlations))
        cells += [*_beside(found), *map(_shown, among.balls)]
    write_codes(picture, contact_sheet(cells, 6, SIDE_PX))
    headings = ("others kept", "neighbours: edited", "as rendered", "environment")
    return _table(("thing", *_HEADINGS, *headings), rows)


_HEADINGS = ("ours, dB", "left alone, dB", "diffuse only, dB", "noise, dB", "margin, dB")


def _figures(found: Edit) -> list[str]:
    decibels = (found.ours_db, found.alone_db, found.diffuse_only_db, found.noise_db, found.margin_db)
    return [f"{figure:.1f}" for figure in decibels]


def _beside(found: Edit) -> list[U8]:
    _, ours, truth = found.pictures
    return [_shown(one) for one in (*found.pictures, BOOST * np.abs(ours - truth))]


def _shown(linear: NDArray[np.floating]) -> U8:
    return to_u8(encode_srgb(np.asarray(linear, np.float32)))


def _table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [headings, ["---"] * len(headings), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
