"""What the simulated camera sees in the demo."""

from collections.abc import Mapping
from enum import StrEnum
from typing import Any

from firmware_sim.config import SimConfig


class SceneKind(StrEnum):
    """Who makes the light."""

    ANALYTIC = "analytic"
    MITSUBA = "mitsuba"


def brushed_sphere(kind: SceneKind) -> SimConfig:
    """Return the rig that sees a sphere of brushed metal under fixed lights."""
    scenes: Mapping[SceneKind, Mapping[str, Any]] = {
        SceneKind.ANALYTIC: {"kind": "brushed-sphere"},
        SceneKind.MITSUBA: {"kind": "mitsuba", "sample": "brushed-metal", "lights": "studio"},
    }
    return SimConfig.model_validate({"scene": scenes[kind]})


def relief(kind: SceneKind) -> SimConfig:
    """Return the rig that sees a relief under the lamp on its arm."""
    scenes: Mapping[SceneKind, Mapping[str, Any]] = {
        SceneKind.ANALYTIC: {"kind": "relief"},
        SceneKind.MITSUBA: {"kind": "mitsuba", "sample": "relief", "lights": "lamp", "projection": "orthographic"},
    }
    return SimConfig.model_validate({"scene": scenes[kind], "turntable": {"start_deg": 0.0}})
