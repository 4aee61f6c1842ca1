"""The pictures, plots and videos of the demo's page."""

from collections.abc import Iterable, Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from litrig.base.capture_folder import layout
from litrig.base.contact_sheet import contact_sheet
from litrig.base.page import Figure
from litrig.base.pictures import read_codes, write_codes
from litrig.base.plots import ACCENT, LINE, QUIET, plot
from litrig.base.radiometry import encode_srgb, to_u8
from processing.amc.invariance import InvarianceReport
from viewer.video import write_video

Codes = NDArray[np.uint8]
F32 = NDArray[np.float32]

SECTION_WIDTH_PX = 512


class Pictures:
    """Writes pictures below the page, and hands out the figures that show them."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        (folder / "pictures").mkdir(parents=True, exist_ok=True)

    def add(self, name: str, codes: Codes, caption: str, *, wide: bool = False) -> Figure:
        """Write one picture, (H, W, 3) or (H, W, 4) uint8."""
        file = f"pictures/{name}.png"
        write_codes(self._folder / file, codes)
        return Figure(file, caption, wide, (codes.shape[1], codes.shape[0]))

    def video(self, name: str, frames: Iterable[Codes], caption: str, size: tuple[int, int]) -> Figure:
        """Write a video of pictures of `size`, width and height."""
        file = f"pictures/{name}.mp4"
        write_video(self._folder / file, frames, size)
        return Figure(file, caption, wide=True, size=size)

    def rotation_curve(self, name: str, report: InvarianceReport, caption: str) -> Figure:
        """Plot how much the slices differ from themselves, turned."""
        file = f"pictures/{name}.png"
        turns_deg = np.arange(361.0)
        with plot(self._folder / file, (7.0, 3.0)) as axes:
            axes.plot(turns_deg, report.rotation_difference(turns_deg), color=ACCENT, linewidth=2)
            for repeats in (2, 3, 4):
                axes.axvline(360 / repeats, color=LINE, linewidth=1)
                axes.annotate(f"R = {repeats}", (360 / repeats + 4, 0), color=QUIET, fontsize=8)
            axes.set(xlabel="turned by, degrees", ylabel="RMS difference, linear light", xlim=(0, 360), ylim=(0, None))
        return Figure(file, caption, wide=True, size=(1050, 450))

    def errors_over_lights(self, name: str, lights: NDArray[np.float64], psnr_db: F32, caption: str) -> Figure:
        """Plot the error of each picture where its light stood, seen from the camera."""
        file = f"pictures/{name}.png"
        with plot(self._folder / file, (4.4, 3.6)) as axes:
            circle = np.radians(np.arange(361))
            axes.plot(np.cos(circle), np.sin(circle), color=LINE, linewidth=1)
            dots = axes.scatter(lights[:, 0], lights[:, 1], c=psnr_db, cmap="inferno", s=46)
            axes.set(xlabel="l_u", ylabel="l_v", aspect="equal", xticks=(-1, 0, 1), yticks=(-1, 0, 1))
            bar = axes.figure.colorbar(dots, ax=axes, label="PSNR, dB")
            bar.ax.tick_params(colors=QUIET)
            bar.ax.yaxis.label.set_color(QUIET)
        return Figure(file, caption, size=(660, 540))


def frames_sheet(capture: Path, columns: int, most: int) -> Codes:
    """Lay out the thumbnails of a session, at most so many, evenly chosen."""
    thumbs = sorted((capture / layout.THUMBS).iterdir())
    chosen = [thumbs[i] for i in evenly(len(thumbs), most)]
    return contact_sheet([np.asarray(read_codes(path), np.uint8) for path in chosen], columns, 144)


def slices_sheet(slices: F32, columns: int, most: int) -> Codes:
    """Lay out slices of an AMC, (D, S, S, 3) linear."""
    return contact_sheet([to_u8(encode_srgb(slices[i])) for i in evenly(len(slices), most)], columns, 144)


def sections_sheet(slices: F32, repeats: int) -> Codes:
    """Cut the volume through its middle along both axes of the normal (the AMC paper's figure 6), k upwards."""
    middle = slices.shape[1] // 2
    cuts = [np.tile(cut, (repeats, 1, 1))[::-1] for cut in (slices[:, middle], slices[:, :, middle])]
    codes = [to_u8(encode_srgb(cut)) for cut in cuts]
    size = (SECTION_WIDTH_PX, SECTION_WIDTH_PX)
    return contact_sheet(
        [np.asarray(cv2.resize(cut, size, interpolation=cv2.INTER_CUBIC), np.uint8) for cut in codes],
        2,
        SECTION_WIDTH_PX,
    )


def residuals_picture(residuals: F32, full: float) -> Codes:
    """Paint errors (H, W) as heat, `full` and above as the hottest."""
    grey = to_u8(residuals / full)
    return np.asarray(cv2.cvtColor(cv2.applyColorMap(grey, cv2.COLORMAP_INFERNO), cv2.COLOR_BGR2RGB), np.uint8)


def over(picture: F32, background: Sequence[float] = (0.012, 0.011, 0.010)) -> Codes:
    """Lay a rendered picture, (H, W, 4) linear light and coverage, over a background and encode it."""
    coverage = picture[..., 3:]
    blended = picture[..., :3] * coverage + np.asarray(background, np.float32) * (1 - coverage)
    return to_u8(encode_srgb(blended))


def evenly(count: int, most: int) -> list[int]:
    """Choose at most so many of `count` indices, evenly, beginning with the first."""
    return [i * count // min(count, most) for i in range(min(count, most))]
