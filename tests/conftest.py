"""What tests of several folders share."""

from collections.abc import Iterator

import pytest

from firmware_sim.config import SimConfig
from firmware_sim.launch import RunningSim, simulated_rig


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
