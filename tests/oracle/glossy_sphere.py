"""Spheres of isotropic materials in a light of our own making that can be turned, rendered by mitsuba."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from firmware_sim.mitsuba.lighting import map_directions
from firmware_sim.mitsuba.scenes import film
from firmware_sim.mitsuba.variants import load_mitsuba

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Bools = NDArray[np.bool_]
Material = dict[str, Any]

ROWS = 256
WHOLE = 0.999
"""Share of a pixel's samples that must meet the sphere."""
_EDGE_DEG = 1.5
# direction, half-sides as angles in degrees across and up, radiance; edges are a degree or two wide
_PANELS = (
    ((-0.55, 0.60, 0.75), (15.0, 22.0), (2.6, 2.4, 2.1)),
    ((0.80, 0.25, 0.35), (7.0, 30.0), (1.6, 2.0, 2.6)),
    ((0.15, -0.65, 0.60), (34.0, 5.0), (2.0, 1.4, 0.9)),
    ((-0.70, 0.05, -0.60), (20.0, 12.0), (1.1, 1.9, 1.3)),
    ((0.45, 0.60, -0.75), (12.0, 12.0), (2.4, 1.5, 1.5)),
)
_SKY, _HORIZON, _GROUND = (0.16, 0.22, 0.32), (0.40, 0.38, 0.35), (0.10, 0.08, 0.06)

GOLD: Material = {"type": "roughconductor", "material": "Au", "distribution": "ggx", "alpha": 0.15}
SATIN_GOLD: Material = {"type": "roughconductor", "material": "Au", "distribution": "ggx", "alpha": 0.3}
PLASTIC_COLOURS = (0.35, 0.08, 0.06)


def plastic(alpha: float, *, diffuse: float = 1.0, specular: float = 1.0) -> Material:
    """Return a glossy plastic, or one of its two parts: they add up, as nothing is non-linear."""
    return {
        "type": "roughplastic",
        "distribution": "ggx",
        "alpha": alpha,
        "nonlinear": False,
        "diffuse_reflectance": {"type": "rgb", "value": [diffuse * part for part in PLASTIC_COLOURS]},
        "specular_reflectance": specular,
    }


PLASTIC, SATIN_PLASTIC = plastic(0.12), plastic(0.25)


@dataclass(frozen=True)
class Ball:
    """The orthographic picture of a sphere, the disc inscribed.

    Attributes
    ----------
    picture : (S, S, 3) float32, linear, black behind
    whole : (S, S) bool, pixels that show the sphere and nothing else
    """

    picture: F32
    whole: Bools


def radiance(directions: F64, turn: Rotation | None = None) -> F64:
    """Return the light from unit directions (..., 3), after the surroundings were turned."""
    if turn is not None:
        directions = turn.apply(directions.reshape(-1, 3), inverse=True).reshape(directions.shape)
    up = directions[..., 1:2]
    sky = np.where(up > 0, _mix(_HORIZON, _SKY, np.sqrt(np.abs(up))), _GROUND)
    for middle, half_sides, colour in _PANELS:
        sky = sky + _panel(directions, middle, half_sides)[..., None] * np.array(colour)
    return sky


def rendered(
    variant: str, material: Material, side_px: int, samples: int, turn: Rotation | None = None, seed: int = 1
) -> Ball:
    """Render a sphere in the surroundings, turned.

    Parameters
    ----------
    turn : of the light, in the view frame
    """
    mitsuba = load_mitsuba(variant)
    light = radiance(map_directions(ROWS), turn).astype(np.float32)
    camera = mitsuba.ScalarTransform4f().look_at([0, 0, 10], [0, 0, 0], [0, 1, 0])
    scene = mitsuba.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "direct", "hide_emitters": True},
            "sensor": {
                "type": "orthographic",
                "to_world": camera,
                "film": film(side_px, side_px),
                "near_clip": 0.1,
                "far_clip": 100.0,
            },
            "ball": {"type": "sphere", "bsdf": material},
            "light": {"type": "envmap", "bitmap": mitsuba.Bitmap(light)},
        }
    )
    rgba = np.array(mitsuba.render(scene, spp=samples, seed=seed), np.float32)
    return Ball(rgba[..., :3], rgba[..., 3] >= WHOLE)


def _mix(first: tuple[float, ...], second: tuple[float, ...], share: F64) -> F64:
    mixed: F64 = np.array(first) * (1 - share) + np.array(second) * share
    return mixed


def _panel(directions: F64, middle: tuple[float, ...], half_sides_deg: tuple[float, float]) -> F64:
    """Return how much of a rectangle of light directions see, 0..1, its edges a little soft."""
    towards = np.array(middle) / np.linalg.norm(middle)
    across = np.cross([0.0, 1.0, 0.0], towards)
    across /= np.linalg.norm(across)
    up = np.cross(towards, across)
    ahead = directions @ towards
    seen: F64 = (ahead > 0).astype(np.float64)
    for axis, half_deg in zip((across, up), half_sides_deg, strict=True):
        off_deg = np.degrees(np.abs(np.arctan2(directions @ axis, ahead)))
        seen = seen * np.clip((half_deg - off_deg) / _EDGE_DEG + 0.5, 0, 1)
    return seen
