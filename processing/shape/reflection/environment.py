"""The reflection environment of a surface, over all mirrored directions (the Shape paper, section 3.2)."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.paraboloid.harmonic_fill import fill
from processing.paraboloid.maps import places
from processing.shape.reflection.polygons import Indices, Mask, Smoothness, joined, polygons
from processing.shape.reflection.raster import SUMS, chart, draw
from processing.shape.reflection.regularise import breaks, smooth

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Interpolation = Literal["triangles", "quads"]
SIZE = 512
LARGEST_SIZE = 4096
_LITTLE = 0.5


@dataclass(frozen=True)
class ReflectionOptions:
    """How to reconstruct.

    Attributes
    ----------
    size : texels along a side of each half
    interpolation : within the quads of four pixels, by two triangles, or by spherical mean value coordinates as in the
        paper, which cost more
    occlusion_threshold : pixels that are less open count for nothing
    smoothness : where a smooth patch ends
    blur_deg : of the Gaussian along breaks between patches; 0 leaves them
    """

    size: int = SIZE
    interpolation: Interpolation = "triangles"
    occlusion_threshold: float = 0.5
    smoothness: Smoothness = field(default_factory=Smoothness)
    blur_deg: float = 0.5

    def __post_init__(self) -> None:
        """Refuse what means nothing."""
        if not 2 <= self.size <= LARGEST_SIZE:
            raise InputError(f"reflection environment: no map has {self.size} texels a side; give 2 to {LARGEST_SIZE}")
        if not 0 <= self.occlusion_threshold <= 1:
            raise InputError(
                f"reflection environment: an occlusion threshold of {self.occlusion_threshold:g} means nothing; "
                "give 0 to 1"
            )
        if not 0 <= self.blur_deg <= 90:
            raise InputError(f"reflection environment: a blur of {self.blur_deg:g} deg means nothing; give 0 to 90")


@dataclass(frozen=True)
class PartialEnvironment:
    """What a surface shows of its environment.

    Attributes
    ----------
    halves : (2, S, S, 3) front and back, 0 where nothing is known
    known : (2, S, S) within the unit circle
    pixels : (2, S, S, 2) column and row that a texel's light is from
    narrowness : (2, S, S) pixels that go into a texel, the way they are narrowest
    """

    halves: F64
    known: Mask
    pixels: F64
    narrowness: F64

    @property
    def coverage(self) -> float:
        """Share of all directions that is known."""
        area = _areas(self.known.shape[1])
        return float((self.known * area).sum() / (2 * area.sum()))


@dataclass(frozen=True)
class ReflectionEnvironment:
    """R over all directions.

    Attributes
    ----------
    front, back : (S, S, 3) float32, as `paraboloid.maps`
    known : (2, S, S) what the surface shows within the unit circle; the rest is filled in
    coverage : its share of all directions
    remarks : what is to be known about it
    """

    front: F32
    back: F32
    known: Mask
    coverage: float
    remarks: tuple[str, ...]


def reconstruct_reflection(
    reflection: F32,
    normals: F32,
    to_eye: F32,
    positions: F32 | None,
    occlusion: F32,
    used: Mask,
    options: ReflectionOptions | None = None,
    guide: tuple[F32, F32] | None = None,
) -> ReflectionEnvironment:
    """Bring a surface's reflections to their directions, fill in the rest, and smooth the breaks.

    Parameters
    ----------
    reflection : (H, W, 3) float32, finite where used, R₀
    normals, to_eye : (H, W, 3) float32, unit where used, view frame
    positions : (H, W, 3), or None where they are not known
    occlusion : (H, W), α_R, 1 where nothing is in the way
    used : (H, W) the pixels of the surface
    guide : (S, S, 3) each, what is filled in looks like, as far as what is seen around allows; none is nothing

    Raises
    ------
    InputError
        No pixel is used.
    """
    options = options or ReflectionOptions()
    if not used.any():
        raise InputError("reflection environment: no pixel to look at; choose a surface that is seen")
    remarks = []
    open_ones = used & (occlusion >= options.occlusion_threshold)
    if not open_ones.any():
        remarks.append("it is occluded everywhere; its reflections are taken all the same")
        open_ones = used
    seen = see(reflection, normals, to_eye, positions, open_ones, options)
    if seen.coverage < _LITTLE:
        remarks.append(f"it shows {seen.coverage:.0%} of all reflected directions; the rest is filled in from around")
    base = np.zeros_like(seen.halves) if guide is None else np.stack(guide)
    rest = seen.halves - base
    filled = fill(rest[0], rest[1], seen.known[0], seen.known[1])
    front, back = ((base[half] + filled[half]).astype(np.float32) for half in (0, 1))
    if options.blur_deg > 0:
        rows, columns = np.nonzero(used)
        extent_px = float(np.hypot(np.ptp(rows) + 1, np.ptp(columns) + 1))
        broken = breaks(seen.pixels, seen.narrowness, seen.known, extent_px)
        front, back = smooth(np.stack([front, back]), broken, options.blur_deg)
    return ReflectionEnvironment(front, back, seen.known, seen.coverage, tuple(remarks))


def see(
    reflection: F32, normals: F32, to_eye: F32, positions: F32 | None, used: Mask, options: ReflectionOptions
) -> PartialEnvironment:
    """Map the reflections of the used pixels to their directions, and leave the rest empty (equation 2)."""
    facing = np.sum(normals * to_eye, axis=-1)
    used = used & (facing > 0) if np.any(used & (facing > 0)) else used
    mirrored = mirror(normals, to_eye)
    corners = polygons(*joined(used, normals, to_eye, positions, options.smoothness))
    sums = draw_both(corners, mirrored, reflection, options)
    sums *= (_areas(options.size) > 0)[..., None]
    if not sums[..., -1].any():
        _put_points(mirrored[used], reflection[used], np.argwhere(used), sums)
    weight = sums[..., -1]
    known = weight > 0
    means = sums / np.where(known, weight, 1)[..., None]
    return PartialEnvironment(means[..., :3], known, means[..., 3:5], means[..., 5])


def draw_both(corners: Indices, mirrored: F32, reflection: F32, options: ReflectionOptions) -> F64:
    """Draw polygons between pixels (H, W, 3) into both halves, (2, S, S, 7) as `raster.draw`."""
    sums = np.zeros((2, options.size, options.size, SUMS))
    flat, colours = mirrored.reshape(-1, 3), reflection.reshape(-1, 3)

    def half(index: int) -> None:
        places = chart(flat, front=index == 0)
        draw(corners, places, colours, mirrored.shape[1], options.interpolation == "quads", sums[index])

    with ThreadPoolExecutor(2) as pool:  # the loops let go of the interpreter's lock
        list(pool.map(half, range(2)))
    return sums


def mirror(normals: F32, to_eye: F32) -> F32:
    """Mirror the view at the normal: r = 2(n·v)n − v."""
    r: F32 = 2 * np.sum(normals * to_eye, axis=-1, keepdims=True) * normals - to_eye
    return r


def _put_points(mirrored: F32, colours: F32, rows_columns: NDArray[np.int64], sums: F64) -> None:
    """Let each pixel be a point, where no four or three hang together, or all of them fall between texels."""
    size = sums.shape[1]
    in_front, x, y = places(mirrored)
    half = np.where(in_front, 0, 1)
    # Towards the middle, so that what lies on the rim comes to a texel within the circle.
    column, row = (np.clip(((p - 0.5) * (1 - 1.5 / size) + 0.5) * size, 0, size - 1).astype(np.int64) for p in (x, y))
    ones = np.ones((len(colours), 1))
    content = np.concatenate([colours, rows_columns[:, ::-1], ones, ones], axis=1)
    np.add.at(sums, (half, row, column), content)


def _areas(size: int) -> F64:
    """Solid angle of each texel of a half (S, S), up to a factor; 0 beyond the unit circle."""
    along = (2 * np.arange(size) + 1) / size - 1
    q = along**2 + along[:, None] ** 2
    areas: F64 = np.where(q <= 1, (2 / (1 + q)) ** 2, 0)
    return areas
