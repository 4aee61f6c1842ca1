"""Flat pictures of PTMs: whole or in part, at any size, and larger than the graphics driver's pictures."""

import math
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.ptm.model import Ptm
from viewer.geometry import whole_picture
from viewer.materials.ptm import PtmMaterial
from viewer.materials.ptm_shading import PtmShading
from viewer.renderer import Renderer
from viewer.targets import Target

F32 = NDArray[np.float32]
BAND_BYTES = 256 << 20
"""A flat PTM is drawn in bands of rows whose coefficients take about so much, so that large ones need little memory."""
_SIDE_LIMIT_PX = 32_768
_PICTURE_LIMIT_PX = 1 << 27
_BAND_ROWS = 4096
_EDGE = 1e-6
"""Of a texel, which may be rounded either way where a band ends."""


@dataclass(frozen=True)
class FlatView:
    """What is seen of a flat material, and how large.

    Attributes
    ----------
    window : left, top, width and height in texels; None is all of it
    zoom : pixels a texel. From 1 up texels are seen as squares; below, each pixel is the mean light of what it covers
    """

    window: tuple[int, int, int, int] | None = None
    zoom: float = 1.0

    def cut(self, ptm: Ptm) -> Ptm:
        """Cut the window out.

        Raises
        ------
        InputError
            It is not within the material.
        """
        if self.window is None:
            return ptm
        left, top, width, height = self.window
        tall, wide = ptm.shape
        if not (
            left >= 0 and top >= 0 and width >= 1 and height >= 1 and left + width <= wide and top + height <= tall
        ):
            raise InputError(
                f"window: {width} × {height} texels at {left}, {top} are not within the PTM's {wide} × {tall}; "
                "give one that is"
            )
        return part(ptm, slice(top, top + height), slice(left, left + width))

    def size(self, ptm: Ptm) -> tuple[int, int]:
        """Return width and height in pixels of the picture of what `cut` has cut.

        Raises
        ------
        InputError
            The picture would be too large.
        """
        if not (math.isfinite(self.zoom) and self.zoom > 0):
            raise InputError(f"view: a zoom of {self.zoom:g} shows nothing; give pixels a texel, above 0")
        height, width = (max(1, round(side * min(self.zoom, _SIDE_LIMIT_PX + 1.0))) for side in ptm.shape)
        if self.zoom != 1 and (max(width, height) > _SIDE_LIMIT_PX or width * height > _PICTURE_LIMIT_PX):
            raise InputError(
                f"picture: {width} × {height} pixels are more than {_SIDE_LIMIT_PX} on a side or {_PICTURE_LIMIT_PX:,} "
                "in all; zoom less, or show a smaller window"
            )
        return width, height


Draw = Callable[[PtmShading, bool], F32]
"""Takes how it is shaded and whether linear light is wanted; returns the picture."""


@contextmanager
def open_flat(renderer: Renderer, ptm: Ptm, flat: FlatView, *, normals: bool, brightest: bool) -> Iterator[Draw]:
    """Prepare to draw a PTM flat, as often as wanted; what goes into one band is uploaded once.

    Parameters
    ----------
    normals, brightest : as for `PtmMaterial`

    Yields
    ------
    draw : as `flat_picture` with what is left of its arguments

    Raises
    ------
    InputError
        The window or the zoom does not go with the PTM, or it is wider than the graphics driver takes.
    """
    cut = flat.cut(ptm)
    width, height = flat.size(cut)
    texels_a_pixel = (cut.shape[1] / width, cut.shape[0] / height)
    texel_bytes = 4 * (cut.coefficients.shape[0] * cut.coefficients.shape[3] + 8)
    rows = int(BAND_BYTES / (texel_bytes * cut.shape[1]) / texels_a_pixel[1])
    # Nor more pixels at once than go well into one drawing, however far the zoom goes.
    rows = max(1, min(rows, BAND_BYTES // (16 * width), _BAND_ROWS))
    bands = [range(first, min(first + rows, height)) for first in range(0, height, rows)]

    def open_band(band: range) -> AbstractContextManager[Draw]:
        return _open_band(renderer, cut, band, width, texels_a_pixel, {"normals": normals, "brightest": brightest})

    if len(bands) == 1:
        with open_band(bands[0]) as only:
            yield only
        return

    def draw(shading: PtmShading, as_light: bool) -> F32:
        drawn = []
        for band in bands:
            with open_band(band) as some:
                drawn.append(some(shading, as_light))
        return np.concatenate(drawn)

    yield draw


def flat_picture(
    renderer: Renderer, ptm: Ptm, shading: PtmShading, flat: FlatView | None = None, *, as_light: bool = False
) -> F32:
    """Shade a PTM flat, once.

    Parameters
    ----------
    as_light : give linear light, in which lights add up; otherwise values in the material's own space, under the first
        light alone, whatever its colour

    Returns
    -------
    values : (H, W, 3) float32, where 1 is white; not cut off. Row 0 on top

    Raises
    ------
    InputError
        The window, the zoom or the shading does not go with the PTM, or it is wider than the graphics driver takes.
    GraphicsError
        The graphics driver failed.
    """
    shading.check(ptm.basis)
    wanted = {"normals": shading.needs_normals, "brightest": shading.needs_brightest}
    with open_flat(renderer, ptm, flat or FlatView(), **wanted) as draw:
        return draw(shading, as_light)


def part(ptm: Ptm, rows: slice, columns: slice = slice(None)) -> Ptm:
    """Cut a part out of a material."""
    colour = None if ptm.colour is None else ptm.colour[rows, columns]
    return Ptm(ptm.coefficients[:, rows, columns], colour, ptm.space, ptm.source, ptm.basis)


@contextmanager
def _open_band(
    renderer: Renderer,
    ptm: Ptm,
    rows: range,
    width: int,
    texels_a_pixel: tuple[float, float],
    wanted: dict[str, bool],
) -> Iterator[Draw]:
    """Prepare some of the picture's rows, from those texels alone that they show."""
    first = max(0, math.floor(rows.start * texels_a_pixel[1] - _EDGE))
    last = min(ptm.shape[0], math.ceil(rows.stop * texels_a_pixel[1] + _EDGE))
    with (
        renderer.upload(PtmMaterial, part(ptm, slice(first, last)), **wanted) as material,
        renderer.upload(whole_picture) as everything,
        renderer.upload(Target, (width, len(rows))) as target,
    ):

        def draw(shading: PtmShading, as_light: bool) -> F32:
            look = material.flat_look(
                shading,
                as_light=as_light,
                texels_a_pixel=texels_a_pixel,
                first_row=rows.start,
                first_texel_row=first,
            )
            renderer.draw(look, everything, target)
            # Row 0 was drawn at the bottom.
            return target.read()[::-1, :, :3]

        yield draw
