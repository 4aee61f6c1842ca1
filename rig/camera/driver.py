"""How a V4L2 camera is opened, and set as RIG.toml says."""

from rig.camera.v4l2 import V4l2Camera
from rig.config import CameraConfig
from rig.devices import Camera
from rig.drivers import Bench, Driver


def _open_camera(config: CameraConfig, bench: Bench) -> Camera:
    camera = V4l2Camera(config, bench.clock, bench.environment)
    try:
        camera.configure()
    except BaseException:
        camera.close()
        raise
    return camera


CAMERA = Driver(CameraConfig, _open_camera)
