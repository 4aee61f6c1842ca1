"""Operations on the light of a decomposed MatCap (the MatCap paper, section 5.1)."""

from dataclasses import replace
from pathlib import Path
from typing import assert_never

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from litrig.base.errors import InputError
from processing.matcap.highlight import main_highlight
from processing.matcap.lights.image import read_with_coverage
from processing.matcap.lights.model import Direction, Disc, Edge, Hung, Light, Line, Picture, Spot
from processing.matcap.model import Component, DecomposedMatcap, Turn
from processing.matcap.recipe.operations import Align, Hang, Move, One, Paint, Rotate, Spot2, Turns
from processing.matcap.render import seen, turned, warped

F64 = NDArray[np.float64]


class StepError(InputError):
    """A step that cannot be done to this MatCap, though its files are good."""


_ONE_DIRECTION = 1e-6
_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def rotate(matcap: DecomposedMatcap, step: Rotate) -> DecomposedMatcap:
    """Turn both components alike, on top of what they are turned already."""
    axis = np.asarray(_AXES[step.axis] if isinstance(step.axis, str) else step.axis, np.float64)
    axis = axis / np.abs(axis).max()
    turn = Rotation.from_rotvec(axis / np.linalg.norm(axis) * step.degrees, degrees=True)
    return _turned_on(matcap, turn, step.turns)


def align(matcap: DecomposedMatcap, step: Align, other: DecomposedMatcap | None) -> DecomposedMatcap:
    """Turn the light by the smallest rotation that brings the main highlight to a spot, or to `other`'s (figure 14)."""
    here = highlight_direction(matcap)
    if other is not None:
        there = highlight_direction(other)
    else:
        there = warped(_normal(step.at or (0.0, 0.0))[None], matcap.high.slope)[0]
    axis = np.cross(here, there)
    length = float(np.linalg.norm(axis))
    if length < 1e-12:  # where they are opposite, any axis across will do
        axis, length = (np.array([0.0, 0.0, 1.0]), 1.0) if abs(here[2]) < 0.9 else (np.array([0.0, 1.0, 0.0]), 1.0)
    turn = Rotation.from_rotvec(axis / length * np.arccos(np.clip(here @ there, -1, 1)))
    return _turned_on(matcap, turn, Turns.LIGHT)


def highlight_direction(matcap: DecomposedMatcap) -> F64:
    """Return where the main highlight's light comes from, as the light is turned: a unit vector."""
    return np.asarray(turned(main_highlight(matcap.high)[None], matcap.high.light_turn_deg)[0])


def paint(matcap: DecomposedMatcap, step: Paint) -> DecomposedMatcap:
    """Add a light. It stays where it is in the light when the material or the turn changes later.

    Raises
    ------
    StepError
        Both ends of a line or an edge are the same direction, or opposite ones: a sharp material shows straight behind
        all along its rim.
    """
    component = _component(matcap, step.component)
    at = _shown(component, step.at)
    if step.to is not None and np.linalg.norm(np.cross(at, _shown(component, step.to))) < _ONE_DIRECTION:
        raise StepError(
            f"at {step.at[0]:g}, {step.at[1]:g} and to {step.to[0]:g}, {step.to[1]:g} the ball shows the same or "
            f"opposite directions, between which there is no {step.shape}; move one of them"
        )
    light: Light
    match step.shape:
        case "spot":
            light = Spot(colour=step.colour, direction=at, size_deg=step.size_deg)
        case "disc":
            light = Disc(colour=step.colour, direction=at, size_deg=step.size_deg)
        case "line":
            end = _shown(component, step.to or step.at)
            light = Line(colour=step.colour, start=at, end=end, size_deg=step.size_deg)
        case "edge":
            towards = np.asarray(_shown(component, step.to or step.at))
            pole = towards - np.asarray(at) * (towards @ np.asarray(at))
            light = Edge(colour=step.colour, pole=_triple(pole / np.linalg.norm(pole)))
        case _:
            assert_never(step.shape)
    return _with(matcap, step.component, replace(component, lights=(*component.lights, light)))


def hang(matcap: DecomposedMatcap, step: Hang, folder: Path) -> DecomposedMatcap:
    """Hang a picture into the light of one component.

    Raises
    ------
    InputError, FormatError
        The image is missing or damaged.
    """
    component = _component(matcap, step.component)
    picture = Picture(
        colour=step.colour,
        direction=_shown(component, step.at),
        size_deg=step.size_deg,
        turn_deg=step.turn_deg,
        name=step.name,
    )
    texels = read_with_coverage(folder / step.image)
    kept = tuple(hung for hung in component.pictures if not step.name or hung.picture.name != step.name)
    return _with(matcap, step.component, replace(component, pictures=(*kept, Hung(picture, texels))))


def move(matcap: DecomposedMatcap, step: Move) -> DecomposedMatcap:
    """Move what hangs under a name.

    Raises
    ------
    StepError
        Nothing hangs under it.
    """
    found = False
    for which in One:
        component = _component(matcap, which)
        pictures = []
        for hung in component.pictures:
            if hung.picture.name != step.name:
                pictures.append(hung)
                continue
            found = True
            changes = step.model_dump(include={"size_deg", "turn_deg"}, exclude_none=True)
            if step.at is not None:
                changes["direction"] = _shown(component, step.at)
            pictures.append(replace(hung, picture=hung.picture.model_copy(update=changes)))
        matcap = _with(matcap, which, replace(component, pictures=tuple(pictures)))
    if not found:
        raise StepError(f"no picture hangs under the name {step.name!r}; hang it first")
    return matcap


def _turned_on(matcap: DecomposedMatcap, turn: Rotation, turns: Turns) -> DecomposedMatcap:
    def after(before: Turn) -> Turn:
        return _triple((turn * Rotation.from_rotvec(before, degrees=True)).as_rotvec(degrees=True))

    def one(component: Component) -> Component:
        if turns is Turns.LIGHT:
            return replace(component, light_turn_deg=after(component.light_turn_deg))
        return replace(component, normal_turn_deg=after(component.normal_turn_deg))

    return replace(matcap, low=one(matcap.low), high=one(matcap.high))


def _shown(component: Component, spot: Spot2) -> Direction:
    """Return the direction, in the maps, that the ball shows at x and y."""
    return _triple(seen(component, _normal(spot)[None])[0])


def _normal(spot: Spot2) -> F64:
    x, y = spot
    return np.array([x, y, np.sqrt(max(1 - x * x - y * y, 0.0))])


def _component(matcap: DecomposedMatcap, which: One) -> Component:
    return matcap.low if which is One.LOW else matcap.high


def _with(matcap: DecomposedMatcap, which: One, component: Component) -> DecomposedMatcap:
    return replace(matcap, low=component) if which is One.LOW else replace(matcap, high=component)


def _triple(vector: F64) -> tuple[float, float, float]:
    x, y, z = (float(part) for part in vector)
    return x, y, z
