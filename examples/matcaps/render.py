"""Render the sample MatCaps with mitsuba (the extra `sim`): balls of several materials under lights made here.

`python examples/matcaps/render.py [FOLDER [NAME …]]` writes them, by default all beside this file. The camera sees
without vanishing lines, the ball fills the picture, and all light comes from far away: that is what a MatCap says of
itself.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from firmware_sim.mitsuba.scenes import film
from firmware_sim.mitsuba.variants import best_variant, load_mitsuba

F64 = NDArray[np.float64]
Direction = tuple[float, float, float]
Rgb = tuple[float, float, float]

SIDE_PX = 256
SAMPLES = 1024
ENVIRONMENT_ROWS = 512
BRIGHTEST = 0.92
"""What the brightest channel of a picture is stored as, in linear light: nothing is clipped."""
WHITE: Rgb = (1.0, 1.0, 1.0)
WARM: Rgb = (1.0, 0.87, 0.7)
COOL: Rgb = (0.72, 0.86, 1.0)


def directions() -> F64:
    """Return the unit vectors (rows, 2·rows, 3) that the pixels of mitsuba's environment map stand for, y up."""
    rows = ENVIRONMENT_ROWS
    down = np.pi * (np.arange(rows) + 0.5)[:, None] / rows
    around = np.pi * (np.arange(2 * rows) + 0.5)[None, :] / rows
    x, z = np.sin(down) * np.sin(around), -np.sin(down) * np.cos(around)
    return np.stack([x, np.broadcast_to(np.cos(down), x.shape), z], axis=-1)


def softbox(towards: Direction, half_sides_deg: tuple[float, float], radiance: float, colour: Rgb = WHITE) -> F64:
    """Return the light of a rectangle with upright sides, seen from the ball."""
    forth = np.array(towards) / np.linalg.norm(towards)
    right = np.cross([0.0, 1.0, 0.0], forth)
    right /= np.linalg.norm(right)
    seen = directions()
    ahead = seen @ forth
    across = np.degrees(np.arctan2(seen @ right, ahead))
    up = np.degrees(np.arctan2(seen @ np.cross(forth, right), ahead))
    # Edges are as soft as the map is coarse.
    inside = _step(half_sides_deg[0] - np.abs(across)) * _step(half_sides_deg[1] - np.abs(up)) * (ahead > 0)
    return inside[..., None] * radiance * np.array(colour)


def lamp(towards: Direction, radius_deg: float, radiance: float, colour: Rgb = WHITE, soft_deg: float = 0.5) -> F64:
    """Return the light of a disc whose edge fades over some degrees."""
    cosine = directions() @ (np.array(towards) / np.linalg.norm(towards))
    off = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
    return _step((radius_deg - off) / soft_deg * 0.5)[..., None] * radiance * np.array(colour)


def sky(zenith: Rgb, horizon: Rgb, ground: Rgb, blend_deg: float) -> F64:
    """Return a gradient from the ground over the horizon to the zenith; the horizon is as soft as `blend_deg`."""
    up = np.degrees(np.arcsin(np.clip(directions()[..., 1:2], -1, 1)))
    above = np.array(horizon) + (np.array(zenith) - np.array(horizon)) * np.clip(up / 90, 0, 1) ** 0.6
    return np.array(ground) + (above - np.array(ground)) * _step(up / blend_deg)


def _step(value: F64) -> F64:
    """Return 0 below −1, 1 above 1, and a smooth way in between."""
    t = np.clip((value + 1) / 2, 0, 1)
    return np.asarray(t * t * (3 - 2 * t))


def plastic(colour: Rgb, alpha: float) -> dict[str, Any]:
    return {
        "type": "roughplastic",
        "distribution": "ggx",
        "alpha": alpha,
        "nonlinear": True,
        "diffuse_reflectance": {"type": "rgb", "value": list(colour)},
    }


def metal(name: str, alpha: float) -> dict[str, Any]:
    return {"type": "roughconductor", "material": name, "distribution": "ggx", "alpha": alpha}


