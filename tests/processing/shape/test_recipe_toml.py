from pathlib import Path

import pytest

from litrig.base.errors import ConfigError, InputError
from processing.shape.editing.operations import Bump, Emboss, Factors, Noise, Painted, Recipe, Ripple, Smooth
from processing.shape.editing.recipe_toml import at_frame, read_recipe, write_recipe


def everything(folder: Path) -> Recipe:
    return Recipe(
        steps=(
            Painted(file=folder / "n.exr", space="surface", green="down"),
            Smooth(radius=3, depth_radius=0.1, surfaces=(2, 7)),
            Emboss(beta=0.25, strength=0.5, mask=folder / "deep" / "mask.png"),
            Bump(heights=folder / "h.png", height=-2, at=(3, 4), size=50, turn_deg=30, repeat=True),
            Noise(height=0.1, scale=0.5, octaves=5, seed=8, across="positions", displace=True),
            Ripple(at=(1.5, 2.5), height=1, wavelength=9, fade=30, phase_deg=90),
            Factors(diffuse=0.5, reflection=0),
        )
    )


def test_what_is_written_is_read(tmp_path: Path) -> None:
    write_recipe(tmp_path / "x.recipe.toml", everything(tmp_path))
    assert read_recipe(tmp_path / "x.recipe.toml") == everything(tmp_path)


def test_a_recipe_moves_with_its_files(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    write_recipe(tmp_path / "a" / "x.recipe.toml", everything(tmp_path / "a"))
    assert str(tmp_path) not in (tmp_path / "a" / "x.recipe.toml").read_text()
    (tmp_path / "a").rename(tmp_path / "b")
    assert read_recipe(tmp_path / "b" / "x.recipe.toml") == everything(tmp_path / "b")


def test_files_of_a_frame_have_its_number(tmp_path: Path) -> None:
    recipe = at_frame(Recipe(steps=(Painted(file=tmp_path / "n.###.exr"), Emboss(beta=1, mask=Path("m.png")))), 7)
    assert recipe.steps[0] == Painted(file=tmp_path / "n.007.exr")
    assert recipe.steps[1].mask == Path("m.png")


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("kind = 'matcap'\n[[steps]]\nop = 'rotate'\naxis = 'y'\ndegrees = 30", "kind: Input should be 'shape'"),
        ("[[steps]]\nop = 'emboss'\nbeta = 0.5\nalpha = 1", "unknown key 'steps.0.emboss.alpha'"),
        ("[[steps]]\nop = 'emboss'", "beta' is missing"),
        ("[[steps]]\nop = 'emboss'\nbeta = 1.5", "less than or equal to 1"),
        ("[[steps]]\nop = 'carve'", "carve"),
        ("[[steps]]\nop = 'noise'\nheight = nan\nscale = 3", "finite"),
        ("[[steps]]\nop = 'noise'\nheight = 1\nscale = 3\ndisplace = true", 'across = "positions"'),
        ("[[steps]]\nop = 'bump'\nheights = 'h.png'\nacross = 'positions'", "give size"),
        ("edits = 1", "unknown key 'edits'"),
        ("[[edit", "not valid TOML"),
    ],
)
def test_what_no_edit_understands_is_refused(tmp_path: Path, text: str, reason: str) -> None:
    (tmp_path / "x.recipe.toml").write_text(text)
    with pytest.raises(ConfigError, match=reason) as caught:
        read_recipe(tmp_path / "x.recipe.toml")
    assert "x.recipe.toml" in str(caught.value) and "\n" not in str(caught.value)


def test_other_names_are_not_written(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"end the name in \.recipe\.toml"):
        write_recipe(tmp_path / "x.toml", Recipe())
    assert not any(tmp_path.iterdir())
