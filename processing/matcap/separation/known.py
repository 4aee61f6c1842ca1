"""Which pixels of a disc show the sphere, and which may hold shadings down."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from processing.matcap.disc import disc_normals, rim_distances_px

Floats = NDArray[np.floating]
Bools = NDArray[np.bool_]

_ALIKE = 1e-3
_LEAST_BLEND, _MOST_BLEND = 0.02, 0.75
_PIXEL_HALF_DIAGONAL = 0.71
_LAST_RING_PX = 4.0
_RING_PX = 0.5
_ALL = 0.98


@dataclass(frozen=True)
class Ignored:
    """What of a disc is no data, though it lies in the disc.

    Attributes
    ----------
    rim_px : pixels whose centres are less than this within the disc; None finds out how far a background reaches in
    floor : a channel's values up to this hold no shading down; None lets all
    percent : nor do its darkest pixels, so many of a hundred
    """

    rim_px: float | None = None
    floor: float | None = None
    percent: float = 0.0


NOTHING = Ignored()


def known_pixels(picture: Floats, covered: Bools | None = None, rim_px: float | None = None) -> Bools:
    """Tell which pixels of a picture (S, S, 3) show nothing but the sphere.

    Parameters
    ----------
    covered : (S, S), what a mask leaves of the picture
    rim_px : how far within the disc a pixel's centre must lie; None finds out
    """
    size = picture.shape[0]
    _, inside = disc_normals(size)
    margin = background_px(picture) if rim_px is None else rim_px
    known = inside & (rim_distances_px(size) >= margin)
    return known if covered is None else known & covered


def background_px(picture: Floats) -> float:
    """Return how far a background that is of one colour reaches into the disc, in pixels.

    Where pixels next to the disc, outside, are neither background nor sphere, its edge was smoothed, and pixels that it
    crosses are mixed, on the inside too. Rings that are all background belong to a smaller sphere.
    """
    size = picture.shape[0]
    within = rim_distances_px(size)
    far_out = picture[within < -2]
    if not len(far_out):
        return 0.0
    background = np.median(far_out, axis=0)
    allowed = _ALIKE * max(float(picture.max()), 1e-30)
    if np.mean(np.abs(far_out - background).max(axis=1) <= allowed) < _ALL:
        return 0.0
    near = np.abs(within) < _LAST_RING_PX + _RING_PX
    within, off = within[near], np.abs(picture[near] - background).max(axis=1)
    ring = 0.0
    while ring < _LAST_RING_PX:
        pixels = off[(within >= ring) & (within < ring + _RING_PX)]
        if len(pixels) and np.mean(pixels <= allowed) < _ALL:
            break
        ring += _RING_PX
    if ring >= _LAST_RING_PX:  # the whole rim is as dark as the background
        return 0.0
    if ring > 0:
        return ring + _PIXEL_HALF_DIAGONAL
    inner = float(np.mean(off[(within >= 1.5) & (within < 3)]))
    outer = float(np.mean(off[(within < -0.1) & (within > -0.5)]))
    mixed = _LEAST_BLEND * inner < outer < _MOST_BLEND * inner
    return _PIXEL_HALF_DIAGONAL if mixed else 0.0


def holding(values: Floats, ignored: Ignored) -> Bools:
    """Tell which values (N,) of one channel may hold shadings down."""
    holds = np.ones(len(values), bool)
    if ignored.floor is not None:
        holds &= values > ignored.floor
    if ignored.percent > 0:
        holds &= values >= np.percentile(values, ignored.percent)
    return holds
