"""Measure everything against mitsuba and write the page, and pictures beside it.

Usage: python -m benchmarks.oracle docs/oracle.md
"""

import importlib.metadata
import sys
import tempfile
from pathlib import Path

from benchmarks import oracle_estimate, oracle_shape, oracle_synthesis, oracle_tables, oracle_turned_light
from firmware_sim.mitsuba.variants import FAST, best_variant
from tests.oracle.shoot import LAMP_SHARE, LIGHTS, SLICES, TRUTH_FACTOR, Studio

SIDE_PX, SAMPLES = 128, 160
SLOW_SIDE_PX, SLOW_SAMPLES = 64, 96

TEXT = """# The oracle: what physics says

Made by `make oracle`. mitsuba renders the captures and the truths; no code is shared between what renders and what fits
(import-linter sees to it). A capture is a plain folder of linear EXR pictures, and goes the way that any other goes.

Last run: mitsuba {version}, variant {variant}, {side} × {side} pixels, {samples} samples a pixel in the captures,
{truth} in the truths, {lamp} under the lamp.{slow}

The spheres stand in a studio: two softboxes and an environment. Aluminium and gold are GGX microfacets; rough has
roughnesses .12 along and .4 across the brushing, as has gold; fine has .06 and .25.

## Another brushing of the same material

An AMC is built from {slices} pictures of a sphere that is brushed along parallels about an axis in the picture's
plane (16 slices, as R = 2), orthographic or from a camera at 4 to 20 radii (`rectified`). It predicts the orthographic
picture of the same material brushed along parallels at another angle, in circles about the camera's axis, and about an
axis tilted by 35°; normals and tangents come from the renderer. The weave has R = 2. PSNR is in linear light, its peak
the truth's 99.9th percentile, over pixels with n_z > .25 and a tangent longer than .15 in the picture; behind the slash
with all tangents off by 90° in the surface. Goal for other brushings: at least 27 dB, and below 18 dB with the wrong
tangents.

{brushings}

The truth's own noise would leave:

{noises}

## Perspective

The AMC is built from a camera at a distance, and predicts orthographic pictures of the two other brushings (mean of
both). Figures are RMS errors relative to the truth's RMS, over normals with a radius below .8. The row "orthographic"
is what is left without any perspective: noise, and sixteen slices. Goal: `rectified` is nearer than the naive crop and
than `view`.

{perspective}

## Diffuse light and gloss apart

Thin metal (roughness .06 and .25) over matt paint, 3 : 7. The low table is indexed by the camera's normal, the high one
by the rectified; their sum predicts the two other brushings. Figures as above. Goal: no worse than either way alone.

{splits}

## Invariance of weaves

Spheres of R tilted lobes a turn; the build finds R by itself. "Energy outside" is the share of the change over the
tangent's angle that R does not explain: over its angle in the surface, where a weave repeats exactly, and over that of
its picture, where only R = 1 and 2 do. Tables of R = 3 and 4 are stored over the angle in the surface.

{fabrics}

## Relighting

A slab with domes, a groove and a gloss under {lights} lamps; shadows fall. PSNR over all frames, display values,
nothing cut off. The fit goes through the `.ptm` file and back, where coefficients have 8 bits. Goal: less than .1 dB
lost.

{relighting}

## Light directions

A chrome ball under {lights} lamps far away, from the camera's axis down to 22° above the table. The ball is found by
itself, and the list is compared with where the lamps stood. Goal: less than .5° on average and 1° at most, with the
camera's distance known.

{mirror_balls}

## Synthesis: the blocks that are chosen

Whole syntheses over {seeds} seeds, a search against brute force: how many blocks differ. Goal: none. Kernels other than
SVD are asked for the first seeds.

{picks}

## Filter sizes of MatCaps

Spots, spots beside another, rings, edges of rings and straight edges of known variance: standard deviations of .08 to
.4 rad at θ = .4, .7 and 1.0, 8-bit sRGB, a region of 5 × 5 pixels on each. Figures are relative errors of the variance.
A ring within two standard deviations of the pole has two modes in its window, for its other side is there. Goal: the
median at most .5 % for spots and rings and 1 % for edges, the 90th percentile 2 % where there is one mode.

{filter_sizes}

## The light of a MatCap, turned

Spheres of gold (GGX of roughness .15 and .3) and of red plastic (.12 and .25) stand among soft panels, some of them
behind, under a gradient sky; orthographic, linear, twice as many samples as the captures above. The picture is taken
apart, low frequencies as matt and the filter of high ones estimated, its light turned about y or x. The truth is
rendered in turned surroundings. Beside ours, the picture itself is turned: looked up by turned normals, those that
look away at the rim, or in the mirror image of the hemisphere that is seen. Figures are RMS errors relative to the
truth's RMS, where n_z > .2. Goal: ours is nearer at every angle.

{turns}

The estimates. Along a meridian of the picture a point of light is as wide as the normals of its microfacets are
spread, a variance of about α²/2; what panels and noise add makes the rest.

{matcap_filters}

Gold about y and x, plastic about y and x, by 60°: the picture, the truth, ours, the picture turned, mirrored.

![Balls whose light was turned](pictures/matcap-turned.png)

What is left comes for the most part from the rim, where the picture shows most directions in the fewest pixels. What
plastic shows there is too bright when it has come to the middle, by half and more: that is Fresnel's silhouette, which
no picture tells from light.

## Low and high frequencies, diffuse and specular light

Plastic is rendered whole, and without its specular or diffuse part; the three have noise of their own. The columns
"whole" are what is off if the picture is taken for the part. Figures as above, means relative to the part's, and the
correlation of high and specular brightness. Goal: low and high are nearer than the whole picture. As the MatCap
paper's figure 8 says, low is brighter than the diffuse part, and high darker than the specular: smooth reflections
cannot be told from diffuse light.

{parts}

The picture, its diffuse and specular part, low and high frequencies, of roughness .12 and .25, twice as bright:

![Plastic balls and their parts](pictures/matcap-parts.png)

## Shape edited after rendering

{shape}
"""
SLOW = " This variant is slow, so pixels and samples are fewer than with LLVM."


