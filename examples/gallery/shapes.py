"""The gallery's own meshes: a mask, a toy cow and a robot, put together from bent balls.

Positions are y up, the front towards +z. Part i of n has the i-th column of one texture, which can be painted in space:
`painted` asks for a colour at every texel's place on the surface.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
Bend = Callable[[F64], F64]
Paint = Callable[[F64, int], F64]

MARGIN = 0.04
"""Share of a part's column that is left to either side, so that filtering does not mix neighbours."""


@dataclass(frozen=True)
class Part:
    """A ball that a function bends, unit vectors (…, 3) → places (…, 3); and which material it is of."""

    bend: Bend
    material: int = 0
    columns: int = 44
    rows: int = 32


def ball_directions(u: F64, v: F64) -> F64:
    """Return the unit vectors at shares of the way round (from the back, over the left) and up."""
    around, up = (u - 0.5) * 2 * np.pi, (v - 0.5) * np.pi
    return np.stack([np.cos(up) * np.sin(around), np.sin(up), np.cos(up) * np.cos(around)], axis=-1)


def write_obj(path: Path, parts: list[Part]) -> None:
    """Write the parts as one OBJ with texture coordinates; normals are averaged, over the back seam too."""
    lines, first = ["# made by examples/gallery/shapes.py"], 1
    for index, part in enumerate(parts):
        u, v = np.meshgrid(np.linspace(0, 1, part.columns + 1), np.linspace(0, 1, part.rows + 1))
        places = part.bend(ball_directions(u, v))
        normals = _normals(part, u, v)
        column = (index + MARGIN + u * (1 - 2 * MARGIN)) / len(parts)
        rows = zip(places.reshape(-1, 3), np.stack([column, v], -1).reshape(-1, 2), normals.reshape(-1, 3), strict=True)
        for place, texture, normal in rows:
            lines.append("v {:.6f} {:.6f} {:.6f}".format(*place))
            lines.append("vt {:.6f} {:.6f}".format(*texture))
            lines.append("vn {:.5f} {:.5f} {:.5f}".format(*normal))
        corners = np.arange(first, first + u.size).reshape(u.shape)
        below, above = (corners[:-1, :-1], corners[:-1, 1:]), (corners[1:, 1:], corners[1:, :-1])
        quads = np.stack([*below, *above], axis=-1)
        # At the poles a quad has no lower, or no upper side.
        faces = [*quads[0][:, [0, 2, 3]], *quads[1:-1].reshape(-1, 4), *quads[-1][:, [0, 1, 2]]]
        lines += ["f " + " ".join(f"{c}/{c}/{c}" for c in face) for face in faces]
        first += u.size
    path.write_text("\n".join(lines) + "\n")


def painted(parts: list[Part], paint: Paint, column_px: int, rows_px: int) -> F64:
    """Return a texture (rows, columns · parts, 3): what `paint` says of places (…, 3) on part number i."""
    columns = []
    for index, part in enumerate(parts):
        u = (np.arange(column_px) + 0.5) / column_px
        u = np.clip((u - MARGIN) / (1 - 2 * MARGIN), 0, 1)
        v = 1 - (np.arange(rows_px) + 0.5) / rows_px
        columns.append(paint(part.bend(ball_directions(*np.meshgrid(u, v))), index))
    return np.concatenate(columns, axis=1)


def _normals(part: Part, u: F64, v: F64) -> F64:
    """Return unit normals by differences on the ball itself, where the poles are like any other place."""
    out = ball_directions(u, v)
    aside = np.where(np.abs(out[..., 1:2]) < 0.9, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0])
    first = np.cross(aside, out)
    first /= np.linalg.norm(first, axis=-1, keepdims=True)
    second, step = np.cross(out, first), 4e-3

    def along(way: F64) -> F64:
        ahead, behind = out + step * way, out - step * way
        length = np.linalg.norm(ahead, axis=-1, keepdims=True)
        return np.asarray(part.bend(ahead / length) - part.bend(behind / length))

    normals = np.cross(along(first), along(second))
    return np.asarray(normals / np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-12))


