"""Make the sheets of docs/gallery.md by litrig's commands.

`python examples/gallery/make.py OUT [NN …] [--keep FOLDER]` makes OUT/gallery-NN.jpg of each figure. With --keep,
meshes, MatCaps and pictures stay in that folder, and what is there is not made again.
"""

import argparse
import tempfile
from pathlib import Path

from figures import FIGURES
from sheet import write_sheet
from workshop import Workshop


def main() -> None:
    parser = argparse.ArgumentParser(description="Make the sheets of docs/gallery.md.")
    parser.add_argument("out", type=Path)
    parser.add_argument("figures", nargs="*", default=list(FIGURES), metavar="NN")
    parser.add_argument("--keep", type=Path)
    said = parser.parse_args()
    with tempfile.TemporaryDirectory() as passing:
        folder = said.keep or Path(passing)
        folder.mkdir(parents=True, exist_ok=True)
        for name in said.figures:
            write_sheet(said.out / f"gallery-{name}.jpg", FIGURES[name](Workshop(folder)))


if __name__ == "__main__":
    main()
