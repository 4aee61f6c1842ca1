"""Reconstruction of environments, stage by stage as in the Shape paper's table 1, whose pixel counts are not known."""

from functools import partial

import numpy as np
import quadprog
from numpy.typing import NDArray

from benchmarks.measure import Comparison, compare
from processing.paraboloid.direct import solve_directly
from processing.paraboloid.harmonic_fill import fill
from processing.paraboloid.maps import texel_directions
from processing.paraboloid.multigrid import levels
from processing.paraboloid.seam import MARGIN, map_grid
from processing.shape.diffuse.fit import fit_diffuse
from processing.shape.harmonics import evaluate
from processing.shape.reflection.environment import ReflectionOptions, draw_both, mirror, see
from processing.shape.reflection.polygons import Smoothness, joined, polygons
from tests.processing.shape.diffuse.shadings import surface
from tests.processing.shape.reflection.balls import ball

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
SHADED_PX = 400_000
BALL_SIDE = 518
"""So that about 200,000 pixels are on the ball."""
SIZE = 512
HOLE_COSINE = -0.68
"""Of the hole's half angle: some 350,000 of the map's texels."""


def comparisons() -> list[Comparison]:
    """Compare each stage with a peer, or with the least that it has to do."""
    return [*_diffuse(), *_reflection(), _filling()]


def _diffuse() -> list[Comparison]:
    normals, shading = surface(7, SHADED_PX)
    values = evaluate(normals)
    few = fit_diffuse(normals, shading).coefficients
    np.testing.assert_allclose(values @ few, values @ _all_at_once(values, shading), atol=1e-5)
    ours = ("few constraints", lambda: fit_diffuse(normals, shading))
    what, goal = f"Diffuse environment from {SHADED_PX} pixels × 3", "≤ 70 ms; the paper 14 to 184 ms"
    return [
        compare(what, ours, ("quadprog, all constraints at once", lambda: _all_at_once(values, shading)), goal=goal),
        compare(what, ours, ("least squares of NumPy", lambda: np.linalg.lstsq(evaluate(normals), shading))),
    ]


def _all_at_once(values: F64, shading: F32) -> F64:
    gram = values.T @ values / len(values)
    moments = values.T @ shading.astype(np.float64) / len(values)
    rows = values.T.copy()
    columns = (quadprog.solve_qp(gram, moments[:, c], rows, shading[:, c].astype(np.float64))[0] for c in range(3))
    return np.stack(list(columns), axis=-1)


def _reflection() -> list[Comparison]:
    seen = ball(BALL_SIDE)
    pixels = f"{int(seen.used.sum())} pixels into 2 × {SIZE}²"
    ways = [ReflectionOptions(SIZE), ReflectionOptions(SIZE, "quads")]
    assert see(*seen[:4], seen.used, ways[0]).coverage > 0.9
    mirrored = mirror(seen.normals, seen.to_eye)
    corners = polygons(*joined(seen.used, seen.normals, seen.to_eye, seen.positions, Smoothness()))
    points = ("each pixel a point, np.add.at", partial(_points, seen.reflection, seen.normals, seen.to_eye, seen.used))
    return [
        *(
            compare(
                f"Drawing {pixels}",
                (way.interpolation, partial(draw_both, corners, mirrored, seen.reflection, way)),
                points,
                goal="≤ 60 ms" if way is ways[0] else "",
            )
            for way in ways
        ),
        compare(
            f"Partial reflection environment, patches and all, from {pixels}",
            ("triangles", partial(see, *seen[:4], seen.used, ways[0])),
            points,
            goal="the paper 26 to 470 ms",
        ),
    ]


def _points(reflection: F32, normals: F32, to_eye: F32, used: NDArray[np.bool_]) -> F64:
    r = mirror(normals, to_eye)[used]
    place = (r[:, :2] / (1 + np.abs(r[:, 2:])) + 1) / 2 * SIZE
    column, row = place.astype(np.int64).clip(0, SIZE - 1).T
    sums = np.zeros((2, SIZE, SIZE, 4))
    np.add.at(sums, ((r[:, 2] < 0).astype(int), row, column), np.pad(reflection[used], ((0, 0), (0, 1))))
    return sums


def _filling() -> Comparison:
    towards = np.array([0.4, 0.2, -0.9]) / np.linalg.norm([0.4, 0.2, -0.9])
    directions = texel_directions(SIZE)
    known = [d @ towards < HOLE_COSINE for d in directions]
    light = [np.stack([d[..., 0], d[..., 1] * d[..., 2], d[..., 2] ** 2], axis=-1) for d in directions]
    within = np.hypot(*np.meshgrid(*[(2 * np.arange(SIZE) + 1) / SIZE - 1] * 2)) <= 1
    unknown = sum(int(np.count_nonzero(within & ~mask)) for mask in known)
    peer = _directly(light, known, within)
    ours = fill(light[0], light[1], known[0], known[1])
    for one, other in zip(ours, peer, strict=True):
        np.testing.assert_allclose(one[within], other[within], atol=1e-4)
    return compare(
        f"Filling {unknown} texels × 3 of 2 × {SIZE}²",
        ("multigrid", lambda: fill(light[0], light[1], known[0], known[1])),
        ("SuperLU", lambda: _directly(light, known, within)),
        goal="≤ 0.8 s; the paper .19 to 6 s",
        rounds=1,
    )


def _directly(light: list[F64], known: list[NDArray[np.bool_]], within: NDArray[np.bool_]) -> list[F64]:
    given = np.pad(np.stack(known) & within, ((0, 0), (MARGIN, MARGIN), (MARGIN, MARGIN)))
    level = next(iter(levels(map_grid(SIZE), given)))
    fixed = np.stack([np.pad(half, ((MARGIN, MARGIN), (MARGIN, MARGIN), (0, 0))) for half in light])
    values = [np.where(given, fixed[..., c], 0) for c in range(3)]
    solved = np.stack(solve_directly(level, values, [np.zeros(given.shape)] * 3), axis=-1)
    return list(solved[:, MARGIN:-MARGIN, MARGIN:-MARGIN])
