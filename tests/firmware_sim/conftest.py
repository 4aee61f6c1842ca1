"""Two simulated rigs, each started once for all tests of this folder."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

import firmware_sim
from firmware_sim.config import ReliefScene, SimConfig
from firmware_sim.launch import RunningSim, simulated_rig

ROOT = Path(firmware_sim.__file__).parents[1]
PRELUDE = """
import json, select, sys, time
import cv2
import numpy as np
import simplejpeg

def say(**what):
    print(json.dumps(what), flush=True)

def opened(fourcc="MJPG", manual=True):
    camera = cv2.VideoCapture("/dev/video42", cv2.CAP_V4L2, [cv2.CAP_PROP_FOURCC, cv2.VideoWriter.fourcc(*fourcc)])
    if manual:
        camera.set(cv2.CAP_PROP_AUTO_EXPOSURE, 1)
        camera.set(cv2.CAP_PROP_EXPOSURE, 100)
    return camera

def fresh(camera):
    start = time.monotonic()
    while True:
        assert camera.grab()
        if camera.get(cv2.CAP_PROP_POS_MSEC) / 1000 > start:
            return camera.retrieve()[1]
"""


class Talk:
    """A conversation with a running program, a line at a time."""

    def __init__(self, process: "subprocess.Popen[str]") -> None:
        self.process = process

    def hear(self) -> dict[str, Any]:
        """Wait for what it says next; its last words are in the error if it says nothing more."""
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        assert line, self.process.stderr.read() if self.process.stderr else ""
        said: dict[str, Any] = json.loads(line)
        return said

    def tell(self, line: object = "go on") -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(f"{line}\n")
        self.process.stdin.flush()


@dataclass(frozen=True)
class Client:
    """Starts programs that see the simulated camera."""

    sim: RunningSim

    @contextmanager
    def talk(self, code: str) -> Iterator[Talk]:
        """Run a program for as long as the body lasts."""
        environment = os.environ | self.sim.environment | {"PYTHONPATH": str(ROOT)}
        pipe = subprocess.PIPE
        command = [sys.executable, "-c", PRELUDE + code]
        with subprocess.Popen(command, env=environment, stdin=pipe, stdout=pipe, stderr=pipe, text=True) as process:
            try:
                yield Talk(process)
            finally:
                process.kill()

    def run(self, code: str) -> dict[str, Any]:
        """Run a program that says one thing."""
        with self.talk(code) as talk:
            said = talk.hear()
            assert talk.process.wait(30) == 0
        return said


@pytest.fixture(scope="session")
def sphere_rig() -> Iterator[RunningSim]:
    with simulated_rig(SimConfig()) as sim:
        yield sim


@pytest.fixture(scope="session")
def relief_rig() -> Iterator[RunningSim]:
    with simulated_rig(SimConfig(scene=ReliefScene())) as sim:
        yield sim


@pytest.fixture
def sphere(sphere_rig: RunningSim) -> Iterator[RunningSim]:
    """The brushed sphere's rig, mended after each test."""
    yield sphere_rig
    channel = sphere_rig.side_channel
    channel.request("camera.mend")
    channel.request("turntable.mend")
    channel.request("arm.switches", fault="none")


@pytest.fixture
def client(sphere: RunningSim) -> Client:
    return Client(sphere)
