"""All checks that move nothing, side by side, so that the slowest device sets the time and none can hang the rest."""

import contextvars
import threading
from collections.abc import Callable, Mapping
from contextlib import ExitStack, suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import serial

from litrig.base.errors import LitrigError
from rig.config import AlwaysOnConfig, ArmConfig, CameraConfig, RigConfig, TurntableConfig
from rig.doctor.bench import Bench
from rig.doctor.camera import check_camera
from rig.doctor.controller import check_controller
from rig.doctor.disk import check_disk
from rig.doctor.finding import Finding, Findings, Part
from rig.doctor.servo import check_servo
from rig.doctor.wall_clock import check_clock
from rig.errors import PortError
from rig.rig import open_rig
from rig.rig_lock import lock_rig

PATIENCE_S = 3.6
"""With the time that Python needs to start, what is passive is done within 5 s."""

Check = Callable[[ExitStack], Findings]
MOVING_PARTS = ("turntable", "arm")


def examine(
    config: RigConfig,
    folder: Path = Path(),
    *,
    patience_s: float = PATIENCE_S,
    environment: Mapping[str, str] | None = None,
) -> list[Finding]:
    """Look at everything that a RIG.toml names, and at this machine. Nothing moves.

    Parameters
    ----------
    folder : where sessions are to go
    patience_s : what has not answered by then hangs
    environment : added to the environment of the camera's process
    """
    bench = Bench(config, 0.0, folder, environment=environment or {})
    bench = replace(bench, deadline_s=bench.clock.now_s() + patience_s)
    with ExitStack() as stack:
        try:
            if (lock := lock_rig(config)) is not None:
                stack.callback(lock.release)
        except PortError as error:
            in_use = [Part("rig").refused("in use", error)]
            return in_use + run_side_by_side(bench, {"disk": partial(_disk, bench), "clock": _clock})
        return run_side_by_side(bench, checks_of(bench))


def checks_of(bench: Bench) -> dict[str, Check]:
    """Say what is to be looked at, by part."""
    config = bench.config
    checks: dict[str, Check] = {}
    ports: set[str] = set()
    for name in MOVING_PARTS:
        section: Any = getattr(config, name)
        if section is None:
            continue
        if section.kind == "dynamixel":
            checks[name] = partial(_servo, bench, section)
        elif section.kind.startswith("grbl"):
            if section.port not in ports:  # two parts may hang on one controller
                checks[name] = partial(_controller, bench, name, section)
            ports.add(section.port)
        else:
            checks[name] = partial(_opens, bench, name)
    if isinstance(config.lights, AlwaysOnConfig):
        checks["lights"] = _always_on
    elif config.lights is None:
        checks["lights"] = _no_lights
    elif not config.lights.kind.startswith("grbl"):  # those are looked at with their controller
        checks["lights"] = partial(_opens, bench, "lights")
    if isinstance(config.camera, CameraConfig):
        checks["camera"] = partial(check_camera, bench, config.camera)
    return {**checks, "disk": partial(_disk, bench), "clock": _clock}


def run_side_by_side(bench: Bench, checks: Mapping[str, Check]) -> list[Finding]:
    """Run checks, each in a thread of its own, and give up on those that outlast the deadline."""
    found: dict[str, list[Finding]] = {name: [] for name in checks}
    runs = []
    for name, check in checks.items():
        stack = ExitStack()
        # The context tells a recorder who opens ports; the thread may outlive us if a driver never comes back.
        run = partial(contextvars.copy_context().run, _run, name, check, stack, found[name])
        thread = threading.Thread(target=run, name=f"doctor: {name}", daemon=True)
        thread.start()
        runs.append((name, thread, stack))
    findings: list[Finding] = []
    for name, thread, stack in runs:
        thread.join(bench.left_s())
        collected = list(found[name])
        if thread.is_alive():
            collected.append(
                Part(name).fault("answer", "hangs: no answer in time", "unplug it, plug it in again, and try again")
            )
        with suppress(Exception):  # the end of a part that is faulty may fail too
            stack.close()
        findings += collected
    return findings


def _run(name: str, check: Check, stack: ExitStack, found: list[Finding]) -> None:
    try:
        for finding in check(stack):
            found.append(finding)  # noqa: PERF402  # one by one: what was found before a hang counts
    except LitrigError as error:
        found.append(Part(name).refused("answer", error))
    except (serial.SerialException, OSError) as error:
        found.append(Part(name).fault("answer", f"went away ({error})", "check its cable and try again"))


def _servo(bench: Bench, config: TurntableConfig, _: ExitStack) -> Findings:
    return check_servo(bench, config)


def _controller(bench: Bench, name: str, config: ArmConfig, _: ExitStack) -> Findings:
    return check_controller(bench, name, config.port, config.baud)


def _disk(bench: Bench, _: ExitStack) -> Findings:
    return check_disk(bench.folder)


def _clock(_: ExitStack) -> Findings:
    return check_clock()


def _always_on(_: ExitStack) -> Findings:
    yield Part("lights").ok("switching", "always on; a person switches them")


def _no_lights(_: ExitStack) -> Findings:
    yield Part("lights").warning("switching", "RIG.toml has no [lights]", "add them; fixed ones are of kind always-on")


def _opens(bench: Bench, name: str, stack: ExitStack) -> Findings:
    """Open a part by its driver, which is all that is known about it."""
    rig = stack.enter_context(
        open_rig(bench.config, use=frozenset({name}), clock=bench.clock, environment=bench.environment, locked=True)
    )
    if name in MOVING_PARTS:
        rig.turntable.locate() if name == "turntable" else rig.arm.locate()
    yield Part(name).ok("answer", "its driver opens it")
