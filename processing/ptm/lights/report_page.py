"""A page that shows every detection: each ball in each picture, its outline, and a cross on the highlight."""

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from litrig.base.contact_sheet import contact_sheet
from litrig.base.directions import angles_from_direction
from litrig.base.page import Figure, Section, Table, write_page
from litrig.base.pictures import write_codes
from litrig.base.plots import ACCENT, QUIET, plot
from litrig.base.radiometry import encode_srgb, to_u8
from processing.ptm.lights.combine import Light
from processing.ptm.lights.estimate import Session
from processing.ptm.lights.report import describe

F32 = NDArray[np.float32]
U8 = NDArray[np.uint8]

_CELL_PX, _COLUMNS, _CAPTION_PX = 220, 5, 18
_SUBPIXEL_BITS = 4
_OUTLINE, _GOOD, _DOUBTFUL, _INK = (110, 120, 160), (90, 230, 120), (240, 120, 60), (220, 216, 208)
_CROSS_PX = 9
_DARK_QUANTILE, _DARK_SHOWN = 0.8, 0.04


def write_report(folder: Path, session: Session) -> Path:
    """Write FOLDER/index.html and its pictures; return the page."""
    folder.mkdir(parents=True, exist_ok=True)
    sections = [_directions(folder, session)]
    for ball in range(len(session.balls)):
        white = _white(session.crops[ball])
        cells = [_cell(session, ball, index, white) for index in range(len(session.lights))]
        sheet = contact_sheet(cells, min(_COLUMNS, len(cells)), _CELL_PX)
        file = f"ball_{ball + 1}.png"
        write_codes(folder / file, sheet)
        caption = "every picture: outline, and a cross on the highlight (green; orange where doubtful or left out)"
        text = f"{str(session.balls[ball].circle).capitalize()}. Shadows are brightened."
        figure = Figure(file, caption, wide=True, size=(sheet.shape[1], sheet.shape[0]))
        sections.append(Section(f"Ball {ball + 1}", text, [figure]))
    page = folder / "index.html"
    lead = " ".join(f"{line[0].upper()}{line[1:]}." for line in describe(session))
    write_page(page, "Light directions", lead, sections)
    return page


def _directions(folder: Path, session: Session) -> Section:
    kept = [light.direction for light in session.lights if not light.left_out and light.direction is not None]
    with plot(folder / "directions.png", (4.2, 4.2)) as axes:
        turn = np.linspace(0, 2 * np.pi, 181)
        axes.plot(np.cos(turn), np.sin(turn), color=QUIET, linewidth=0.8)
        axes.plot([direction[0] for direction in kept], [direction[1] for direction in kept], "o", color=ACCENT)
        axes.set(xlabel="x, to the right", ylabel="y, up", aspect="equal")
    headings = ("picture", "azimuth, deg", "elevation, deg", "known to, deg", "between balls, deg", "remarks")
    figure = Figure("directions.png", "the lights as seen from the camera; the circle is the horizon")
    table = Table(headings, [_row(light) for light in session.lights])
    return Section("Directions", "", [figure], table, columns=2)


def _row(light: Light) -> list[str]:
    remarks = _remarks(light)
    if light.direction is None:
        return [light.name, "", "", "", "", remarks]
    azimuth_deg, elevation_deg = angles_from_direction(light.direction)
    between = "" if light.residual_deg is None else f"{light.residual_deg:.2f}"
    return [light.name, f"{azimuth_deg:.2f}", f"{elevation_deg:.2f}", f"{light.deviation_deg:.2f}", between, remarks]


def _remarks(light: Light) -> str:
    doubts = [flag for flag in light.flags if flag != light.left_out]
    return ", ".join([*doubts, *([f"left out: {light.left_out}"] if light.left_out else [])])


def _cell(session: Session, ball: int, index: int, white: float) -> U8:
    """Draw one ball of one picture, with what was found in it and the picture's name below."""
    light, frame = session.lights[index], session.crop_frames[ball]
    crop = session.crops[ball][index]
    scale = _CELL_PX / crop.shape[1]
    size = (_CELL_PX, max(1, round(crop.shape[0] * scale)))
    grey = np.asarray(cv2.resize(crop, size, interpolation=cv2.INTER_AREA)) / white
    picture = np.stack([to_u8(encode_srgb(grey))] * 3, axis=-1)
    circle = frame.inner(session.balls[ball].circle)
    _draw_circle(picture, circle.x_px * scale, circle.y_px * scale, circle.radius_px * scale)
    found = session.highlights[index][ball]
    if found is not None:
        colour = _DOUBTFUL if found.flags or light.left_out else _GOOD
        x, y = (found.x_px - frame.left_px) / frame.factor * scale, (found.y_px - frame.top_px) / frame.factor * scale
        _draw_cross(picture, x, y, colour)
    remarks = _remarks(light)
    caption = np.zeros((_CAPTION_PX * (2 if remarks else 1), _CELL_PX, 3), np.uint8)
    for line, (words, ink) in enumerate([(light.name, _INK), (remarks, _DOUBTFUL)]):
        cv2.putText(caption, words, (3, 13 + line * _CAPTION_PX), cv2.FONT_HERSHEY_SIMPLEX, 0.4, ink, 1, cv2.LINE_AA)
    return np.concatenate([picture, caption])


def _white(crops: F32) -> float:
    """Return the light that is shown as white: what is dark becomes a dark grey, unless all is bright enough."""
    dark = float(np.quantile(crops, _DARK_QUANTILE))
    return max(min(dark / _DARK_SHOWN, float(crops.max())), 1e-9)


def _draw_circle(picture: U8, x: float, y: float, radius: float) -> None:
    centre = (_fixed(x - 0.5), _fixed(y - 0.5))
    cv2.circle(picture, centre, _fixed(radius), _OUTLINE, 1, cv2.LINE_AA, _SUBPIXEL_BITS)


def _draw_cross(picture: U8, x: float, y: float, colour: tuple[int, int, int]) -> None:
    for across, down in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        # A gap in the middle leaves the highlight to be seen.
        ends = [
            (_fixed(x - 0.5 + across * reach), _fixed(y - 0.5 + down * reach)) for reach in (_CROSS_PX / 3, _CROSS_PX)
        ]
        cv2.line(picture, ends[0], ends[1], colour, 1, cv2.LINE_AA, _SUBPIXEL_BITS)


def _fixed(value: float) -> int:
    return int(np.rint(value * 2**_SUBPIXEL_BITS))
