"""Does the light of a MatCap turn as light does? One cell of the tables that `make oracle` makes whole."""

import pytest

from firmware_sim.mitsuba.variants import Budget
from tests.oracle.turned_light import Quality, errors, separation, turned


@pytest.fixture(scope="module")
def quality(variant: str, affordable: Budget) -> Quality:
    return Quality(variant, affordable.side_px, 2 * affordable.samples)


def test_turned_light_is_nearer_to_the_truth_than_a_turned_picture(quality: Quality) -> None:
    found = errors(quality, "gold", turned(quality, "gold", "y", 60.0))
    assert found.ours < 0.4 * min(found.picture, found.mirrored)


def test_low_and_high_frequencies_are_nearer_to_diffuse_and_specular_light_than_the_whole(quality: Quality) -> None:
    parts = separation(quality, alpha=0.12)
    assert parts.low < 0.6 * parts.whole_as_diffuse
    assert parts.high < 0.6 * parts.whole_as_specular
    # What is smooth in the specular part cannot be told from diffuse light: low is brighter, high darker.
    assert parts.high_by_specular < 1 < parts.low_by_diffuse