def page(studio: Studio, pictures: Path) -> str:
    """Measure all tables, write pictures, and return the page."""
    return TEXT.format(
        version=importlib.metadata.version("mitsuba"),
        variant=studio.variant,
        side=studio.side_px,
        samples=studio.samples,
        truth=TRUTH_FACTOR * studio.samples,
        lamp=round(LAMP_SHARE * studio.samples),
        slow="" if studio.variant == FAST else SLOW,
        slices=SLICES,
        lights=LIGHTS,
        brushings=oracle_tables.brushings(studio),
        noises=oracle_tables.noises(studio),
        splits=oracle_tables.splits(studio),
        perspective=oracle_tables.perspective(studio),
        fabrics=oracle_tables.fabrics(studio),
        relighting=oracle_tables.relighting(studio),
        mirror_balls=oracle_tables.mirror_balls(studio),
        seeds=oracle_synthesis.SEEDS,
        picks=oracle_synthesis.picks(),
        filter_sizes=oracle_estimate.filter_sizes(),
        turns=oracle_turned_light.turns(studio),
        matcap_filters=oracle_turned_light.filters(studio),
        parts=oracle_turned_light.parts(studio),
        shape=oracle_shape.sections(studio.variant, studio.folder, pictures),
    )


def main() -> None:
    variant = best_variant()
    side_px, samples = (SIDE_PX, SAMPLES) if variant == FAST else (SLOW_SIDE_PX, SLOW_SAMPLES)
    with tempfile.TemporaryDirectory() as name:
        target = Path(sys.argv[1])
        studio, pictures = Studio(variant, side_px, samples, Path(name)), target.parent / "pictures"
        text = page(studio, pictures)
        oracle_turned_light.draw(studio, pictures)
    target.write_text(text, encoding="utf-8")
    sys.stdout.write(text)


if __name__ == "__main__":
    main()
