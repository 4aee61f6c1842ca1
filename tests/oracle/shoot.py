"""Captures of scenes that mitsuba rendered: plain folders, as any camera would have left them."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from firmware_sim.mitsuba.config import Brushing, Invariance, MitsubaScene
from firmware_sim.mitsuba.renderer import MitsubaRenderer
from firmware_sim.scene.pose import Pose
from litrig.base.capture_folder.capture import Capture
from litrig.base.capture_folder.reader import ANGLES, read_capture
from litrig.base.lights import Lights
from litrig.base.lp import write_lp
from litrig.base.pictures import write_picture
from litrig.base.table_normals import TableNormal
from processing.amc.build import AmcResult, build, build_split
from processing.amc.settings import Settings
from processing.outline.circle import Circle
from tests.oracle.compare import Truth

F64 = NDArray[np.float64]

SLICES = 32
"""A turn: 16 slices of what repeats at half a turn."""
LIGHTS = 50
TRUTH_FACTOR = 4
"""How many more samples a truth gets than a slice, for it is compared alone."""
TRUTH_ANGLE_DEG = 17.0
LAMP_SHARE = 0.25
"""Part of the samples that pictures of a lamp alone need, which has no extent to be noisy about."""
STILL = Pose(0.0, 0.0, 90.0, 0.0)
ORTHOGRAPHIC = {"projection": "orthographic"}

OTHER_BRUSHINGS: tuple[Brushing, ...] = ("circular", "tilted-pole")
METALS = {
    "rough aluminium": MitsubaScene(radius_px=200),
    "fine aluminium": MitsubaScene(radius_px=200, roughness_along=0.06, roughness_across=0.25),
    "gold": MitsubaScene(radius_px=200, metal="gold"),
}
FABRIC = MitsubaScene(sample="fabric", invariance=2, radius_px=200)
MATERIALS = {**METALS, "weave": FABRIC}
BOTH = MitsubaScene(radius_px=200, diffuse_share=0.7, roughness_along=0.06, roughness_across=0.25)
"""Thin metal over matt paint: diffuse light and gloss in one."""
FABRICS: tuple[Invariance, ...] = (1, 2, 3, 4, "isotropic")
CHROME = MitsubaScene(sample="chrome-ball", lights="lamp", radius_px=190)
RELIEF = MitsubaScene(sample="relief", lights="lamp", projection="orthographic")


Way = TableNormal | None
"""How a perspective picture is brought to the table; None crops it as if it were orthographic."""
NAIVE: Way = None


@dataclass
class Studio:
    """Renders captures and truths of one size and quality, each once.

    Attributes
    ----------
    variant : of mitsuba
    side_px : side of the square pictures
    samples : paths a pixel of a slice
    folder : where captures are written
    """

    variant: str
    side_px: int
    samples: int
    folder: Path
    _captures: dict[MitsubaScene, Capture] = field(default_factory=dict)
    _truths: dict[MitsubaScene, Truth] = field(default_factory=dict)
    _tables: dict[tuple[MitsubaScene, Way], AmcResult] = field(default_factory=dict)
    _splits: dict[MitsubaScene, tuple[AmcResult, AmcResult]] = field(default_factory=dict)

    def capture(self, scene: MitsubaScene) -> Capture:
        """Capture a turn in the studio's light, or the sample under many lamps."""
        share = 1 if scene.lights == "studio" else LAMP_SHARE
        scene = _changed(scene, samples=max(1, round(share * self.samples)))
        if scene not in self._captures:
            folder = self.folder / f"capture_{len(self._captures):02d}"
            folder.mkdir()
            shoot = _shoot_turn if scene.lights == "studio" else _shoot_lights
            shoot(MitsubaRenderer(scene, self.variant), self.side_px, folder)
            self._captures[scene] = read_capture(folder)
        return self._captures[scene]

    def table(self, scene: MitsubaScene, way: Way) -> AmcResult:
        """Build the AMC of a turn, with normals brought to the table in some way; the circle is the promised one."""
        if (scene, way) not in self._tables:
            distance = None if way is NAIVE else scene.distance_radii
            settings = self._settings(scene, distance, way or TableNormal.RECTIFIED)
            self._tables[scene, way] = build(self.capture(scene), settings)
        return self._tables[scene, way]

    def split(self, scene: MitsubaScene) -> tuple[AmcResult, AmcResult]:
        """Build the low and the high table of a turn."""
        if scene not in self._splits:
            settings = self._settings(scene, scene.distance_radii, TableNormal.RECTIFIED)
            self._splits[scene] = build_split(self.capture(scene), settings)
        return self._splits[scene]

    def _settings(self, scene: MitsubaScene, distance_radii: float | None, normal: TableNormal) -> Settings:
        circle = self.circle(scene)
        return Settings(size=self.side_px, circle=circle, distance_radii=distance_radii, table_normal=normal)

    def truth(self, scene: MitsubaScene, brushing: Brushing, seed: int = 2) -> Truth:
        """Render the orthographic picture of another brushing, at an angle that no slice has."""
        changes = {"brushing": brushing, "tangent_zero_deg": TRUTH_ANGLE_DEG, "seed": seed}
        scene = _changed(scene, **ORTHOGRAPHIC, **changes, samples=TRUTH_FACTOR * self.samples)
        if scene not in self._truths:
            renderer = MitsubaRenderer(scene, self.variant)
            size = (self.side_px, self.side_px)
            self._truths[scene] = Truth(renderer.render(STILL, size), renderer.aovs(STILL, size))
        return self._truths[scene]

    def circle(self, scene: MitsubaScene) -> Circle:
        """Return the silhouette that the scene promises."""
        scale, middle = self.side_px / 480, self.side_px / 2
        x_px, y_px = middle + (scene.centre_x_px - 320) * scale, middle + (scene.centre_y_px - 240) * scale
        return Circle(x_px, y_px, scene.radius_px * scale)


