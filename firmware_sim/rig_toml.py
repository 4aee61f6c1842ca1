"""RIG.toml for the simulated devices, as a person would write it for real ones."""

from firmware_sim.config import ReliefScene, SimConfig, SphereScene
from firmware_sim.grbl.stepper import stepper_toml
from firmware_sim.mitsuba.config import MitsubaScene
from firmware_sim.udmx.rig_toml import dome_toml

GRBL_BAUD = 115_200
FLAT_SAMPLES = ("relief", "white-card")


def rig_toml(config: SimConfig, turntable_port: str, arm_port: str, usb_address: str = "") -> str:
    """Describe the running devices.

    Parameters
    ----------
    config : what is simulated
    turntable_port, arm_port : device paths of the serial ports
    usb_address : of the USB bus
    """
    camera = config.camera
    lights = _on_the_arm(config, arm_port) if config.dome is None else dome_toml(config.dome, usb_address)
    return f"""\
[rig]
name = "simulated: {_name(config.scene)}"

{_turntable(config, turntable_port)}
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


def _turntable(config: SimConfig, port: str) -> str:
    if config.stepper is not None:
        return stepper_toml(config.stepper, port)
    table = config.turntable
    return f"""\
[turntable]
kind = "dynamixel"
port = "{port}"
baud = {table.baud}
id = {table.id}
model = "XL430-W250"
"""


def _on_the_arm(config: SimConfig, arm_port: str) -> str:
    arm = config.arm
    lights = 'kind = "grbl-spindle"\npower = 1000' if _is_lit_by_the_arm(config.scene) else 'kind = "always-on"'
    return f"""\
[arm]
kind = "grbl"
port = "{arm_port}"
baud = {GRBL_BAUD}
azimuth_origin_deg = {-arm.azimuth_travel_deg:.1f}
elevation_origin_deg = {-arm.elevation_travel_deg:.1f}

[lights]
{lights}
"""


def _name(scene: SphereScene | ReliefScene | MitsubaScene) -> str:
    if isinstance(scene, MitsubaScene):
        return f"rendered {scene.sample.replace('-', ' ')}"
    return "relief" if isinstance(scene, ReliefScene) else "brushed sphere"


def _is_lit_by_the_arm(scene: SphereScene | ReliefScene | MitsubaScene) -> bool:
    return scene.lights != "studio" if isinstance(scene, MitsubaScene) else isinstance(scene, ReliefScene)


def _sample(scene: SphereScene | ReliefScene | MitsubaScene) -> str:
    if isinstance(scene, ReliefScene) or scene.projection == "orthographic":
        return ""
    if isinstance(scene, MitsubaScene) and scene.sample in FLAT_SAMPLES:
        return ""
    return f"\n[sample]\nsphere_distance_radii = {scene.distance_radii:.3f}\n"
