"""Scenes of the Shape paper's figures, rendered by mitsuba with all buffers, in mitsuba's own files."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from firmware_sim.mitsuba.materials import Material
from firmware_sim.mitsuba.scenes import film
from processing.mesh.model import Mesh
from tests.oracle.first_hit import PLUGIN, load_first_hit
from tests.oracle.shape_light import PROBES, cells
from tests.oracle.shape_meshes import SHAPES

F32 = NDArray[np.float32]
Vector = tuple[float, float, float]
Probe = Literal["soft", "windows"]
AOVS = "position:position,shape_index:shape_index"
PASS_SAMPLES = 64
"""Samples a pixel that are rendered at once; memory is no question then."""
FOV_DEG = 24.0


def _plastic(red: float, green: float, blue: float, alpha: float) -> Material:
    colour = {"type": "rgb", "value": [red, green, blue]}
    return {"type": "roughplastic", "nonlinear": False, "alpha": alpha, "diffuse_reflectance": colour}


MATERIALS: dict[str, Material] = {
    "red": _plastic(0.55, 0.05, 0.03, 0.08),
    "white": _plastic(0.6, 0.6, 0.55, 0.05),
    "black": _plastic(0.03, 0.03, 0.04, 0.15),
    "grey": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.35}},
    "brass": {"type": "roughconductor", "material": "Au", "distribution": "ggx", "alpha": 0.1},
    "matt and metal": {
        "type": "blendbsdf",
        "weight": 0.5,
        "first": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.8}},
        "second": {"type": "roughconductor", "material": "Al", "distribution": "ggx", "alpha": 0.12},
    },
}
"""Diffuse and reflected light of the last are each half of what a matt and a metal thing would show."""


@dataclass(frozen=True)
class Thing:
    """Something in a scene.

    Attributes
    ----------
    shape, material : names in `SHAPES` and `MATERIALS`
    place : where the middle of its unit sphere is
    tilt_deg, turn_deg : about x, towards the camera, then about y
    bumps : Voronoi cells round it and along it, and their height for size 1; None is smooth
    """

    shape: str
    material: str
    place: Vector = (0.0, 0.0, 0.0)
    size: float = 1.0
    tilt_deg: float = 0.0
    turn_deg: float = 0.0
    bumps: tuple[int, int, float] | None = None


@dataclass(frozen=True)
class Scene:
    """Things in the light of a probe.

    Attributes
    ----------
    floor : height of a grey floor; None is none
    shadows : whether anything is in the way of light; without, there is no light but the probe's
    eye, towards : where the camera stands and looks, y up
    half_width : of an orthographic picture; None is perspective
    """

    things: tuple[Thing, ...]
    probe: Probe
    floor: float | None = None
    shadows: bool = True
    eye: Vector = (0.0, 1.2, 5.6)
    towards: Vector = (0.0, 0.0, 0.0)
    half_width: float | None = None

    def with_bumps(self, index: int, bumps: tuple[int, int, float]) -> "Scene":
        things = [replace(one, bumps=bumps) if i == index else one for i, one in enumerate(self.things)]
        return replace(self, things=tuple(things))


@dataclass(frozen=True)
class Render:
    """What mitsuba rendered: planes (H, W) by its own names, and where the camera stood."""

    planes: dict[str, F32]
    world_to_camera: NDArray[np.float64]

    def layer(self, name: str, channels: str = "RGB") -> F32:
        """Return a layer (H, W, C); the picture's has no name."""
        return np.stack([self.planes[f"{name}.{one}" if name else one] for one in channels], axis=-1)

    def write(self, mitsuba: Any, path: Path) -> Path:
        """Write a multi-layer EXR by mitsuba, and its matrix beside it as text, for no file of mitsuba's has that.

        Returns
        -------
        matrix : the text file
        """
        stacked = np.stack(list(self.planes.values()), axis=-1)
        bitmap = mitsuba.Bitmap(stacked, mitsuba.Bitmap.PixelFormat.MultiChannel, list(self.planes))
        bitmap.write(str(path))
        matrix = path.with_suffix(".txt")
        np.savetxt(matrix, self.world_to_camera)
        return matrix

    def surface_of(self, thing: Thing) -> int:
        """Return the number under which mitsuba shows a thing: that of the surface about its place."""
        numbers = self.planes["shape_index.I"]
        away = np.linalg.norm(self.layer("position", "XYZ") - np.array(thing.place), axis=-1)
        near = numbers[(away < 1.05 * thing.size) & (numbers > 0) & (numbers == np.rint(numbers))]
        return int(np.argmax(np.bincount(near.astype(np.int64))))


