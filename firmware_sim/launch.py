"""Start the simulated rig, hand it over, stop it."""

import json
import os
import select
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from firmware_sim.camera.shim import compiled_shim
from firmware_sim.config import SimConfig
from firmware_sim.errors import RenderError, SideChannelError, SimServerError
from firmware_sim.mitsuba.config import MitsubaScene
from firmware_sim.mitsuba.variants import best_variant
from firmware_sim.render_requests import BATCH
from firmware_sim.rig_toml import rig_toml
from firmware_sim.scene.frame_cache import default_root
from firmware_sim.scene.pose import PlannedPose
from firmware_sim.server import CHANNEL_NAME, CONFIG_NAME, FRAMES_NAME, LOG_NAME, RIG_NAME, USB_NAME
from firmware_sim.side_channel import SideChannel

START_PATIENCE_S = 30.0
STOP_PATIENCE_S = 5.0
POLL_S = 0.1


class RenderProgress(NamedTuple):
    """How many pictures of the plan are there, of how many, and what a person should know about it, if anything."""

    done: int
    total: int
    note: str


@dataclass(frozen=True)
class RunningSim:
    """A rig that answers on its wires.

    Attributes
    ----------
    rig_toml : path of the RIG.toml that describes it
    environment : variables to add to a client's environment; the camera exists only for programs that start with them
    side_channel : to look behind the devices, and to break them
    """

    rig_toml: Path
    environment: dict[str, str]
    side_channel: SideChannel

    def render_ahead(self, poses: Iterable[PlannedPose], report: Callable[[int, int], None]) -> None:
        """Render the pictures of a plan before the rig gets there, and wait for them; nothing to do for other scenes.

        Parameters
        ----------
        poses : of the plan, as its devices are commanded
        report : called with how many pictures are there, and of how many

        Raises
        ------
        RenderError
            The renderer ended, or cannot render this scene.
        """
        send_plan(self.side_channel, poses)
        told: RenderProgress | None = None
        while told is None or told.done < told.total:
            progress = self.render_progress()
            if progress == told:
                select.select([], [], [], POLL_S)
                continue
            report(progress.done, progress.total)
            told = progress

    def render_progress(self) -> RenderProgress:
        """Return how far rendering ahead is.

        Raises
        ------
        RenderError
            The renderer ended, or cannot render this scene.
        """
        answer = self.side_channel.request("render.progress")
        if answer["failed"]:
            raise RenderError(f"{answer['failed']}")
        return RenderProgress(answer["done"], answer["total"], answer["note"])


def send_plan(channel: SideChannel, poses: Iterable[PlannedPose]) -> None:
    """Send the poses of a plan, in batches that fit into a request; they take the place of a plan before."""
    plan = [pose._asdict() for pose in poses]
    for start in range(0, max(1, len(plan)), BATCH):
        channel.request("render.ahead", poses=plan[start : start + BATCH], anew=start == 0)


@contextmanager
def simulated_rig(config: SimConfig, folder: Path | None = None, cache: Path | None = None) -> Iterator[RunningSim]:
    """Run the devices in a process of their own for as long as the body lasts.

    Parameters
    ----------
    config : what to simulate
    folder : for RIG.toml, log and sockets; by default a temporary one that is removed afterwards
    cache : for rendered pictures; by default a folder of the user's, where they stay

    Raises
    ------
    SimToolError
        The camera shim cannot be compiled.
    MitsubaMissingError
        The scene is to be rendered, and what renders it is not installed.
    SimServerError
        The process does not come up; the message has its last words.
    """
    shim = compiled_shim()
    variant = best_variant() if isinstance(config.scene, MitsubaScene) else ""
    with ExitStack() as stack:
        if folder is None:
            folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="litrig-sim-")))
        folder.mkdir(parents=True, exist_ok=True)
        folder = folder.resolve()
        (folder / CONFIG_NAME).write_text(config.model_dump_json(), encoding="utf-8")
        ports = stack.enter_context(_server(folder, (cache or default_root()).resolve(), variant))
        rig = folder / RIG_NAME
        text = rig_toml(config, _table_port(config, ports), ports["arm"], str(folder / USB_NAME))
        rig.write_text(text, encoding="utf-8")
        channel = stack.enter_context(SideChannel(folder / CHANNEL_NAME))
        yield RunningSim(rig, _environment(config, folder, shim), channel)


def _table_port(config: SimConfig, ports: dict[str, str]) -> str:
    if config.stepper is None:
        return ports["turntable"]
    return ports["arm"] if config.stepper.on_the_arm else ports["stepper"]


def _environment(config: SimConfig, folder: Path, shim: Path) -> dict[str, str]:
    others = os.environ.get("LD_PRELOAD")
    return {
        "LITRIG_RIG": str(folder / RIG_NAME),
        "LITRIG_SIM_VIDEO": config.camera.device,
        "LITRIG_SIM_FRAMES": str(folder / FRAMES_NAME),
        "LITRIG_SIM_CHANNEL": str(folder / CHANNEL_NAME),
        "LD_PRELOAD": f"{shim}:{others}" if others else str(shim),
    }


@contextmanager
def _server(folder: Path, cache: Path, variant: str) -> Iterator[dict[str, str]]:
    """Run the server; yields the ports that it opened."""
    options = ["--folder", str(folder), "--cache", str(cache), "--variant", variant]
    command = [sys.executable, "-m", "firmware_sim.server", *options]
    # The child finds this package wherever the parent found it.
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    with (folder / LOG_NAME).open("wb") as log:
        process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=log,
            env=environment,
            start_new_session=True,  # Ctrl-C is for the client; the devices outlive it
        )
    try:
        yield _await_ports(process, folder / LOG_NAME)
    finally:
        _stop(process, folder)


def _await_ports(process: "subprocess.Popen[bytes]", log: Path) -> dict[str, str]:
    if process.stdout is None:
        raise SimServerError("the simulator was started without a pipe to hear from it")
    readable, _, _ = select.select([process.stdout], [], [], START_PATIENCE_S)
    line = process.stdout.readline() if readable else b""
    try:
        ports: dict[str, str] = json.loads(line)
    except ValueError as error:
        words = log.read_text("utf-8", errors="replace").strip().splitlines()
        last = words[-1] if words else "it said nothing"
        raise SimServerError(f"the simulator did not start ({last}); its log was {log}") from error
    return ports


def _stop(process: "subprocess.Popen[bytes]", folder: Path) -> None:
    with suppress(SideChannelError), SideChannel(folder / CHANNEL_NAME) as channel:
        channel.shutdown()
    for pipe in (process.stdin, process.stdout):
        if pipe is not None:
            pipe.close()
    try:
        process.wait(timeout=STOP_PATIENCE_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
