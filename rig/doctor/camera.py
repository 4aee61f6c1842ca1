"""A camera: does it open as RIG.toml wants it, and does it deliver pictures that are worth something."""

from contextlib import ExitStack
from itertools import pairwise

import numpy as np

from litrig.base.errors import FormatError
from litrig.base.pictures import decode_codes
from litrig.base.radiometry import U8, clipped_share
from rig.camera.v4l2 import V4l2Camera
from rig.config import AlwaysOnConfig, CameraConfig
from rig.devices import Shot
from rig.doctor.bench import Bench
from rig.doctor.finding import Findings, Part
from rig.errors import CameraError

BLACK_MEAN = 0.002
BLOWN_SHARE = 0.5
FRAMES = 2


def codes_of(shot: Shot) -> U8:
    """Decode a picture whole.

    Raises
    ------
    FormatError
        It is damaged.
    """
    return np.asarray(decode_codes(shot.content, shot.ending, "camera"), np.uint8)


def mean_of(codes: U8) -> float:
    """Return the mean of the display values, 0..1."""
    return float(np.mean(codes, dtype=np.float64)) / 255


def check_camera(bench: Bench, config: CameraConfig, stack: ExitStack) -> Findings:
    """Open the camera and take pictures; closing the stack ends it even while it hangs."""
    part = Part("camera")
    patient = config.model_copy(update={"timeout_s": min(config.timeout_s, max(0.1, bench.left_s()))})
    camera = V4l2Camera(patient, bench.clock, bench.environment)
    stack.callback(camera.close)
    try:
        camera.configure()
        yield part.ok("settings", f"{config.device} opens and takes the settings of RIG.toml")
        shots = [camera.capture(bench.clock.now_s()) for _ in range(FRAMES)]
        codes = codes_of(shots[-1])
    except (CameraError, FormatError) as error:
        yield part.refused("picture", error)
        return
    height, width = codes.shape[:2]
    mean = mean_of(codes)
    what = f"{width} × {height}, mean {mean:.3f}, {len(shots[-1].content) / 1000:.0f} kB"
    if any(one.content == other.content for one, other in pairwise(shots)):
        yield part.fault(
            "picture", f"{what}, bit for bit the one before: it is frozen", "unplug it and plug it in again"
        )
    elif mean < BLACK_MEAN and isinstance(bench.config.lights, AlwaysOnConfig):
        yield part.fault(
            "picture", f"{what}: black, under lights that are always on", "check lights, lens cap, exposure"
        )
    elif mean < BLACK_MEAN:
        yield part.ok("picture", f"{what}: dark, as the lamps are")
    elif clipped_share(codes) > BLOWN_SHARE:
        yield part.warning("picture", f"{what}: most of it is white", "shorten exposure_ms, or dim the lights")
    else:
        yield part.ok("picture", what)