def ellipsoid(middle: tuple[float, float, float], radii: tuple[float, float, float], tilt_deg: float = 0.0) -> Bend:
    """Return a bend to an ellipsoid, then tilted about z and moved."""
    return boxy(middle, radii, 1.0, tilt_deg)


def boxy(
    middle: tuple[float, float, float], radii: tuple[float, float, float], roundness: float, tilt_deg: float = 0.0
) -> Bend:
    """Return a bend to a superellipsoid: roundness 1 a ball, towards 0 a box."""
    power = 2 / roundness
    c, s = np.cos(np.radians(tilt_deg)), np.sin(np.radians(tilt_deg))
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])

    def bend(out: F64) -> F64:
        far = (np.abs(out) ** power).sum(axis=-1, keepdims=True) ** (-1 / power)
        return np.asarray(out * far * np.array(radii) @ turn.T + np.array(middle))

    return bend


def mask() -> list[Part]:
    """Return a head, sculpted: brow, eyes, nose, lips, cheeks, chin, ears, horns; it is seen from the front."""
    horns = [Part(bend, columns=48, rows=96) for bend in (_horn, _mirrored(_horn))]
    ears = [Part(bend, columns=64, rows=48) for bend in (_ear, _mirrored(_ear))]
    eyes = [Part(ellipsoid((side * 0.27, 0.16, 0.66), (0.125, 0.105, 0.115)), columns=48, rows=36) for side in (-1, 1)]
    return [Part(_face, columns=176, rows=152), *eyes, *ears, *horns]


def _face(out: F64) -> F64:
    x, y, z = np.abs(out[..., 0]), out[..., 1], out[..., 2]
    front = 1 / (1 + np.exp(-(z - 0.1) * 14))

    def bump(px: float, py: float, wide: float, tall: float, high: float) -> F64:
        return np.asarray(high * front * np.exp(-(((x - px) / wide) ** 2) - (((y - py) / tall) ** 2)))

    r = np.full(x.shape, 0.86)
    r += bump(0.27, 0.40, 0.20, 0.085, 0.10) - bump(0.0, 0.42, 0.06, 0.10, 0.03)  # brows and the frown between
    r -= bump(0.33, 0.19, 0.16, 0.13, 0.17)  # eye sockets
    r += bump(0.0, 0.08, 0.085, 0.26, 0.10) + bump(0.0, -0.10, 0.15, 0.12, 0.24)  # ridge and ball of the nose
    r += bump(0.145, -0.125, 0.075, 0.075, 0.10) - bump(0.085, -0.225, 0.045, 0.035, 0.09)  # wings, nostrils
    r += bump(0.52, -0.08, 0.17, 0.15, 0.09)  # cheekbones
    r -= bump(0.30, -0.30, 0.06, 0.16, 0.055)  # the fold beside the mouth
    r += bump(0.0, -0.375, 0.26, 0.055, 0.085) + bump(0.0, -0.525, 0.21, 0.06, 0.10)  # lips
    r -= bump(0.0, -0.445, 0.30, 0.026, 0.10)
    r += bump(0.0, -0.76, 0.22, 0.13, 0.16) + bump(0.5, -0.55, 0.2, 0.2, 0.06)  # chin, jaw
    for crease in range(3):
        r -= bump(0.0, 0.57 + 0.085 * crease, 0.34, 0.02, 0.018)  # the forehead
    return np.asarray(out * r[..., None] * np.array([0.86, 1.08, 0.92]))


def _ear(out: F64) -> F64:
    long = 0.5 * (1 + out[..., 0])  # from the head to the tip
    thin = 0.27 * (1 - 0.75 * long**2)
    hollow = 0.10 * np.exp(-((out[..., 1] / 0.5) ** 2)) * np.clip(out[..., 2], 0, 1)
    x, y = 0.58 + 0.62 * long, 0.06 + thin * out[..., 1] + 0.34 * long**1.5
    return np.stack([x, y, -0.12 + 0.09 * out[..., 2] - hollow - 0.14 * long], axis=-1)


