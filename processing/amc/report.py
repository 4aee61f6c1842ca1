"""What a build has to say for itself, for people and for programs."""

from typing import Any

import numpy as np

from processing.amc.build import AmcResult
from processing.amc.model import TangentAngle

_WORST_SHOWN = 3
_GAP = 1.6
"""Step between neighbouring angles, in units of the usual one, that a missing frame makes."""
_LOUD, _LOUD_SHARE = 8.0, 0.05
"""Residual in units of the noise and of the mean light that is worth a word."""


def describe(result: AmcResult) -> list[str]:
    """Say in a few lines what was found and how well the table fits its slices."""
    return [*_sphere(result), *_gap(result), *_flaws(result), *_change(result), *_verdict(result), *_fit(result)]


def facts(result: AmcResult) -> dict[str, Any]:
    """Say the same for programs."""
    circle, orbit, found = result.outline.circle, result.outline.orbit, result.invariance
    return {
        "circle_px": [circle.x_px, circle.y_px, circle.radius_px],
        "axis_px": [orbit.axis_x_px, orbit.axis_y_px],
        "axis_offset_px": orbit.offset_px,
        "wobble_px": orbit.left_over_px,
        "distance_radii": result.distance_radii,
        "invariance": result.amc.invariance,
        "found": found.found,
        "confidence": found.confidence,
        "change": found.variation,
        "change_over_noise": found.over_noise,
        "noise": found.noise,
        "outside": {
            str(entry.repeats): {"surface": entry.outside_surface, "picture": entry.outside_picture}
            for entry in found.evidence
        },
        "tangent_angle": str(result.amc.tangent_angle),
        "table_normal": str(result.amc.table_normal),
        "depth": len(result.amc.slices),
        "size": result.amc.slices.shape[1],
        "coverage": result.coverage,
        "filled": result.flaws.filled,
        "residuals": [float(residual) for residual in result.residuals],
        "slice_angles_deg": list(result.amc.slice_angles_deg),
    }


def _sphere(result: AmcResult) -> list[str]:
    away = "orthographic" if result.distance_radii is None else f"camera at {result.distance_radii:.2f} radii"
    remark = result.outline.orbit.remark()
    return [f"sphere: {result.outline.circle}; {away}", *([remark] if remark else [])]


def _gap(result: AmcResult) -> list[str]:
    """Say where frames are missing that the series over the turn has bridged."""
    angles = np.unique(np.round(np.mod(result.amc.slice_angles_deg, 360), 3))
    steps = np.diff(np.append(angles, angles[0] + 360))
    widest = int(np.argmax(steps))
    if steps[widest] < _GAP * np.median(steps):
        return []
    after = (angles[widest] + steps[widest]) % 360
    return [f"no frame between {angles[widest]:.1f} and {after:.1f} deg: read off the others' series over the turn"]


def _flaws(result: AmcResult) -> list[str]:
    flaws = result.flaws
    if not flaws.filled:
        return []
    disc = max(1, int(result.amc.valid[0].sum()))
    return [
        f"flaws: {flaws.turning.sum() / disc:.1%} of the sphere in marks that turn with it, "
        f"{flaws.still.sum() / disc:.1%} in pixels that stand still; {flaws.filled:.1%} of all values were filled"
    ]


def _change(result: AmcResult) -> list[str]:
    found = result.invariance
    return [
        f"change over the turn: {found.variation:.1%} of the mean light, noise {found.noise:.1e} a texel",
        *(
            f"  R = {entry.repeats}: {entry.outside_surface:.1%} of the change contradicts it in the surface, "
            f"{entry.outside_picture:.1%} in the picture"
            for entry in found.evidence[1:]
        ),
    ]


def _verdict(result: AmcResult) -> list[str]:
    found, chosen = result.invariance, result.amc.invariance
    said = "isotropic" if chosen == "isotropic" else f"R = {chosen}"
    if found.found == "cannot tell":
        why = "the change is too little over the noise, or the slices too few, to tell R"
        return [f"{said}: {why}; every slice is kept" if chosen == 1 else f"{said}, as asked for ({why})"]
    if chosen != found.found:
        return [f"{said}, as asked for (found: {found.found})"]
    where = "; k counts the tangent's angle in the surface" if result.amc.tangent_angle is TangentAngle.SURFACE else ""
    return [said, f"  the same in {found.confidence:.0%} of resamplings of the sphere{where}"]


def _fit(result: AmcResult) -> list[str]:
    worst = np.argsort(result.residuals)[::-1][:_WORST_SHOWN]
    angles = ", ".join(
        f"{result.amc.slice_angles_deg[index]:.1f} deg ({result.residuals[index]:.1e})" for index in worst
    )
    mean = float(np.sqrt(np.mean(result.residuals**2)))
    lines = [f"residual: {mean:.1e} RMS a slice; worst {angles}; {result.coverage:.0%} of the disc seen"]
    if mean > _LOUD * result.invariance.noise and mean > _LOUD_SHARE * float(result.amc.slices.mean()):
        lines.append(
            f"that is {mean / max(result.invariance.noise, 1e-9):.0f} times the noise: shoot more slices for such a "
            "sharp gloss, see whether the R is right, and look at the worst slices"
        )
    return lines
