import pytest
from pydantic import ValidationError

from firmware_sim.mitsuba.config import MitsubaScene


@pytest.mark.parametrize(
    ("values", "complaint"),
    [
        pytest.param({"sampel": "fabric"}, "Extra inputs", id="a misspelt key"),
        pytest.param({"sample": "velvet"}, "Input should be", id="a sample that is not there"),
        pytest.param({"invariance": 5}, "Input should be", id="a weave that is not made"),
        pytest.param({"distance_radii": 1.0}, "greater than 1.2", id="a camera inside the sphere"),
        pytest.param({"distance_radii": float("nan")}, "finite", id="no number"),
        pytest.param({"roughness_along": 0.0}, "greater than 0.01", id="a mirror"),
        pytest.param({"samples": 0}, "greater than or equal to 1", id="no light at all"),
        pytest.param(
            {"sample": "relief", "lights": "near-lamp", "lamp_distance_radii": 2},
            "must be 3 or more",
            id="a lamp that touches the slab",
        ),
    ],
)
def test_what_does_not_fit_is_refused(values: dict[str, object], complaint: str) -> None:
    with pytest.raises(ValidationError, match=complaint):
        MitsubaScene.model_validate(values)


def test_a_scene_does_not_change() -> None:
    with pytest.raises(ValidationError, match="frozen"):
        MitsubaScene().samples = 3  # type: ignore[misc]
