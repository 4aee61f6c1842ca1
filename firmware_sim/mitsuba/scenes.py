"""From a configuration to mitsuba's dictionary: sample at the origin, camera on the z axis."""

import math
from typing import Any

from firmware_sim.mitsuba import lighting, materials
from firmware_sim.mitsuba.config import Brushing, MitsubaScene
from firmware_sim.mitsuba.slab import SlabMesh, slab_mesh
from firmware_sim.scene.pose import Pose, Size

REFERENCE_WIDTH, REFERENCE_HEIGHT = 640, 480
"""The picture that pixel figures in the configuration refer to."""
ORTHOGRAPHIC_DISTANCE = 10.0
POLE_TILTS_DEG: dict[Brushing, float] = {"parallels": 90.0, "circular": 0.0, "tilted-pole": 35.0}
"""Angle between the camera's axis and the axis that the brushing goes about."""
CARD_HALF_SIDE = 8.0
SAMPLE = "sample"
Node = dict[str, Any]


def scene_dict(mitsuba: Any, scene: MitsubaScene, size: Size) -> Node:
    """Describe the scene at turntable zero, with the lamp at the camera."""
    return {
        "type": "scene",
        "integrator": {"type": "direct", "hide_emitters": True},
        "sensor": _sensor(mitsuba, scene, size),
        SAMPLE: _sample(mitsuba, scene),
        **_lights(mitsuba, scene),
    }


def sphere_pose(mitsuba: Any, scene: MitsubaScene, pose: Pose) -> Any:
    """Return the sphere's transformation: its pole is tilted into place, then turned about the camera's axis.

    dp_du of mitsuba's sphere runs along its parallels. With the pole on the silhouette at +x, that is down in the
    picture; hence the quarter turn.
    """
    turn = mitsuba.ScalarTransform4f()
    angle_deg = pose.turntable_deg + scene.tangent_zero_deg + 90
    return turn.rotate([0, 0, 1], angle_deg) @ turn.rotate([0, 1, 0], POLE_TILTS_DEG[scene.brushing])


def flat_pose(mitsuba: Any, scene: MitsubaScene, pose: Pose) -> Any:
    """Return the transformation of what lies flat: turned about the camera's axis."""
    return mitsuba.ScalarTransform4f().rotate([0, 0, 1], pose.turntable_deg + scene.tangent_zero_deg)


def film(width: int, height: int) -> Node:
    """Describe a film whose pixels share no light with their neighbours."""
    return {
        "type": "hdrfilm",
        "width": width,
        "height": height,
        "pixel_format": "rgba",
        "component_format": "float32",
        "rfilter": {"type": "box"},
    }


def _sample(mitsuba: Any, scene: MitsubaScene) -> Any:
    pose = Pose(0, 0, 90, 0)
    match scene.sample:
        case "relief":
            return _slab(mitsuba, slab_mesh())
        case "white-card":
            to_world = mitsuba.ScalarTransform4f().scale([CARD_HALF_SIDE, CARD_HALF_SIDE, 1])
            return {"type": "rectangle", "to_world": to_world, "bsdf": materials.white_card()}
        case "brushed-metal":
            bsdf = materials.brushed_metal(scene)
        case "fabric":
            bsdf = materials.fabric(scene.invariance)
        case "chrome-ball":
            bsdf = materials.chrome()
    return {"type": "sphere", "to_world": sphere_pose(mitsuba, scene, pose), "bsdf": bsdf}


def _slab(mitsuba: Any, slab: SlabMesh) -> Any:
    properties = mitsuba.Properties()
    properties["mesh_bsdf"] = mitsuba.load_dict(materials.slab(mitsuba.Bitmap(slab.colours)))
    mesh = mitsuba.Mesh(
        "slab", len(slab.positions), len(slab.faces), has_vertex_normals=True, has_vertex_texcoords=True,
        props=properties,
    )  # fmt: skip
    parameters = mitsuba.traverse(mesh)
    parameters["vertex_positions"] = slab.positions.ravel()
    parameters["vertex_texcoords"] = slab.texture_places.ravel()
    parameters["faces"] = slab.faces.ravel()
    parameters.update()
    return mesh


def _lights(mitsuba: Any, scene: MitsubaScene) -> Node:
    match scene.lights:
        case "studio":
            return lighting.studio(mitsuba)
        case "lamp":
            return {"room": lighting.dark_room(), "lamp": lighting.far_lamp(mitsuba)}
        case "near-lamp":
            return {"room": lighting.dark_room(), "lamp": lighting.near_lamp(scene.lamp_distance_radii)}


def _sensor(mitsuba: Any, scene: MitsubaScene, size: Size) -> Node:
    height, width = size
    scale = height / REFERENCE_HEIGHT
    off_x = (scene.centre_x_px - REFERENCE_WIDTH / 2) * scale
    off_y = (scene.centre_y_px - REFERENCE_HEIGHT / 2) * scale
    radius = scene.radius_px * scale
    make = _orthographic if scene.projection == "orthographic" else _perspective
    return {
        **make(mitsuba, scene, size, radius, (off_x, off_y)),
        "film": film(width, height),
        "near_clip": 0.1,
        "far_clip": 1e4,
    }


def _perspective(
    mitsuba: Any,
    scene: MitsubaScene,
    size: Size,
    radius_px: float,
    off_px: tuple[float, float],
) -> Node:
    height, width = size
    distance = scene.distance_radii
    outline = math.tan(math.asin(1 / distance)) if _is_ball(scene) else 1 / distance
    return {
        "type": "perspective",
        "fov_axis": "y",
        "fov": math.degrees(2 * math.atan(height / 2 / radius_px * outline)),
        "principal_point_offset_x": -off_px[0] / width,
        "principal_point_offset_y": -off_px[1] / height,
        "to_world": mitsuba.ScalarTransform4f().look_at([0, 0, distance], [0, 0, 0], [0, 1, 0]),
    }


def _orthographic(
    mitsuba: Any,
    scene: MitsubaScene,
    size: Size,
    radius_px: float,
    off_px: tuple[float, float],
) -> Node:
    del scene
    x, y = -off_px[0] / radius_px, off_px[1] / radius_px
    half_width = size[1] / 2 / radius_px
    transform = mitsuba.ScalarTransform4f()
    to_world = transform.look_at([x, y, ORTHOGRAPHIC_DISTANCE], [x, y, 0], [0, 1, 0])
    return {"type": "orthographic", "to_world": to_world @ transform.scale([half_width, half_width, 1])}


def _is_ball(scene: MitsubaScene) -> bool:
    return scene.sample in ("brushed-metal", "fabric", "chrome-ball")
