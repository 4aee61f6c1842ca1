"""Pictures of a scene, pose by pose; the scene is loaded once for each picture size and then only moved."""

import zlib
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from firmware_sim.mitsuba import lighting
from firmware_sim.mitsuba.config import MitsubaScene
from firmware_sim.mitsuba.scenes import SAMPLE, flat_pose, scene_dict, sphere_pose
from firmware_sim.mitsuba.slab import slab_mesh
from firmware_sim.mitsuba.variants import best_variant, load_mitsuba
from firmware_sim.scene.pose import F32, Pose, Size

AOV_SAMPLES = 64
WHOLE = 0.999
"""Share of a pixel's samples that must meet the sample for the pixel to count as its."""
BACKDROP = (0.0075, 0.0085, 0.0105)
"""Radiance behind the sample: black cloth."""


class Surface(NamedTuple):
    """What a pixel shows, means over the pixel.

    Attributes
    ----------
    normals : (H, W, 3) float32, unit, view frame
    tangents : (H, W, 3) float32, unit dp_du in the view frame; for the brushed sphere along its brushing
    valid : (H, W) bool, pixels that show the sample and nothing else; elsewhere the vectors have no meaning
    """

    normals: F32
    tangents: F32
    valid: NDArray[np.bool_]


class MitsubaRenderer:
    """Renders one scene with one variant.

    Parameters
    ----------
    scene : what to render
    variant : of mitsuba; the best that works here when None. Pictures of different variants differ in their noise
    """

    def __init__(self, scene: MitsubaScene, variant: str | None = None) -> None:
        self._scene = scene
        self.variant = best_variant() if variant is None else variant
        self._size: Size | None = None
        self._world: Any = None
        self._parameters: Any = None
        self._turned_deg: float | None = None

    def render(self, pose: Pose, size: Size) -> F32:
        """Render the light that falls on the sensor at a pose.

        Parameters
        ----------
        pose : of turntable and lamp; the studio's lights do not move, and the lamp has no place in it
        size : height and width

        Returns
        -------
        linear : (H, W, 3) float32, linear RGB, row 0 on top; 1 fills a pixel in 10 ms without gain. The same scene,
            pose and size give the same bits for one variant, whatever was rendered before.
        """
        mitsuba, world = self._posed(pose, size)
        rgba = np.array(mitsuba.render(world, spp=self._scene.samples, seed=self._seed(pose)), np.float32)
        behind = 1 - np.clip(rgba[..., 3:], 0, 1)
        return np.asarray(rgba[..., :3] + behind * np.array(BACKDROP, np.float32), np.float32)

    def aovs(self, pose: Pose, size: Size) -> Surface:
        """Return normals and tangents that the pixels of `render` show at this pose, without noise."""
        mitsuba, world = self._posed(pose, size)
        integrator = mitsuba.load_dict(
            {"type": "aov", "aovs": "n:sh_normal,t:dp_du", "light": {"type": "direct", "hide_emitters": True}}
        )
        layers = np.array(integrator.render(world, spp=AOV_SAMPLES, seed=self._seed(pose)), np.float32)
        normals, tangents = layers[..., 4:7], layers[..., 7:10]
        return Surface(_unit(normals), _unit(tangents), layers[..., 3] >= WHOLE)

    def _posed(self, pose: Pose, size: Size) -> tuple[Any, Any]:
        """Return the module and its scene, loaded for this size and brought to this pose."""
        mitsuba = load_mitsuba(self.variant)
        if size != self._size:
            self._load(mitsuba, size)
        if pose.turntable_deg != self._turned_deg:
            self._turn(mitsuba, pose)
        if self._scene.lights != "studio":
            self._light(mitsuba, pose)
        self._parameters.update()
        return mitsuba, self._world

    def _load(self, mitsuba: Any, size: Size) -> None:
        self._world = mitsuba.load_dict(scene_dict(mitsuba, self._scene, size))
        self._parameters = mitsuba.traverse(self._world)
        self._size, self._turned_deg = size, None

    def _turn(self, mitsuba: Any, pose: Pose) -> None:
        """Turn the sample about the camera's axis."""
        self._turned_deg = pose.turntable_deg
        match self._scene.sample:
            case "relief":
                rotation = np.array(flat_pose(mitsuba, self._scene, pose).matrix, np.float32)[:3, :3]
                self._turn_slab(rotation)
            case "white-card":
                pass  # the same from all sides, and wider than the picture
            case _:
                self._parameters[f"{SAMPLE}.to_world"] = mitsuba.Transform4f(sphere_pose(mitsuba, self._scene, pose))

    def _turn_slab(self, rotation: F32) -> None:
        slab = slab_mesh()
        self._parameters[f"{SAMPLE}.vertex_positions"] = (slab.positions @ rotation.T).ravel()
        self._parameters.update()
        # mitsuba has just made normals of its own, summed by threads in any order: their last bits change.
        self._parameters[f"{SAMPLE}.vertex_normals"] = (slab.normals @ rotation.T).ravel()

    def _light(self, mitsuba: Any, pose: Pose) -> None:
        """Bring the lamp into place and to its power."""
        if self._scene.lights == "lamp":
            self._parameters["lamp.to_world"] = mitsuba.Transform4f(lighting.far_lamp_pose(mitsuba, pose))
            self._parameters["lamp.irradiance.value"] = np.pi * pose.lamp
            return
        distance = self._scene.lamp_distance_radii
        place = distance * lighting.light_direction(pose.azimuth_deg, pose.elevation_deg)
        self._parameters["lamp.position"] = mitsuba.Point3f(*place.tolist())
        self._parameters["lamp.intensity.value"] = np.pi * distance**2 * pose.lamp

    def _seed(self, pose: Pose) -> int:
        """Return a seed of each pose's own, so that the noise of two slices has nothing in common."""
        return zlib.crc32(np.array(pose[:4], np.float64).tobytes(), self._scene.seed)


def _unit(vectors: F32) -> F32:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.maximum(length, np.float32(1e-12)), np.float32)
