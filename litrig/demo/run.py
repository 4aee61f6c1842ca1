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
from litrig.base.page import Figure, Section, Table, write_page
from litrig.base.progress import Report
from litrig.base.radiometry import to_u8
from litrig.demo.pictures import Pictures, frames_sheet, over, slices_sheet
from litrig.demo.stages import Stages
from processing.amc.build import AmcResult, build
from processing.amc.ktx2 import read_amc, write_amc
from processing.mesh.builtin import builtin_mesh
from processing.ptm.fit import fit
from processing.ptm.model import Ptm
from processing.ptm.ptm_file import read_ptm, write_ptm
from processing.stack import Stack
from rig.config import read_rig
from viewer.renderer import Renderer
from viewer.view import View

MARKER = ".litrig-demo"
BRUSHED, RELIEF = "brushed", "relief"
LIGHTS = ((-0.6, 0.5), (0.65, 0.45), (0.0, -0.75), (0.25, 0.1))
VIEWS = {"torus": View(yaw_deg=-24, pitch_deg=38, zoom=1.25), "cloth": View(yaw_deg=-18, pitch_deg=24, zoom=1.35)}


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
    picture: tuple[int, int] = (960, 720)

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
            "PTM": 0.3 + 0.01 * self.lights,
            "renders": 1 + 2 * pixels,
        }


def run_demo(folder: Path, size: DemoSize, report: Report) -> Path:
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
    with stages.stage(names[0]) as step:
        _capture(SimConfig(), AmcPlan(size.slices), brushed, step)
    with stages.stage(names[1]) as step:
        _capture(
            SimConfig.model_validate({"scene": {"kind": RELIEF}, "turntable": {"start_deg": 0.0}}),
            PtmPlan(size.lights),
            relief,
            step,
        )
    with stages.stage(names[2]) as step:
        result = build(read_capture(brushed), size=size.table, report=step)
        write_amc(folder / f"{BRUSHED}.amc.ktx2", result.amc)
    with stages.stage(names[3]) as step:
        _fit(relief, folder / f"{RELIEF}.ptm", step)
    pictures = Pictures(folder)
    with stages.stage(names[4]):
        sections = [
            _captured(pictures, brushed, relief, size),
            _amc(pictures, folder / f"{BRUSHED}.amc.ktx2", result, size),
            _ptm(pictures, read_ptm(folder / f"{RELIEF}.ptm")),
        ]
    write_page(folder / "index.html", "litrig demo", _lead(size), [*sections, _times(stages)])
    return folder / "index.html"


def _clear(folder: Path) -> None:
    if folder.exists() and any(folder.iterdir()):
        if not (folder / MARKER).is_file():
            raise InputError(f"{folder}: is not empty, and not an earlier demo; choose another folder with --out")
        shutil.rmtree(folder)
    (folder / "captures").mkdir(parents=True)
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


def _fit(source: Path, target: Path, report: Report) -> None:
    session = read_capture(source)
    lights = np.array([frame.light for frame in session.frames if frame.light is not None])
    write_ptm(target, fit(Stack.of(session), lights, source=session.digest, report=report))


def _captured(pictures: Pictures, brushed: Path, relief: Path, size: DemoSize) -> Section:
    sheets = (
        pictures.add("captured-brushed", frames_sheet(brushed, 8, 32), "The sphere turns, the light stays.", wide=True),
        pictures.add("captured-relief", frames_sheet(relief, 8, 32), "The relief stays, the lamp moves.", wide=True),
    )
    text = (
        f"{size.slices} slices of a brushed-metal sphere and {size.lights} light directions on a relief, shot through "
        "dynamixel-sdk, pyserial and OpenCV into capture folders; both verify as BagIt bags."
    )
    return Section("What was captured", text, sheets)


def _amc(pictures: Pictures, path: Path, result: AmcResult, size: DemoSize) -> Section:
    amc = read_amc(path)
    figures: list[Figure] = []
    with Renderer() as renderer:
        for name, view in VIEWS.items():
            picture = renderer.render_amc(amc, builtin_mesh(name), view, size=size.picture, supersample=2)
            figures.append(pictures.add(f"amc-{name}", over(picture), f"{path.name} on the {name}"))
    figures.append(pictures.add("amc-slices", slices_sheet(amc.slices, 8, 16), "Slices of the table.", wide=True))
    circle = result.circle
    text = (
        f"The sphere was found at ({circle.x_px:.1f}, {circle.y_px:.1f}) px, with a radius of "
        f"{circle.radius_px:.1f} px. "
        f"The material looks the same turned by 360°/R with R = {amc.invariance}: "
        f"{amc.slices.shape[0]} slices of {amc.slices.shape[1]} × {amc.slices.shape[2]} texels."
    )
    return Section("Anisotropic MatCap", text, figures)


def _ptm(pictures: Pictures, ptm: Ptm) -> Section:
    figures = []
    with Renderer() as renderer:
        for index, light in enumerate(LIGHTS):
            codes = to_u8(renderer.render_ptm(ptm, light))
            figures.append(pictures.add(f"ptm-{index}", codes, f"Light from ({light[0]:g}, {light[1]:g})"))
    return Section("Polynomial texture map", f"{RELIEF}.ptm, LRGB, under four lights.", figures)


def _times(stages: Stages) -> Section:
    rows = [(name, round(took_s, 1)) for name, took_s in stages.took_s.items()]
    rows.append(("all", round(sum(stages.took_s.values()), 1)))
    return Section("How long it took", table=Table(("step", "seconds"), rows))


def _lead(size: DemoSize) -> str:
    return (
        "A simulated servo turntable, light arm and camera were driven like real ones. The pictures became an "
        f"Anisotropic MatCap ({BRUSHED}.amc.ktx2) and a polynomial texture map ({RELIEF}.ptm), which lie beside "
        "this page."
    )
