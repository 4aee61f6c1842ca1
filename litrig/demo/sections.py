"""The sections of the demo's page."""

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from litrig.base.capture_folder.capture import Capture
from litrig.base.page import Figure, Section, Table
from litrig.base.radiometry import to_u8
from litrig.demo.pictures import (
    Pictures,
    frames_sheet,
    over,
    residuals_picture,
    sections_sheet,
    slices_sheet,
)
from litrig.demo.stages import Stages
from processing.amc.build import AmcResult
from processing.amc.isotropic import isotropic_matcap
from processing.amc.model import Amc
from processing.mesh.builtin import builtin_mesh
from processing.ptm.model import Ptm
from processing.ptm.quality import FitQuality
from viewer.flat_picture import FlatView, flat_picture, open_flat
from viewer.materials.amc import amc_picture
from viewer.materials.ptm_shading import PtmShading, shading_lights
from viewer.renderer import Renderer
from viewer.view import View

LIGHTS = ((-0.6, 0.5), (0.65, 0.45), (0.0, -0.75), (-0.35, -0.45))
VIEWS = {
    "torus": View(yaw_deg=-24, pitch_deg=38, zoom=1.25),
    "cloth": View(yaw_deg=-18, pitch_deg=24, zoom=1.2),
}
TOUR_FRAMES = 75
TOUR_RADIUS = 0.72
HOTTEST_RESIDUAL = 0.12


def captured(pictures: Pictures, brushed: Path, relief: Path, frames: tuple[int, int]) -> Section:
    """Show what the two sessions shot."""
    sheets = (
        pictures.add("captured-brushed", frames_sheet(brushed, 8, 32), "The sphere turns, the light stays.", wide=True),
        pictures.add("captured-relief", frames_sheet(relief, 8, 32), "The relief stays, the lamp moves.", wide=True),
    )
    text = (
        f"{frames[0]} slices of a brushed-metal sphere and {frames[1]} light directions on a relief, shot through "
        "dynamixel-sdk, pyserial and OpenCV into capture folders; both verify as BagIt bags."
    )
    return Section("What was captured", text, sheets)


def material(pictures: Pictures, result: AmcResult) -> Section:
    """Show how the table came about, and the table itself."""
    amc, circle = result.amc, result.outline.circle
    text = (
        f"The sphere was found at ({circle.x_px:.1f}, {circle.y_px:.1f}) px, with a radius of "
        f"{circle.radius_px:.1f} px. "
        f"Turned by 360°/R with R = {amc.invariance}, its slices come back to themselves; the table keeps "
        f"{amc.slices.shape[0]} slices of {amc.slices.shape[1]} × {amc.slices.shape[2]} texels."
    )
    figures = (
        pictures.rotation_curve("invariance", result.invariance, "How far slices differ from themselves, turned."),
        pictures.add(
            "amc-slices", slices_sheet(amc.slices, 8, 16), "Slices of the table, one tangent each.", wide=True
        ),
        pictures.add(
            "amc-sections",
            sections_sheet(amc.slices, amc.repeats),
            "The table cut through its middle: the normal's x (left) and y (right) across, the tangent's turn upwards.",
            wide=True,
        ),
    )
    return Section("Anisotropic MatCap", text, figures)


def renders(pictures: Pictures, amc: Amc, size: tuple[int, int]) -> Section:
    """Show the material on meshes, with its anisotropy and without."""
    plain = Amc(isotropic_matcap(amc)[None], amc.valid[:1], "isotropic", amc.table_normal)
    figures = []
    with Renderer() as renderer:
        for name, view in VIEWS.items():
            for kind, table in (("anisotropic", amc), ("isotropic", plain)):
                picture = amc_picture(renderer, table, builtin_mesh(name), view, size=size, supersample=2)
                figures.append(pictures.add(f"amc-{name}-{kind}", over(picture), f"{name.capitalize()}, {kind}"))
    text = "The same table on a torus and on draped cloth; beside it the plain MatCap that is the mean of its slices."
    return Section("Anisotropic beside isotropic", text, figures, columns=2)


def relit(pictures: Pictures, ptm: Ptm) -> Section:
    """Show the PTM under four lights, and under one that moves."""
    figures: list[Figure] = []
    with Renderer() as renderer:
        even = _even(ptm)
        size = (even.shape[1], even.shape[0])
        with open_flat(renderer, even, FlatView(), normals=False, brightest=False) as draw:
            frames = (to_u8(draw(_under(light), False)) for light in _tour())
            figures.append(pictures.video("ptm-tour", frames, "The light goes round.", size))
        for index, light in enumerate(LIGHTS):
            codes = to_u8(flat_picture(renderer, ptm, _under(light)))
            figures.append(pictures.add(f"ptm-{index}", codes, f"Light from ({light[0]:g}, {light[1]:g})"))
    return Section("Polynomial texture map", "relief.ptm, LRGB, relit.", figures)


def residuals(pictures: Pictures, session: Capture, quality: FitQuality) -> Section:
    """Show how far the PTM is from what was captured."""
    lights = np.array([frame.light for frame in session.frames])
    levels: NDArray[np.float32] = quality.per_light_db.astype(np.float32)
    heat = residuals_picture(quality.residuals, HOTTEST_RESIDUAL)
    worst = session.frames[quality.worst(1)[0]].path.name
    figures = (
        pictures.add("ptm-residuals", heat, f"RMS error of each pixel; white is {HOTTEST_RESIDUAL:g} of full scale."),
        pictures.errors_over_lights("ptm-lights", lights, levels, "PSNR of each picture, where its light stood."),
    )
    text = (
        f"{quality.psnr_db:.1f} dB over all pictures; worst is {worst} with {levels.min():.1f} dB. Six coefficients a "
        "pixel are smooth in the light, so cast shadows and highlights are what is left over."
    )
    return Section("What the PTM leaves over", text, figures, columns=2)


def times(stages: Stages) -> Section:
    """Tell how long each stage took."""
    rows = [(name, round(took_s, 1)) for name, took_s in stages.took_s.items()]
    rows.append(("all", round(sum(stages.took_s.values()), 1)))
    return Section("How long it took", table=Table(("step", "seconds"), rows))


def _under(light: tuple[float, float]) -> PtmShading:
    return PtmShading(shading_lights((light,)))


def _tour() -> Iterator[tuple[float, float]]:
    for index in range(TOUR_FRAMES):
        angle = math.tau * index / TOUR_FRAMES
        yield TOUR_RADIUS * math.cos(angle), TOUR_RADIUS * math.sin(angle)


def _even(ptm: Ptm) -> Ptm:
    """Cut off an odd last row or column: a video has even sides."""
    height, width = (side // 2 * 2 for side in ptm.coefficients.shape[1:3])
    colour = None if ptm.colour is None else ptm.colour[:height, :width]
    return replace(ptm, coefficients=ptm.coefficients[:, :height, :width], colour=colour)
