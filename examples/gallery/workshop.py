"""Runs litrig in a folder, each result once."""

import subprocess
import sys
from pathlib import Path

import shapes

MATCAPS = Path(__file__).parent.parent / "matcaps"
RECIPES = Path(__file__).parent / "recipes"
FRONT = ("--pitch", "7", "--yaw", "16", "--zoom", "1.12")
MESH_VIEWS: dict[str, tuple[str, ...]] = {
    "mask": FRONT,
    "cow": ("--pitch", "12", "--yaw", "20", "--zoom", "1.1"),
    "robot": ("--pitch", "6", "--yaw", "18", "--zoom", "0.98"),
}
BACKGROUND = "#f4f3f0"
PICTURE_PX = "400"


class Workshop:
    """Makes what figures ask for, in a folder; what is there already is taken as it is.

    Parameters
    ----------
    folder : for meshes, decomposed MatCaps and pictures
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def litrig(self, *words: str | Path) -> None:
        """Run a command; say which."""
        said = [str(word) for word in words]
        sys.stderr.write("litrig " + " ".join(Path(word).name if "/" in word else word for word in said) + "\n")
        subprocess.run([sys.executable, "-m", "litrig", *said], check=True, stdout=subprocess.DEVNULL)

    def mesh(self, name: str) -> Path:
        file = self.folder / f"{name}.obj"
        if not file.exists():
            shapes.write_obj(file, getattr(shapes, name)())
        return file

    def source(self, name: str) -> Path:
        return MATCAPS / f"{name}.png"

    def layers(self, name: str) -> tuple[Path, Path]:
        """Split a MatCap."""
        low, high = self.folder / f"{name}.low.png", self.folder / f"{name}.high.png"
        if not high.exists():
            self.litrig("matcap", "split", self.source(name), "-o", low, high)
        return low, high

    def matcap(self, name: str) -> Path:
        """Decompose a MatCap."""
        file = self.folder / f"{name}.matcap.exr"
        if not file.exists():
            self.litrig("matcap", "decompose", self.source(name), "-o", file)
        return file

    def edited(self, result: str, matcap: Path, *options: str | Path) -> Path:
        """Edit a decomposed MatCap into another (a name that ends in .matcap.exr), or into its ball."""
        file = self.folder / result
        if not file.exists():
            self.litrig("matcap", "edit", matcap, "-o", file, *options)
        return file

    def rendered(self, result: str, matcap: Path, mesh: str, *options: str | Path) -> Path:
        """Draw a decomposed MatCap on a mesh."""
        file = self.folder / f"{result}.png"
        if not file.exists():
            look = (
                *MESH_VIEWS[mesh],
                "--background",
                BACKGROUND,
                "--size",
                PICTURE_PX,
                PICTURE_PX,
                "--supersample",
                "2",
            )
            self.litrig("render", matcap, "-o", file, "--mesh", self.mesh(mesh), *look, *options)
        return file


def recipe(name: str) -> tuple[str, Path]:
    return "--recipe", RECIPES / f"{name}.recipe.toml"