def _horn(out: F64) -> F64:
    """Bend a ball along an arc that leads up and outwards, thinner and ringed towards its tip."""
    long = 0.5 * (1 + out[..., 1])
    thick = 0.17 * (1 - 0.75 * long) * (1 + 0.09 * np.cos(long * 42))
    turn = 1.3 * long
    x = 0.34 + 0.42 * (1 - np.cos(turn)) + thick * out[..., 0] * np.cos(turn)
    y = 0.66 + 0.46 * np.sin(turn) - thick * out[..., 0] * np.sin(turn)
    return np.stack([x, y, 0.14 + thick * out[..., 2]], axis=-1)


def _mirrored(bend: Bend) -> Bend:
    """Return the bend of the other side; turned over twice, the surface stays outside."""
    flip = np.array([-1.0, 1.0, 1.0])
    return lambda out: bend(out * flip) * flip


def cow() -> list[Part]:
    """Return a toy cow that looks to the left and a little at us."""
    legs = [
        Part(boxy((x, -0.62, z), (0.13, 0.34, 0.13), 0.7))
        for x, z in ((-0.42, 0.2), (-0.42, -0.2), (0.48, 0.2), (0.48, -0.2))
    ]
    return [
        Part(boxy((0.05, -0.12, 0.0), (0.72, 0.40, 0.40), 0.8), columns=80, rows=56),
        Part(ellipsoid((-0.78, 0.28, 0.06), (0.31, 0.30, 0.28)), columns=64, rows=48),
        Part(boxy((-1.02, 0.16, 0.08), (0.18, 0.17, 0.21), 0.8)),
        Part(ellipsoid((-0.62, 0.42, 0.36), (0.17, 0.07, 0.11), -20.0)),
        Part(ellipsoid((-0.62, 0.42, -0.26), (0.17, 0.07, 0.11), -20.0)),
        Part(ellipsoid((-0.78, 0.62, 0.22), (0.055, 0.15, 0.055), -12.0)),
        Part(ellipsoid((-0.78, 0.62, -0.10), (0.055, 0.15, 0.055), -12.0)),
        Part(ellipsoid((0.84, -0.12, 0.0), (0.05, 0.36, 0.05), 14.0)),
        Part(ellipsoid((0.30, -0.50, 0.0), (0.17, 0.12, 0.15))),
        *legs,
    ]


def robot() -> list[Part]:
    """Return a robot of three materials: shell (0), joints and face (1), and what shines (2)."""
    both = (-1.0, 1.0)
    return [
        Part(boxy((0, -0.05, 0), (0.42, 0.42, 0.30), 0.35), 0, 72, 56),
        Part(boxy((0, 0.66, 0), (0.36, 0.27, 0.29), 0.45), 0, 72, 56),
        Part(boxy((0, 0.67, 0.20), (0.28, 0.17, 0.13), 0.5), 1, 64, 48),
        *[Part(ellipsoid((side * 0.12, 0.69, 0.31), (0.075, 0.075, 0.06)), 2) for side in both],
        Part(boxy((0, 0.40, 0), (0.17, 0.08, 0.17), 0.6), 1),
        Part(ellipsoid((0, 1.16, 0), (0.085, 0.085, 0.085)), 2),
        Part(boxy((0, 1.02, 0), (0.03, 0.14, 0.03), 0.7), 1),
        *[Part(ellipsoid((side * 0.39, 0.66, 0), (0.07, 0.12, 0.12)), 2) for side in both],
        *[Part(ellipsoid((side * 0.52, 0.20, 0), (0.15, 0.15, 0.15)), 1) for side in both],
        *[Part(boxy((side * 0.66, -0.14, 0.06), (0.115, 0.27, 0.125), 0.5, side * 16.0), 0) for side in both],
        *[Part(ellipsoid((side * 0.76, -0.50, 0.10), (0.15, 0.15, 0.15)), 2) for side in both],
        Part(ellipsoid((0, 0.02, 0.27), (0.15, 0.15, 0.08)), 2),
        Part(boxy((0, -0.52, 0), (0.30, 0.09, 0.22), 0.5), 1),
        *[Part(boxy((side * 0.20, -0.76, 0), (0.13, 0.22, 0.14), 0.5), 0) for side in both],
        *[Part(boxy((side * 0.21, -1.02, 0.08), (0.17, 0.10, 0.25), 0.5), 1) for side in both],
    ]
