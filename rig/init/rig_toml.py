"""RIG.toml written from what was found: every key with what it means, those that were found with their values.

The comments are the configuration models' own, so that they cannot grow old.
"""

import json
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from litrig.base.config import StrictModel
from rig.config import (
    AlwaysOnConfig,
    ArmConfig,
    CameraConfig,
    RigInfo,
    SampleConfig,
    SpindleLampConfig,
    TurntableConfig,
)
from rig.dynamixel.registers import MODEL_NUMBERS
from rig.init.discovery import Discovery, FoundCamera, FoundController, FoundServos, Silent

TRAVEL = (130, 131)
"""Settings that hold how far X and Y travel, from zero downwards."""
LARGEST_SPINDLE = 30
HEADING = """\
# A rig as litrig found it. Lines that begin with # are defaults: take the # away to change one.
# Unknown keys are refused, so a misspelt one cannot go unnoticed. Now try: litrig rig doctor RIG.toml
"""
MODEL_NAMES = {number: name for name, number in MODEL_NUMBERS.items()}


def write_rig_toml(found: Discovery) -> str:
    """Write the configuration of what was found; of several of a kind the first is taken, and the others are told."""
    text = [HEADING, *_section("rig", RigInfo, {"name": "rig"})]
    servos, *more_servos = found.servos or (None,)
    controller, *more_controllers = found.controllers or (None,)
    camera, *more_cameras = found.cameras or (None,)
    text += _turntable(servos) if servos else _missing("turntable", "no servo answers", TurntableConfig, "port")
    text += _also(
        f"servos {', '.join(map(str, other.models))} on {other.port} at {other.baud} baud"
        for other in more_servos
        if other is not None
    )
    text += _arm(controller) if controller else _missing("arm", "no GRBL controller answers", ArmConfig, "port")
    text += _also(f"a GRBL controller on {other.port}" for other in more_controllers if other is not None)
    text += _camera(camera) if camera else _missing("camera", "no camera delivers a picture", CameraConfig, "device")
    text += _also(f"a camera at {other.config.device}" for other in more_cameras if other is not None)
    text += _section("sample", SampleConfig, {})
    text += _silent(found.silent)
    return "\n".join(text) + "\n"


def _turntable(servos: FoundServos) -> Iterator[str]:
    (servo_id, number), *others = servos.models.items()
    model = MODEL_NAMES.get(number)
    values: dict[str, Any] = {"kind": "dynamixel", "port": servos.port, "baud": servos.baud, "id": servo_id}
    values |= {"model": model} if model else {}
    yield from _section("turntable", TurntableConfig, values)
    if model is None:
        yield f"# The servo says that it is of model number {number}, which litrig does not know."
    yield from _also(f"servo {other} on the same bus" for other, _ in others)


def _arm(controller: FoundController) -> Iterator[str]:
    values: dict[str, Any] = {"kind": "grbl", "port": controller.port}
    for key, number in zip(("azimuth_origin_deg", "elevation_origin_deg"), TRAVEL, strict=True):
        if number in controller.settings:
            values[key] = -controller.settings[number]
    yield from _section("arm", ArmConfig, values)
    yield "# If no arm hangs on this controller, leave out [arm], and let [lights] be always-on."
    lamp = {"kind": "grbl-spindle", "power": controller.settings.get(LARGEST_SPINDLE, 1000.0)}
    yield from _section("lights", SpindleLampConfig, lamp)


def _camera(camera: FoundCamera) -> Iterator[str]:
    keys = ("kind", "device", "width", "height", "pixel_format")
    yield from _section("camera", CameraConfig, {key: getattr(camera.config, key) for key in keys})


def _missing(name: str, why: str, model: type[StrictModel], key: str) -> Iterator[str]:
    """Leave a section out, in a way that shows how to put it in."""
    yield f"# {why}. If there is one, take the # of these lines away:"
    yield f"# [{name}]"
    yield f'# {key} = "/dev/…"  # {_meaning(model.model_fields[key])}'
    if name == "arm":
        yield ""
        yield from _section("lights", AlwaysOnConfig, {"kind": "always-on"})
    else:
        yield ""


def _section(name: str, model: type[StrictModel], values: Mapping[str, Any]) -> Iterator[str]:
    yield f"[{name}]"
    for key, info in model.model_fields.items():
        if key in values:
            line = f"{key} = {_toml(values[key])}"
        elif info.default is None or info.default is PydanticUndefined:
            line = f"# {key} = …"
        else:
            line = f"# {key} = {_toml(info.default)}"
        yield f"{line}  # {_meaning(info)}"
    yield ""


def _meaning(info: FieldInfo) -> str:
    return re.sub(r"\s+", " ", info.description or "").strip()


def _also(others: Iterable[str]) -> Iterator[str]:
    for other in others:
        yield f"# There is also {other}."


def _silent(paths: Iterable[Silent]) -> Iterator[str]:
    for silent in paths:
        yield f"# {silent.path}: {' '.join(silent.reason.split())}"


def _toml(value: Any) -> str:
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_toml, value))}]"
    return json.dumps(value, ensure_ascii=False)  # of numbers and plain strings, JSON is TOML