def render(scene: Scene, variant: str, side_px: int, samples: int, seed: int = 1) -> Render:
    """Render a picture of side_px × side_px with all its buffers; the same seed looks through the same points."""
    mi = load_first_hit(variant)
    loaded = mi.load_dict(_dictionary(mi, scene, side_px))
    passes = max(1, round(samples / PASS_SAMPLES))
    total: Any = 0
    for index in range(passes):
        mi.render(loaded, spp=min(samples, PASS_SAMPLES), seed=1000 * seed + index)
        total = total + np.array(loaded.sensors()[0].film().bitmap(), np.float64)
    names = [field.name for field in loaded.sensors()[0].film().bitmap().struct_()]
    planes = {name: np.ascontiguousarray(total[..., i] / passes, np.float32) for i, name in enumerate(names)}
    to_world = np.array(loaded.sensors()[0].world_transform().matrix, np.float64).reshape(4, 4)
    return Render(planes, np.asarray(np.linalg.inv(to_world), np.float64))


def _dictionary(mi: Any, scene: Scene, side_px: int) -> dict[str, Any]:
    transform = mi.ScalarTransform4f()
    look = transform.look_at(list(scene.eye), list(scene.towards), [0, 1, 0])
    if scene.half_width is None:
        sensor: dict[str, Any] = {"type": "perspective", "fov": FOV_DEG, "to_world": look, "near_clip": 0.1}
    else:
        scaled = look @ transform.scale([scene.half_width, scene.half_width, 1])
        sensor = {"type": "orthographic", "to_world": scaled, "near_clip": 0.001}
    integrator = {"type": PLUGIN, "max_depth": 4 if scene.shadows else 2, "shadows": scene.shadows}
    described = {
        "type": "scene",
        "integrator": {"type": "aov", "aovs": AOVS, "first_hit": integrator},
        "sensor": {**sensor, "film": film(side_px, side_px), "sampler": {"type": "independent"}},
        "light": {"type": "envmap", "bitmap": mi.Bitmap(PROBES[scene.probe]())},
        **{f"thing_{index}": _shape(mi, thing) for index, thing in enumerate(scene.things)},
    }
    if scene.floor is not None:
        flat = transform.translate([0, scene.floor, 0]) @ transform.rotate([1, 0, 0], -90) @ transform.scale(6)
        described["floor"] = {"type": "rectangle", "to_world": flat, "bsdf": MATERIALS["grey"]}
    return described


def _shape(mi: Any, thing: Thing) -> Any:
    mesh: Mesh = SHAPES[thing.shape]()
    turn = _turned(thing)
    properties = mi.Properties()
    properties["mesh_bsdf"] = mi.load_dict(_material(mi, thing))
    made = mi.Mesh(
        thing.shape,
        len(mesh.positions),
        len(mesh.triangles),
        has_vertex_normals=True,
        has_vertex_texcoords=True,
        props=properties,
    )
    parameters = mi.traverse(made)
    parameters["vertex_positions"] = (thing.size * mesh.positions @ turn.T + np.array(thing.place)).ravel()
    parameters["vertex_normals"] = (mesh.normals @ turn.T).ravel()
    parameters["vertex_texcoords"] = mesh.uvs.ravel()
    parameters["faces"] = mesh.triangles.ravel()
    parameters.update()
    return made


def _material(mi: Any, thing: Thing) -> Material:
    material = MATERIALS[thing.material]
    if thing.bumps is None:
        return material
    around, along, height = thing.bumps
    texture = {"type": "bitmap", "bitmap": mi.Bitmap(cells(around, along)), "raw": True}
    return {"type": "bumpmap", "heights": texture, "scale": height * thing.size, "bsdf": material}


def _turned(thing: Thing) -> NDArray[np.float64]:
    tilt, turn = np.radians([thing.tilt_deg, thing.turn_deg])
    about_x = np.array([[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]])
    about_y = np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]])
    return np.asarray(about_y @ about_x)
