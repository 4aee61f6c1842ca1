"""Scenes that are rendered once a run: physics that no part of our own fitting shares."""

from pathlib import Path

import pytest

from firmware_sim.mitsuba.variants import Budget, MitsubaMissingError, best_variant, budget
from tests.oracle.shoot import Studio


@pytest.fixture(scope="session")
def variant() -> str:
    try:
        return best_variant()
    except MitsubaMissingError as error:
        pytest.skip(f"{error}")


@pytest.fixture(scope="session")
def affordable(variant: str) -> Budget:
    return budget(variant)


@pytest.fixture(scope="session")
def studio(variant: str, affordable: Budget, tmp_path_factory: pytest.TempPathFactory) -> Studio:
    folder: Path = tmp_path_factory.mktemp("oracle")
    return Studio(variant, affordable.side_px, affordable.samples, folder)
