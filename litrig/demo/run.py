"""Simulated rig → capture folders → materials → pictures → a page that shows it all."""

import shutil
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from acquisition.plans import Plan, amc_plan, ptm_plan
from acquisition.session import capture
from acquisition.session_info import SessionInfo
from acquisition.watching import watching
from firmware_sim.config import SimConfig
from firmware_sim.launch import simulated_rig
from litrig.base.capture_folder.reader import read_capture
from litrig.base.capture_folder.verify import verify_capture
from litrig.base.errors import InputError
from litrig.base.files import write_atomically
from litrig.base.page import Section, write_page
from litrig.base.progress import Report
from litrig.demo import scenes, sections
from litrig.demo.pictures import Pictures
from litrig.demo.scenes import SceneKind
from litrig.demo.stages import Stages
from litrig.simulated import render_ahead
from processing.amc.build import build
from processing.amc.files.ktx2 import read_amc, write_amc
from processing.amc.settings import Settings
from processing.ptm.files.ptm_file import read_ptm, write_ptm
from processing.ptm.fit import fit
from processing.ptm.quality import fit_quality
from processing.stack import Stack
from rig.config import read_rig

MARKER = ".litrig-demo"
BRUSHED, RELIEF = "brushed", "relief"
SECONDS_A_RENDERED_FRAME = 0.5


@dataclass(frozen=True)
class DemoSize:
    """How much the demo shoots, and how large its results are.

    Attributes
    ----------
    slices, lights : frames of the two sessions
    table : texels along a side of the AMC
    picture : width and height of a rendered picture in pixels
    """

    slices: int = 64
    lights: int = 50
    table: int = 128
    picture: tuple[int, int] = (800, 600)

    @classmethod
    def small(cls) -> "DemoSize":
        """Return a size that is done in a quarter of the time."""
        return cls(slices=16, lights=12, table=48, picture=(320, 240))

    def expected_s(self, kind: SceneKind) -> dict[str, float]:
        """Return the stages and roughly what they take on two cores."""
        pixels = self.picture[0] * self.picture[1] / 1e6
        a_frame = {SceneKind.ANALYTIC: 0.0, SceneKind.MITSUBA: SECONDS_A_RENDERED_FRAME}[kind]
        return {
            "frames of the brushed sphere": 0.5 + a_frame * self.slices,
            "capture of the brushed sphere": 6 + 0.29 * self.slices,
            "frames of the relief": 0.5 + a_frame * self.lights,
            "capture of the relief": 9 + 0.54 * self.lights,
            "Anisotropic MatCap": 1 + 0.03 * self.slices,
            "PTM": 0.5 + 0.02 * self.lights,
            "renders": 3 + 6 * pixels,
        }


def run_demo(folder: Path, size: DemoSize, kind: SceneKind, report: Report) -> Path:
    """Run the demo into a folder and return its page.

    Raises
    ------
    InputError
        The folder holds something that is not an earlier demo.
    """
    _clear(folder)
    stages = Stages(size.expected_s(kind), report)
    brushed, relief = folder / "captures" / BRUSHED, folder / "captures" / RELIEF
    amc_file, ptm_file = folder / f"{BRUSHED}.amc.ktx2", folder / f"{RELIEF}.ptm"
    _capture("brushed sphere", scenes.brushed_sphere(kind), amc_plan(size.slices), brushed, stages)
    _capture("relief", scenes.relief(kind), ptm_plan(size.lights), relief, stages)
    with stages.stage("Anisotropic MatCap") as step:
        result = build(read_capture(brushed), Settings(size=size.table), report=step)
        write_amc(amc_file, result.amc)
    with stages.stage("PTM") as step:
        session = read_capture(relief)
        lights = np.array([frame.light for frame in session.frames])
        stack = Stack.of(session)
        write_ptm(ptm_file, fit(stack, lights, source=session.digest, report=step))
        quality = fit_quality(read_ptm(ptm_file), stack, lights, report=step)
    pictures = Pictures(folder)
    with stages.stage("renders"):
        parts: list[Section] = [
            sections.captured(pictures, brushed, relief, (size.slices, size.lights)),
            sections.material(pictures, result),
            sections.renders(pictures, read_amc(amc_file), size.picture),
            sections.relit(pictures, read_ptm(ptm_file)),
            sections.residuals(pictures, session, quality),
        ]
    write_page(folder / "index.html", "litrig demo", _lead(kind), [*parts, sections.times(stages)])
    return folder / "index.html"


def _clear(folder: Path) -> None:
    try:
        if folder.exists() and not folder.is_dir():
            raise InputError(f"{folder}: is a file; choose another folder with --out")
        if folder.exists() and any(folder.iterdir()):
            _remove_earlier(folder)
        (folder / "captures").mkdir(parents=True)
    except OSError as error:
        raise InputError(f"{folder}: cannot be created ({error.strerror}); choose another place with --out") from error
    write_atomically(folder / MARKER, b"")


def _remove_earlier(folder: Path) -> None:
    if not (folder / MARKER).is_file():
        raise InputError(f"{folder}: is not empty, and not an earlier demo; choose another folder with --out")
    if folder.is_symlink():
        raise InputError(f"{folder}: is a link to an earlier demo; name that folder itself with --out")
    shutil.rmtree(folder)


def _capture(what: str, sim: SimConfig, plan: Plan, folder: Path, stages: Stages) -> None:
    with simulated_rig(sim) as simulated:
        with stages.stage(f"frames of the {what}") as step:
            render_ahead(simulated, plan, step)
        config = read_rig(simulated.rig_toml)
        info = SessionInfo(object_id=folder.name)
        with stages.stage(f"capture of the {what}") as step:
            operator = watching("frames", step)
            complete = capture(config, plan, folder, info, operator=operator, environment=simulated.environment)
    if not complete:
        raise KeyboardInterrupt
    findings = verify_capture(folder).findings
    if findings:
        raise InputError(f"{folder}: {findings[0]}")


def _lead(kind: SceneKind) -> str:
    light = " What the camera saw was rendered by mitsuba." if kind is SceneKind.MITSUBA else ""
    return (
        "A simulated servo turntable, light arm and camera were driven like real ones. The pictures became an "
        f"Anisotropic MatCap ({BRUSHED}.amc.ktx2) and a polynomial texture map ({RELIEF}.ptm), which lie beside "
        f"this page.{light}"
    )