def matcaps() -> dict[str, tuple[dict[str, Any], F64]]:
    """Return name → material and light."""
    dim = sky((0.07, 0.09, 0.13), (0.12, 0.12, 0.12), (0.05, 0.035, 0.03), 25)
    indoors = sky((0.22, 0.26, 0.34), (1.5, 1.2, 0.9), (0.16, 0.09, 0.05), 8)
    windows = softbox((-0.6, 0.55, 0.6), (16, 21), 5.5, WARM) + softbox((0.95, 0.25, 0.1), (7, 30), 5, COOL)
    cool_lamp = lamp((-0.9, 0.1, -0.25), 14, 2.5, COOL, 6)
    boxes = softbox((-0.55, 0.5, 0.7), (14, 20), 8) + softbox((0.9, 0.3, 0.2), (5, 32), 6, COOL)
    strip = softbox((-0.85, 0.2, 0.3), (4, 26), 9, COOL)
    strip_right = softbox((0.9, 0.25, 0.25), (4, 26), 12, COOL)
    open_air = sky((0.16, 0.30, 0.70), (1.0, 1.02, 1.05), (0.13, 0.08, 0.05), 3)
    return {
        "amber": (plastic((0.50, 0.24, 0.05), 0.14), dim + lamp((-0.35, 0.45, 0.8), 6, 50)),
        "clay": (plastic((0.62, 0.33, 0.22), 0.17), dim + lamp((0.6, 0.55, 0.6), 6, 55, WARM) + cool_lamp),
        "cobalt": (plastic((0.04, 0.10, 0.45), 0.16), dim + lamp((0.05, 0.72, 0.65), 8, 34, WARM)),
        "dark": (
            plastic((0.012, 0.012, 0.016), 0.05),
            dim * 1.3 + boxes + softbox((0.25, -0.75, 0.4), (26, 5), 2, WARM),
        ),
        "gold": (metal("Au", 0.12), indoors + windows),
        "jade": (
            plastic((0.07, 0.34, 0.16), 0.11),
            dim + softbox((-0.45, 0.6, 0.65), (9, 9), 30) + lamp((0.9, -0.2, 0.2), 12, 4, COOL, 6),
        ),
        "lacquer": (plastic((0.46, 0.03, 0.02), 0.06), dim + softbox((0.5, 0.62, 0.6), (12, 7), 22) + strip),
        "plaster": (
            {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.7}},
            dim + lamp((-0.4, 0.6, 0.7), 10, 30),
        ),
        "porcelain": (
            plastic((0.72, 0.70, 0.66), 0.07),
            dim * 2.5 + softbox((-0.5, 0.55, 0.65), (15, 17), 14) + strip_right * 0.6,
        ),
        "steel": (metal("Cr", 0.07), open_air + lamp((0.45, 0.6, 0.65), 7, 1.6, WARM)),
    }


def render(material: dict[str, Any], light: F64, side_px: int = SIDE_PX, samples: int = SAMPLES) -> F64:
    """Return the ball's picture (S, S, 3), linear, black where there is no ball."""
    mitsuba = load_mitsuba(best_variant())
    toward_ball = mitsuba.ScalarTransform4f().look_at([0, 0, 4], [0, 0, 0], [0, 1, 0])
    scene = {
        "type": "scene",
        "integrator": {"type": "direct", "hide_emitters": True},
        "sensor": {"type": "orthographic", "to_world": toward_ball, "film": film(side_px, side_px)},
        "ball": {"type": "sphere", "bsdf": material},
        "light": {"type": "envmap", "bitmap": mitsuba.Bitmap(light.astype(np.float32))},
    }
    total, part = np.zeros((side_px, side_px, 4)), 256
    world = mitsuba.load_dict(scene)
    for seed in range(max(1, samples // part)):
        total += np.array(mitsuba.render(world, spp=part, seed=seed))
    rgba = total / max(1, samples // part)
    # The rim is as bright as the ball there; what the disc shows is its own business.
    return np.asarray(rgba[..., :3] / np.maximum(rgba[..., 3:], 1e-3) * (rgba[..., 3:] > 0))


def srgb_u8(linear: F64) -> NDArray[np.uint8]:
    """Return display codes; the brightest light of the picture becomes BRIGHTEST."""
    value = np.clip(linear * (BRIGHTEST / linear.max()), 0, 1)
    shown = np.where(value <= 0.0031308, 12.92 * value, 1.055 * value ** (1 / 2.4) - 0.055)
    return np.asarray(np.round(shown * 255), np.uint8)


def main() -> None:
    folder, *names = sys.argv[1:] or [str(Path(__file__).parent)]
    for name, (material, light) in matcaps().items():
        if names and name not in names:
            continue
        Image.fromarray(srgb_u8(render(material, light))).save(Path(folder) / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main()
