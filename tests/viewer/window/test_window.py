"""`litrig view` on a screen, by real events, against pictures of what should be seen."""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from litrig.base.radiometry import to_u8
from processing.amc.files.ktx2 import read_amc, write_amc
from processing.mesh.either import mesh_of
from processing.ptm.files.ptm_file import read_ptm, write_ptm
from processing.ptm.relighting.relight import relight
from tests.viewer.analytic import brushed_amc
from tests.viewer.window.desktop import PATIENCE_S, Desktop, desktop, needs_desktop, wait_until
from tests.viewer.window.materials import DISPLAY_STEPS, Codes, shown_codes, soft_ptm, steps_apart
from viewer.cli import render
from viewer.materials.amc import amc_picture
from viewer.materials.ptm import ptm_mesh_picture
from viewer.materials.ptm_shading import PtmShading, shading_lights
from viewer.renderer import Renderer
from viewer.window.saving import render_command
from viewer.window.state import Button, Hand, start
from viewer.window.turn import spot_at

pytestmark = needs_desktop

SIZE = (360, 300)
MESHES = (None, "torus", "sphere", "cloth", "ribbon", "pillow", "sewn", "shirt")
PANEL_MIDDLE = 115
"""Pixels from the picture's right edge to the middle of the panel."""


class Window:
    """A window of litrig, and the hand that holds what it should show."""

    def __init__(self, screen: Desktop, process: subprocess.Popen[str], hand: Hand) -> None:
        self.screen, self.process, self.hand = screen, process, hand
        self.number = screen.do("search", "--sync", "--onlyvisible", "--pid", process.pid).split()[-1]
        place = dict(
            line.split("=") for line in screen.do("getwindowgeometry", "--shell", self.number).split() if "=" in line
        )
        self.corner = (int(place["X"]), int(place["Y"]))
        screen.do("windowfocus", "--sync", self.number)
        self.park()

    def at(self, x: int, y: int) -> tuple[int, int]:
        """A pixel of the window, on the screen."""
        return self.corner[0] + x, self.corner[1] + y

    def park(self) -> None:
        """Take the mouse off the picture, for it is seen on the screen."""
        self.screen.do("mousemove", "--sync", *self.at(SIZE[0] + 8, SIZE[1] - 8))

    def picture(self) -> Codes:
        (left, top), (width, height) = self.corner, SIZE
        return self.screen.screen()[top : top + height, left : left + width]

    def drag(self, mouse: int, button: Button, first: tuple[int, int], last: tuple[int, int]) -> None:
        """Drag on the picture, and let the hand do the same."""
        halfway = ((first[0] + last[0]) // 2, (first[1] + last[1]) // 2 + 9)
        self.screen.drag(mouse, self.at(*first), self.at(*halfway), self.at(*last))
        self.hand = self.hand.pressed(button, spot_at(first, SIZE)).dragged(spot_at(last, SIZE)).released()
        self.park()

    def sees(self, wanted: Codes, what: str) -> None:
        wait_until(lambda: steps_apart(self.picture(), wanted) <= DISPLAY_STEPS, what)
        assert wanted.std() > 10, "a picture that shows something"


@contextmanager
def opened(screen: Desktop, folder: Path, hand: Hand, *words: str | Path) -> Iterator[Window]:
    environment = {**screen.environment, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    process = subprocess.Popen(
        [
            sys.executable,
            "-m",
            "litrig",
            "view",
            *map(str, words),
            "--size",
            *map(str, SIZE),
            "--snapshots",
            str(folder),
        ],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        yield Window(screen, process, hand)
    finally:
        if process.poll() is None:
            process.kill()
        process.communicate()


@pytest.fixture(scope="module")
def screen(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Desktop]:
    with desktop(tmp_path_factory.mktemp("screen")) as running:
        yield running


def test_a_ptm_is_lit_turned_zoomed_and_saved(screen: Desktop, renderer: Renderer, tmp_path: Path) -> None:
    """One window for all, for a window takes seconds to open."""
    file = tmp_path / "soft.ptm"
    write_ptm(file, soft_ptm(*SIZE))
    ptm = read_ptm(file)

    def flat() -> Codes:
        return to_u8(relight(ptm, np.array(window.hand.shown.light)))

    def on_mesh() -> Codes:
        shown = window.hand.shown
        assert shown.mesh is not None and shown.light is not None
        mesh, _ = mesh_of(shown.mesh)
        return shown_codes(
            ptm_mesh_picture(
                renderer, ptm, mesh, shown.view, PtmShading(shading_lights((shown.light,))), size=SIZE, supersample=3
            )
        )

    with opened(screen, tmp_path, start(None, MESHES, (-0.4, 0.4)), file) as window:
        window.sees(flat(), "the flat PTM")
        # From about the middle of the disc in the panel to far below it.
        disc = window.at(SIZE[0] + PANEL_MIDDLE + 12, 166)
        screen.drag(1, disc, (disc[0], disc[1] + 50), (disc[0], disc[1] + 400))
        window.hand = window.hand.lit_from((0, -400))
        window.park()
        window.sees(flat(), "light from the lower rim of the disc")

        before = flat()

        window.drag(3, Button.LIGHT, (100, 100), (260, 190))
        assert steps_apart(flat(), before) > 30
        window.sees(flat(), "light that follows the right mouse button")

        screen.do("key", "m")
        window.hand = window.hand.on_next_mesh()
        assert window.hand.shown.mesh == "torus"
        window.sees(on_mesh(), "the torus after a key")

        before = on_mesh()
        window.drag(1, Button.OBJECT, (150, 170), (215, 90))
        assert steps_apart(on_mesh(), before) > 30
        window.sees(on_mesh(), "the torus turned by the hand")

        screen.do("mousemove", "--sync", *window.at(200, 120), "sleep", 0.2, "click", 4, "sleep", 0.2, "click", 4)
        window.park()
        window.hand = window.hand.scrolled(1, (0, 0)).scrolled(1, (0, 0))
        window.sees(on_mesh(), "the torus two notches larger")

        screen.do("key", "p")
        window.hand = window.hand.in_other_projection()
        window.sees(on_mesh(), "the torus without vanishing lines")

        screen.do("key", "s")
        wait_until(lambda: (tmp_path / "soft.png").exists(), "the snapshot")
        words = render_command(file, window.hand.shown, SIZE, tmp_path / "rendered.png")
        CliRunner().invoke(render, words[2:], standalone_mode=False, catch_exceptions=False)
        assert (tmp_path / "soft.png").read_bytes() == (tmp_path / "rendered.png").read_bytes()

        # The combo at the top of the panel, and the third of its choices: flat, torus, sphere.
        screen.do("mousemove", "--sync", *window.at(SIZE[0] + PANEL_MIDDLE, 49), "sleep", 0.2, "click", 1, "sleep", 0.4)
        screen.do("key", "Escape", "sleep", 0.4, "click", 1, "sleep", 0.4)  # which closes the list, not the window
        screen.do("mousemove", "--sync", *window.at(SIZE[0] + PANEL_MIDDLE, 122), "sleep", 0.2, "click", 1)
        window.park()
        window.hand = window.hand.on_mesh("sphere")
        window.sees(on_mesh(), "the sphere")

        screen.ask_to_close(int(window.number))
        said, errors = window.process.communicate(timeout=PATIENCE_S)
        assert (window.process.returncode, errors) == (0, "")
        assert said == f"saved {tmp_path / 'soft.png'}\n"


def test_an_amc_is_shown_and_its_light_stands_still(screen: Desktop, renderer: Renderer, tmp_path: Path) -> None:
    file = tmp_path / "brushed.amc.ktx2"
    write_amc(file, brushed_amc(32, 16))
    with opened(screen, tmp_path, start("sphere", MESHES[1:], None), file, "--mesh", "sphere") as window:
        mesh, _ = mesh_of("sphere")
        view = window.hand.shown.view
        wanted = shown_codes(amc_picture(renderer, read_amc(file), mesh, view, size=SIZE, supersample=3))
        window.sees(wanted, "the AMC on a sphere")
        window.drag(3, Button.LIGHT, (100, 100), (260, 190))
        window.sees(wanted, "the same")
        screen.do("key", "q")
        assert window.process.wait(PATIENCE_S) == 0
        assert sorted(tmp_path.iterdir()) == [file], "nothing is left behind"
