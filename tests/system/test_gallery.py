"""What the gallery is made from: sample MatCaps, recipes and meshes that any command takes."""

import re
import runpy
from pathlib import Path

import numpy as np
import pytest

from litrig.base.pictures import read_codes
from processing.matcap.recipe.recipe_toml import read_recipe
from processing.mesh.files.obj import read_obj

ROOT = Path(__file__).parents[2]
GALLERY, PAGE = ROOT / "examples" / "gallery", ROOT / "docs" / "gallery.md"
RECIPES, MATCAPS = sorted(GALLERY.glob("recipes/*.toml")), sorted((ROOT / "examples" / "matcaps").glob("*.png"))


@pytest.mark.parametrize("recipe", RECIPES, ids=lambda path: path.name.partition(".")[0])
def test_the_recipes_are_read_and_used(recipe: Path) -> None:
    assert read_recipe(recipe).steps
    assert recipe.name.partition(".")[0].removeprefix("figure-11-") in (GALLERY / "figures.py").read_text()


@pytest.mark.parametrize("matcap", MATCAPS, ids=lambda path: path.stem)
def test_the_sample_matcaps_fill_their_squares_and_clip_nothing(matcap: Path) -> None:
    codes = read_codes(matcap)
    size = len(codes)
    assert codes.shape == (size, size, 3)
    assert codes.max() < 255
    along = (2 * np.arange(size) + 1) / size - 1
    radius = np.hypot(along, along[:, None])
    lit = codes.max(axis=2) > 0
    assert lit[radius < 1 - 2 / size].all()
    assert not lit[radius > 1 + 2 / size].any()


def test_the_pages_pictures_are_there_and_small() -> None:
    pictures = re.findall(r"\((pictures/gallery-\d\d\.jpg)\)", PAGE.read_text(encoding="utf-8"))
    assert len(pictures) == 8
    for picture in pictures:
        assert 20_000 < (PAGE.parent / picture).stat().st_size < 150_000


@pytest.mark.parametrize(("name", "parts"), [("mask", 7), ("cow", 13), ("robot", 22)])
def test_the_meshes_face_outwards_and_each_part_has_its_column(name: str, parts: int, tmp_path: Path) -> None:
    shapes = runpy.run_path(str(GALLERY / "shapes.py"))
    made = [shapes["Part"](part.bend, part.material, 12, 8) for part in shapes[name]()]
    shapes["write_obj"](tmp_path / "mesh.obj", made)
    volumes = np.zeros(parts)
    for piece in read_obj(tmp_path / "mesh.obj"):
        assert piece.normals is not None
        assert piece.uvs is not None
        np.testing.assert_allclose(np.linalg.norm(piece.normals, axis=1), 1, atol=1e-3)
        column = (piece.uvs[piece.triangles[:, 0], 0] * len(made)).astype(int)
        volumes += np.bincount(column, np.linalg.det(piece.positions[piece.triangles]), minlength=parts)
    assert len(made) == parts
    assert (volumes > 0).all()
