"""RIG.toml for the simulated devices, as a person would write it for real ones."""

from firmware_sim.config import ReliefScene, SimConfig, SphereScene

GRBL_BAUD = 115_200


def rig_toml(config: SimConfig, turntable_port: str, arm_port: str) -> str:
    """Describe the running devices.

    Parameters
    ----------
    config : what is simulated
    turntable_port, arm_port : device paths of the serial ports
    """
    table, arm, camera = config.turntable, config.arm, config.camera
    is_relief = isinstance(config.scene, ReliefScene)
    scene = "relief" if is_relief else "brushed sphere"
    lights = 'kind = "grbl-spindle"\npower = 1000' if is_relief else 'kind = "always-on"'
    return f"""\
[rig]
name = "simulated: {scene}"

[turntable]
kind = "dynamixel"
port = "{turntable_port}"
baud = {table.baud}
id = {table.id}
model = "XL430-W250"

[arm]
kind = "grbl"
port = "{arm_port}"
baud = {GRBL_BAUD}
azimuth_origin_deg = {-arm.azimuth_travel_deg:.1f}
elevation_origin_deg = {-arm.elevation_travel_deg:.1f}

[lights]
{lights}

[camera]
kind = "v4l2"
device = "{camera.device}"
width = {camera.width}
height = {camera.height}
fps = {camera.fps}
pixel_format = "{camera.pixel_format}"
exposure_ms = {camera.exposure_ms:.1f}
gain = {camera.gain}
{_sample(config.scene)}"""


def _sample(scene: SphereScene | ReliefScene) -> str:
    if isinstance(scene, ReliefScene) or scene.projection == "orthographic":
        return ""
    return f"\n[sample]\nsphere_distance_radii = {scene.distance_radii:.3f}\n"
