"""What the window shows, and how it answers to hand and key: values in, values out, without a window.

Everything that is seen follows from a `Shown`; the `Hand` that holds it answers to events with the next one.
"""

import math
from dataclasses import dataclass, replace
from enum import Enum

from viewer.view import MARGIN, Projection, View
from viewer.window.turn import Spot, Turn, about, angles_deg, arc, of_angles, then

Light = tuple[float, float]

ZOOM_LIMITS = (0.1, 64.0)
ZOOM_A_NOTCH = 1.15
LOWEST_LIGHT = 0.999
"""The light stops this far from the middle of its disc, 2.6 degrees above the surface."""
KEY_TURN_DEG = 10.0
START_TURN = of_angles(0, 30)
"""As `litrig render` shows a mesh."""


class Button(Enum):
    """What a mouse button, or the way it is held, is for."""

    OBJECT = "object"
    LIGHT = "light"


@dataclass(frozen=True)
class Shown:
    """All that a picture follows from, beside the material and the picture's size.

    Attributes
    ----------
    mesh : name of a builtin mesh, or a mesh file; None is a PTM flat
    turn : of the object, before a camera and under light that stand still; a flat picture is not turned
    pan : where a flat picture's middle is
    light : x and y of the unit vector to the light, view frame; None if the material has its light in it
    """

    mesh: str | None
    light: Light | None = None
    turn: Turn = START_TURN
    projection: Projection = Projection.PERSPECTIVE
    zoom: float = 1.0
    pan: Spot = (0.0, 0.0)

    @property
    def view(self) -> View:
        """The view, rounded to what can be typed: `litrig render` is given the very same."""
        yaw, pitch, roll = (round(angle, 3) + 0.0 for angle in angles_deg(self.turn))
        return View(self.projection, yaw, pitch, zoom=round(self.zoom, 4), roll_deg=roll)


@dataclass(frozen=True)
class Grip:
    """A drag under way."""

    button: Button
    start: Spot
    before: Shown


@dataclass(frozen=True)
class Hand:
    """What is shown, and what is being done to it.

    Attributes
    ----------
    meshes : what can be chosen; None is flat
    home : what resetting the view goes back to
    """

    shown: Shown
    meshes: tuple[str | None, ...]
    home: Shown
    grip: Grip | None = None

    def pressed(self, button: Button, spot: Spot) -> "Hand":
        """Take hold of the object or of the light; the light comes to the spot at once."""
        if button is Button.LIGHT and self.shown.light is None:
            return self
        return replace(self, grip=Grip(button, spot, self.shown)).dragged(spot)

    def dragged(self, spot: Spot) -> "Hand":
        """Move what is held. The same spot gives the same picture, by whatever way the hand came there."""
        if self.grip is None:
            return self
        if self.grip.button is Button.LIGHT:
            return self.lit_from(spot)
        before, start = self.grip.before, self.grip.start
        if self.shown.mesh is None:
            pan = (before.pan[0] + spot[0] - start[0], before.pan[1] + spot[1] - start[1])
            return self._with(replace(self.shown, pan=pan))
        turn = then(before.turn, arc(start, spot, ball_radius(before.zoom)))
        return self._with(replace(self.shown, turn=turn))

    def released(self) -> "Hand":
        return replace(self, grip=None)

    def scrolled(self, notches: float, spot: Spot) -> "Hand":
        """Zoom, and let go; what is under the spot of a flat picture stays there."""
        wanted = self.shown.zoom * ZOOM_A_NOTCH**notches
        zoom = min(max(wanted, ZOOM_LIMITS[0]), ZOOM_LIMITS[1])
        if self.shown.mesh is not None:
            return replace(self, shown=replace(self.shown, zoom=zoom), grip=None)
        grown = zoom / self.shown.zoom
        x, y = (there - (there - middle) * grown for there, middle in zip(spot, self.shown.pan, strict=True))
        return replace(self, shown=replace(self.shown, zoom=zoom, pan=(x, y)), grip=None)

    def lit_from(self, light: Light) -> "Hand":
        """Move the light, where it can move, to a spot of the unit disc, or to the rim towards it."""
        if self.shown.light is None:
            return self
        distance = math.hypot(*light)
        shrunk = min(1.0, LOWEST_LIGHT / distance) if distance else 1.0
        x, y = (round(part * shrunk, 4) + 0.0 for part in light)
        return self._with(replace(self.shown, light=(x, y)))

    def turned_by(self, right: int, up: int) -> "Hand":
        """Turn the object by steps of keys: its front to the right, and up."""
        if self.shown.mesh is None:
            return self
        step = math.radians(KEY_TURN_DEG)
        turn = then(then(self.shown.turn, about((0, 1, 0), right * step)), about((1, 0, 0), -up * step))
        return self._with(replace(self.shown, turn=turn))

    def on_mesh(self, mesh: str | None) -> "Hand":
        """Choose a mesh; between meshes the turn stays, to and from flat the zoom starts anew."""
        if mesh == self.shown.mesh:
            return self
        shown = replace(self.shown, mesh=mesh)
        if mesh is None or self.shown.mesh is None:
            shown = replace(shown, zoom=1.0, pan=(0.0, 0.0))
        return replace(self, shown=shown, grip=None)

    def on_next_mesh(self, step: int = 1) -> "Hand":
        place = self.meshes.index(self.shown.mesh)
        return self.on_mesh(self.meshes[(place + step) % len(self.meshes)])

    def in_projection(self, projection: Projection) -> "Hand":
        return self._with(replace(self.shown, projection=projection))

    def in_other_projection(self) -> "Hand":
        flat_rays = self.shown.projection is Projection.ORTHOGRAPHIC
        return self.in_projection(Projection.PERSPECTIVE if flat_rays else Projection.ORTHOGRAPHIC)

    def reset(self) -> "Hand":
        """Go back to how it was at first, on the mesh that is shown."""
        return replace(self, shown=replace(self.home, mesh=self.shown.mesh), grip=None)

    def _with(self, shown: Shown) -> "Hand":
        return replace(self, shown=shown)


def start(mesh: str | None, meshes: tuple[str | None, ...], light: Light | None) -> Hand:
    """Begin with a mesh, among those that can be chosen."""
    home = Shown(mesh, light)
    choice = meshes if mesh in meshes else (mesh, *meshes)
    return Hand(home, choice, home)


def ball_radius(zoom: float) -> float:
    """Return the trackball's radius, the unit sphere's, so that a sphere follows the hand; never a tiny one."""
    return max(zoom, 0.5) / MARGIN