def seen_from(scene: MitsubaScene, distance_radii: float | None) -> MitsubaScene:
    """Place the camera; None for an orthographic one."""
    if distance_radii is None:
        return _changed(scene, **ORTHOGRAPHIC)
    return _changed(scene, projection="perspective", distance_radii=distance_radii)


def lamp_poses(count: int) -> list[Pose]:
    """Spread the lamp over the dome by the golden angle, from 22 degrees above the table up to 85."""
    heights = np.linspace(np.sin(np.radians(22)), np.sin(np.radians(85)), count)
    return [Pose(0.0, 137.508 * i % 360, float(np.degrees(np.arcsin(h))), 1.0) for i, h in enumerate(heights)]


def lamp_directions(poses: Sequence[Pose]) -> F64:
    """Return unit vectors (N, 3) to the lamp."""
    a, e = np.radians([[pose.azimuth_deg, pose.elevation_deg] for pose in poses]).T
    return np.stack([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)], axis=1)


def _changed(scene: MitsubaScene, **changes: object) -> MitsubaScene:
    return MitsubaScene.model_validate({**scene.model_dump(), **changes})


def _shoot_turn(renderer: MitsubaRenderer, side_px: int, folder: Path) -> None:
    """Turn the sample once and write a picture an angle, linear, with angles.csv."""
    lines = ["name,deg"]
    for index in range(SLICES):
        angle_deg = 360 * index / SLICES
        name = f"slice_{index:03d}.exr"
        write_picture(folder / name, renderer.render(STILL._replace(turntable_deg=angle_deg), (side_px, side_px)))
        lines.append(f"{name},{angle_deg:.6f}")
    (folder / ANGLES).write_text("\n".join(lines) + "\n", encoding="utf-8")


def _shoot_lights(renderer: MitsubaRenderer, side_px: int, folder: Path) -> None:
    """Light the sample from many sides and write a picture a light, linear, with the `.lp`."""
    poses = lamp_poses(LIGHTS)
    names = tuple(f"light_{index:03d}.exr" for index in range(LIGHTS))
    for name, pose in zip(names, poses, strict=True):
        write_picture(folder / name, renderer.render(pose, (side_px, side_px)))
    write_lp(folder / "lights.lp", Lights(names, lamp_directions(poses)))
