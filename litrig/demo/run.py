"""Simulated rig → capture folders → materials → pictures → a page that shows it all."""

import shutil
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from acquisition.plans import AmcPlan, Plan, PtmPlan
from acquisition.session import SessionInfo, capture
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
from processing.amc.build import build
from processing.amc.ktx2 import read_amc, write_amc
from processing.ptm.fit import fit
from processing.ptm.ptm_file import read_ptm, write_ptm
from processing.ptm.quality import fit_quality
from processing.stack import Stack
from rig.config import read_rig

MARKER = ".litrig-demo"
BRUSHED, RELIEF = "brushed", "relief"


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

    def expected_s(self) -> dict[str, float]:
        """Return the stages and roughly what they take on two cores."""
        pixels = self.picture[0] * self.picture[1] / 1e6
        return {
            "capture of the brushed sphere": 6 + 0.29 * self.slices,
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
    stages = Stages(size.expected_s(), report)
    names = list(stages.expected_s)
    brushed, relief = folder / "captures" / BRUSHED, folder / "captures" / RELIEF
    amc_file, ptm_file = folder / f"{BRUSHED}.amc.ktx2", folder / f"{RELIEF}.ptm"
    with stages.stage(names[0]) as step:
        _capture(scenes.brushed_sphere(kind), AmcPlan(size.slices), brushed, step)
    with stages.stage(names[1]) as step:
        _capture(scenes.relief(kind), PtmPlan(size.lights), relief, step)
    with stages.stage(names[2]) as step:
        result = build(read_capture(brushed), size=size.table, report=step)
        write_amc(amc_file, result.amc)
    with stages.stage(names[3]) as step:
        session = read_capture(relief)
        lights = np.array([frame.light for frame in session.frames])
        stack = Stack.of(session)
        write_ptm(ptm_file, fit(stack, lights, source=session.digest, report=step))
        quality = fit_quality(read_ptm(ptm_file), stack, lights, report=step)
    pictures = Pictures(folder)
    with stages.stage(names[4]):
        parts: list[Section] = [
            sections.captured(pictures, brushed, relief, (size.slices, size.lights)),
            sections.material(pictures, result),
            sections.renders(pictures, read_amc(amc_file), size.picture),
            sections.relit(pictures, read_ptm(ptm_file)),
            sections.residuals(pictures, session, quality),
        ]
    write_page(folder / "index.html", "litrig demo", _lead(), [*parts, sections.times(stages)])
    return folder / "index.html"


def _clear(folder: Path) -> None:
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        if not (folder / MARKER).is_file():
            raise InputError(f"{folder}: is not empty, and not an earlier demo; choose another folder with --out")
        shutil.rmtree(folder)
    try:
        (folder / "captures").mkdir(parents=True)
    except OSError as error:
        raise InputError(f"{folder}: cannot be created ({error.strerror}); choose another place with --out") from error
    write_atomically(folder / MARKER, b"")


def _capture(sim: SimConfig, plan: Plan, folder: Path, report: Report) -> None:
    with simulated_rig(sim) as simulated:
        config = read_rig(simulated.rig_toml)
        info = SessionInfo(object_id=folder.name)
        if not capture(config, plan, folder, info, report=report, environment=simulated.environment):
            raise KeyboardInterrupt
    findings = verify_capture(folder).findings
    if findings:
        raise InputError(f"{folder}: {findings[0]}")


def _lead() -> str:
    return (
        "A simulated servo turntable, light arm and camera were driven like real ones. The pictures became an "
        f"Anisotropic MatCap ({BRUSHED}.amc.ktx2) and a polynomial texture map ({RELIEF}.ptm), which lie beside "
        "this page."
    )
