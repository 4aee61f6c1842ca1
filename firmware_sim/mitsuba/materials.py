"""What samples are made of, as mitsuba dictionaries."""

import math
from typing import Any

from firmware_sim.mitsuba.config import Invariance, MitsubaScene

METALS = {"aluminium": "Al", "gold": "Au"}
CHROME_ROUGHNESS = 0.02
"""Not quite a mirror, which would show nothing at all of a lamp without extent."""
CARD_ALBEDO = 0.9
PAINT_ALBEDO = 0.7
THREAD_TILT_DEG = 26.0
THREAD_ROUGHNESS = 0.16
THREAD_SHEEN, THREAD_DEPTH = (0.95, 0.50, 0.40), (0.45, 0.06, 0.07)
DIFFUSE_SHARE = 0.3

Material = dict[str, Any]


def brushed_metal(scene: MitsubaScene) -> Material:
    """Return GGX microfacets with two roughnesses (Walter et al. 2007), u along the brushing, over a diffuse share."""
    gloss = {
        "type": "roughconductor",
        "material": METALS[scene.metal],
        "distribution": "ggx",
        "alpha_u": scene.roughness_along,
        "alpha_v": scene.roughness_across,
    }
    if not scene.diffuse_share:
        return gloss
    paint = {"type": "diffuse", "reflectance": {"type": "rgb", "value": PAINT_ALBEDO}}
    return {"type": "blendbsdf", "weight": scene.diffuse_share, "first": gloss, "second": paint}


def chrome() -> Material:
    return {"type": "roughconductor", "material": "Cr", "distribution": "ggx", "alpha": CHROME_ROUGHNESS}


def white_card() -> Material:
    return {"type": "diffuse", "reflectance": {"type": "rgb", "value": CARD_ALBEDO}}


def slab(colours: Any) -> Material:  # a bitmap of mitsuba's
    """Return glazed stone of these colours over the mesh's texture coordinates."""
    return {
        "type": "roughplastic",
        "distribution": "ggx",
        "alpha": 0.18,
        "nonlinear": False,
        "diffuse_reflectance": {"type": "bitmap", "bitmap": colours, "raw": True},
    }


def fabric(invariance: Invariance, turned_deg: float = 0.0) -> Material:
    """Return a weave seen from afar: R equal lobes, tilted off the normal at azimuths 360·i/R from the tangent.

    Turned by 360/R the lobes change places, so that R is exact in the tangent plane. "isotropic" is one upright lobe.
    A share of the light goes in deeper and comes out diffuse.

    Parameters
    ----------
    turned_deg : azimuth of the first lobe
    """
    if invariance == "isotropic":
        return _with_depth(_thread())
    lobes = [_tilted(_thread(), turned_deg + 360 * i / invariance) for i in range(invariance)]
    return _with_depth(_even_mixture(lobes))


def _thread() -> Material:
    return {
        "type": "roughconductor",
        "material": "none",
        "distribution": "ggx",
        "alpha": THREAD_ROUGHNESS,
        "specular_reflectance": {"type": "rgb", "value": list(THREAD_SHEEN)},
    }


def _with_depth(gloss: Material) -> Material:
    diffuse = {"type": "diffuse", "reflectance": {"type": "rgb", "value": list(THREAD_DEPTH)}}
    return {"type": "blendbsdf", "weight": DIFFUSE_SHARE, "first": gloss, "second": diffuse}


def _tilted(material: Material, azimuth_deg: float) -> Material:
    """Tilt a material's normal by a normal map of one colour."""
    tilt, azimuth = math.radians(THREAD_TILT_DEG), math.radians(azimuth_deg)
    normal = (math.sin(tilt) * math.cos(azimuth), math.sin(tilt) * math.sin(azimuth), math.cos(tilt))
    return {
        "type": "normalmap",
        "normalmap": {"type": "rgb", "value": [(component + 1) / 2 for component in normal]},
        "bsdf": material,
    }


def _even_mixture(materials: list[Material]) -> Material:
    """Nest two-material blends so that each of them has the same share."""
    mixture = materials[0]
    for number, material in enumerate(materials[1:], 2):
        mixture = {"type": "blendbsdf", "weight": 1 / number, "first": mixture, "second": material}
    return mixture
