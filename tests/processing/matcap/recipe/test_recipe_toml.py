import tomllib
from pathlib import Path

import pytest

from litrig.base.errors import ConfigError, InputError
from processing.matcap.recipe.operations import Align, Colour, Hang, Paint, Rotate, Roughness, Turns
from processing.matcap.recipe.recipe_toml import Recipe, read_recipe, rebased, write_recipe

STEPS = (
    Rotate(axis="y", degrees=30),
    Rotate(axis=(1.0, 1.0, 0.0), degrees=-5, turns=Turns.NORMALS),
    Paint(shape="line", at=(0.1, 0.2), to=(0.3, 0.2), colour=(2.0, 1.0, 0.5)),
    Hang(image="flame.png", at=(0.0, 0.0), name="flame"),
    Roughness(degrees=12.5),
    Colour(hue_deg=20),
    Align(at=(0.0, 0.3)),
)


def test_a_recipe_is_read_as_it_was_written(tmp_path: Path) -> None:
    write_recipe(tmp_path / "x.recipe.toml", Recipe(steps=STEPS))
    assert read_recipe(tmp_path / "x.recipe.toml").steps == STEPS
    told = tomllib.loads((tmp_path / "x.recipe.toml").read_text())
    assert told["kind"] == "matcap"
    assert told["steps"][0] == {"op": "rotate", "axis": "y", "degrees": 30}


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ('[[steps]]\nop = "rotate"\naxis = "y"\ndegrees = 3\nspeed = 2', "unknown key 'steps.0.rotate.speed'"),
        ('[[steps]]\nop = "bake"', r"steps\.0: Input tag 'bake'"),
        ('[[steps]]\nop = "rotate"\naxis = "y"', "key 'steps.0.rotate.degrees' is missing"),
        ('[[steps]]\nop = "rotate"\naxis = [0, 0, 0]\ndegrees = 3', "an axis of no length"),
        ('[[steps]]\nop = "paint"\nat = [0.9, 0.9]', "is not on the ball"),
        ('[[steps]]\nop = "paint"\nat = [0.1, 0.1]\nshape = "line"', "need `to`"),
        ('[[steps]]\nop = "roughness"', "either filter_size or degrees"),
        ('[[steps]]\nop = "align"', "either at or to_file"),
        ('[[steps]]\nop = "gain"\nlow = -1', "greater than or equal to 0"),
        ('kind = "shape"', "kind"),
        ("kind = ", "not valid TOML"),
    ],
)
def test_a_recipe_that_is_none_is_refused(tmp_path: Path, text: str, reason: str) -> None:
    (tmp_path / "x.recipe.toml").write_text(text)
    with pytest.raises(ConfigError, match=reason) as caught:
        read_recipe(tmp_path / "x.recipe.toml")
    assert "x.recipe.toml" in str(caught.value)


def test_a_recipe_needs_its_ending(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"end the name in \.recipe\.toml"):
        write_recipe(tmp_path / "x.toml", Recipe())
    assert not any(tmp_path.iterdir())


def test_files_are_named_from_the_folder_that_a_recipe_goes_to(tmp_path: Path) -> None:
    here, there = tmp_path / "a", tmp_path / "b"
    moved = rebased(Recipe(steps=(Hang(image="flame.png", at=(0.0, 0.0)),)), here, there)
    step = moved.steps[0]
    assert isinstance(step, Hang)
    assert (there / step.image).resolve() == (here / "flame.png").resolve()
