"""What the simulated camera sees in the demo."""

from collections.abc import Mapping
from enum import StrEnum
from typing import Any

from firmware_sim.config import SimConfig
from firmware_sim.mitsuba.variants import FAST, MitsubaMissingError, best_variant

STUDIO_SAMPLES = 32
LAMP_SAMPLES = 16
"""Paths a pixel: a single far lamp makes no noise but at edges."""


class SceneKind(StrEnum):
    """Who makes the light."""

    ANALYTIC = "analytic"
    MITSUBA = "mitsuba"


def best_scene() -> SceneKind:
    """Choose mitsuba where it is installed and runs with LLVM: without, its frames would take many minutes."""
    try:
        fast = best_variant() == FAST
    except MitsubaMissingError:
        fast = False
    return SceneKind.MITSUBA if fast else SceneKind.ANALYTIC


def brushed_sphere(kind: SceneKind) -> SimConfig:
    """Return the rig that sees a sphere of brushed metal under fixed lights."""
    scenes: Mapping[SceneKind, Mapping[str, Any]] = {
        SceneKind.ANALYTIC: {"kind": "brushed-sphere"},
        SceneKind.MITSUBA: {"kind": "mitsuba", "sample": "brushed-metal", "samples": STUDIO_SAMPLES},
    }
    return SimConfig.model_validate({"scene": scenes[kind]})


def relief(kind: SceneKind) -> SimConfig:
    """Return the rig that sees a relief under the lamp on its arm."""
    scenes: Mapping[SceneKind, Mapping[str, Any]] = {
        SceneKind.ANALYTIC: {"kind": "relief"},
        SceneKind.MITSUBA: {
            "kind": "mitsuba",
            "sample": "relief",
            "lights": "lamp",
            "projection": "orthographic",
            "samples": LAMP_SAMPLES,
        },
    }
    return SimConfig.model_validate({"scene": scenes[kind], "turntable": {"start_deg": 0.0}})
