import pytest

from firmware_sim.mitsuba.variants import MitsubaMissingError, best_variant


@pytest.fixture(scope="session")
def variant() -> str:
    try:
        return best_variant()
    except MitsubaMissingError as error:
        pytest.skip(f"{error}")
