"""What tests of several folders share."""

import signal
from collections.abc import Iterator

import pytest

from firmware_sim.config import SimConfig
from firmware_sim.launch import RunningSim, simulated_rig


def pytest_sessionstart() -> None:
    """Hear Ctrl-C again: test processes side by side are started deaf to it, and so would be whatever they start."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture
def sphere_sim() -> Iterator[RunningSim]:
    """A simulated rig that sees a brushed sphere, fresh for each test."""
    with simulated_rig(SimConfig()) as sim:
        yield sim


@pytest.fixture
def relief_sim() -> Iterator[RunningSim]:
    """A simulated rig that sees a relief, with a lamp on its arm."""
    with simulated_rig(SimConfig.model_validate({"scene": {"kind": "relief"}})) as sim:
        yield sim
