"""Snapshots: what they are called, how large they are, and the command that makes the same picture."""

from dataclasses import dataclass
from pathlib import Path

from viewer.window.state import Shown

Size = tuple[int, int]

ENDINGS = (".png", ".exr")


@dataclass(frozen=True)
class Saving:
    """How snapshots are saved.

    Attributes
    ----------
    folder : where they go
    stem : what they are called, without number and ending
    size : width and height in pixels; None is as large as on the screen
    """

    folder: Path
    stem: str
    size: Size | None = None

    def free_name(self, ending: str) -> Path:
        """Return the first name of STEM.png, STEM-2.png, … that nothing has."""
        path, number = self.folder / f"{self.stem}{ending}", 1
        while path.exists() or path.is_symlink():
            number += 1
            path = self.folder / f"{self.stem}-{number}{ending}"
        return path


def saving_beside(folder: Path, file: Path) -> Saving:
    """Name snapshots after a material file."""
    return Saving(folder, file.name.split(".")[0] or "material")


def render_command(file: Path, shown: Shown, size: Size, output: Path) -> list[str]:
    """Return the words of the `litrig render` that makes the picture of a snapshot."""
    words = ["litrig", "render", str(file), "-o", str(output)]
    if shown.light is not None:
        words += ["--light", *map(str, shown.light)]
    if shown.mesh is None:
        return words
    view = shown.view
    return [
        *(*words, "--mesh", shown.mesh, "--size", str(size[0]), str(size[1]), "--projection", view.projection.value),
        *("--yaw", str(view.yaw_deg), "--pitch", str(view.pitch_deg), "--roll", str(view.roll_deg)),
        *("--zoom", str(view.zoom)),
    ]
