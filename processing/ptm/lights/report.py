"""What light directions from mirror balls have to say for themselves, for people and for programs."""

from typing import Any

import numpy as np

from litrig.base.directions import angles_from_direction
from processing.ptm.lights.combine import Light
from processing.ptm.lights.estimate import Session


def describe(session: Session) -> list[str]:
    """Say in a few lines what was found, and name every light that wants a look."""
    lines = [
        f"ball {number}: {ball.circle}; {_away(ball.distance_radii)}" for number, ball in enumerate(session.balls, 1)
    ]
    kept = [light for light in session.lights if not light.left_out]
    deviations = np.array([light.deviation_deg for light in kept])
    lines.append(f"lights: {len(kept)} of {len(session.lights)}; each known to {deviations.mean():.2f} deg (estimate)")
    residuals = [light.residual_deg for light in kept if light.residual_deg is not None]
    if residuals:
        lines.append(f"residual between balls: {np.mean(residuals):.2f} deg mean, {np.max(residuals):.2f} deg at most")
    lines += [f"look at {light.name}: {', '.join(light.flags)}" for light in kept if light.flags]
    lines += [f"left out {light.name}: {light.left_out}" for light in session.lights if light.left_out]
    return lines


def facts(session: Session) -> dict[str, Any]:
    """Say the same for programs."""
    return {
        "balls": [
            {
                "circle_px": [ball.circle.x_px, ball.circle.y_px, ball.circle.radius_px],
                "distance_radii": ball.distance_radii,
            }
            for ball in session.balls
        ],
        "lights": [_light(light) for light in session.lights],
    }


def _light(light: Light) -> dict[str, Any]:
    known = light.direction is not None
    return {
        "name": light.name,
        "direction": [float(part) for part in light.direction] if light.direction is not None else None,
        "azimuth_elevation_deg": angles_from_direction(light.direction) if light.direction is not None else None,
        "deviation_deg": light.deviation_deg if known else None,
        "residual_deg": light.residual_deg,
        "flags": list(light.flags),
        "left_out": light.left_out or None,
        "highlights": [
            {
                "ball": sighting.ball + 1,
                "px": [sighting.highlight.x_px, sighting.highlight.y_px],
                "residual_deg": sighting.residual_deg if len(light.sightings) > 1 else None,
                "flags": [str(flag) for flag in sighting.highlight.flags],
            }
            for sighting in light.sightings
        ],
    }


def _away(distance_radii: float | None) -> str:
    return "orthographic" if distance_radii is None else f"camera at {distance_radii:.2f} radii"
