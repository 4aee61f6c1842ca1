"""Detections as a TOML file: written after every run, and replayed after a person has moved or dropped some.

The file names the balls, the camera of perspective pictures, and each picture's highlights. Numbers are written in
full, so that what is replayed unchanged gives the same directions to the last bit.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Self

import tomli_w
from pydantic import Field, model_validator

from litrig.base.camera_model import CameraModel
from litrig.base.config import StrictModel, read_toml
from litrig.base.errors import InputError
from litrig.base.files import write_atomically
from litrig.base.version import litrig_version
from processing.outline.circle import Circle
from processing.ptm.lights.highlight import Flag, Highlight
from processing.ptm.lights.mirror import Mirror


class EditedBall(StrictModel):
    """The outline of a ball, in pixels from the picture's upper left corner."""

    x_px: float
    y_px: float
    radius_px: float = Field(gt=0)


class EditedHighlight(StrictModel):
    """A lamp in a ball."""

    ball: int = Field(default=1, ge=1)
    """Number of the ball, from 1, in the order in which the file names them."""
    x_px: float
    y_px: float
    spread_px: float = Field(default=0.0, ge=0)
    """RMS radius of the blob; says how sure the place is."""
    flags: tuple[Flag, ...] = ()
    """What is doubtful; clear it once looked at."""


class EditedFrame(StrictModel):
    """The highlights of one picture; one that is not named in the file is looked at anew."""

    name: str
    drop: bool = False
    """Leave this picture out of the list."""
    highlight: tuple[EditedHighlight, ...] = ()
    """At most one a ball; a ball without one lies in shadow."""

    @model_validator(mode="after")
    def _one_a_ball(self) -> Self:
        numbers = [highlight.ball for highlight in self.highlight]
        if len(set(numbers)) < len(numbers):
            raise ValueError(f"{self.name} has two highlights in one ball; keep the lamp's")
        return self


class Edits(StrictModel):
    """A file of detections."""

    ball: tuple[EditedBall, ...] = ()
    """The balls; found anew when none is named."""
    camera: CameraModel | None = None
    """The camera of perspective pictures."""
    frame: tuple[EditedFrame, ...] = ()

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        names = [frame.name for frame in self.frame]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"frame {name} stands twice; keep one")
        if any(frame.highlight for frame in self.frame) and not self.ball:
            raise ValueError("frames have highlights and no [[ball]] is named; copy the balls too")
        for frame in self.frame:
            for highlight in frame.highlight:
                if highlight.ball > len(self.ball):
                    raise ValueError(f"{frame.name} has a highlight in ball {highlight.ball} of {len(self.ball)}")
        return self

    def of(self, name: str) -> EditedFrame | None:
        """Return what the file says about a picture."""
        return next((frame for frame in self.frame if frame.name == name), None)

    def highlights(self, frame: EditedFrame) -> list[Highlight | None]:
        """Return a picture's highlights, one a ball."""
        found: list[Highlight | None] = [None] * len(self.ball)
        for place in frame.highlight:
            found[place.ball - 1] = Highlight(place.x_px, place.y_px, place.spread_px, place.flags)
        return found


def read_edits(path: Path, names: Sequence[str], folder: Path) -> Edits:
    """Read edits for the pictures of a folder.

    Raises
    ------
    ConfigError, InputError
        The file does not fit the model, or names a picture that is not there, or a highlight beside its ball.
    """
    edits = read_toml(path, Edits)
    for frame in edits.frame:
        if frame.name not in names:
            raise InputError(f"{path}: names {frame.name}, which is not among the pictures of {folder}; mend the name")
        for place in frame.highlight:
            ball = edits.ball[place.ball - 1]
            if (place.x_px - ball.x_px) ** 2 + (place.y_px - ball.y_px) ** 2 > ball.radius_px**2:
                raise InputError(
                    f"{path}: the highlight of {frame.name} at {place.x_px:g}, {place.y_px:g} lies beside ball "
                    f"{place.ball}; move it inside, or take it out if the ball is in shadow"
                )
    return edits


def write_detections(
    path: Path,
    balls: Sequence[Mirror],
    frames: Sequence[tuple[str, bool, Sequence[Highlight | None]]],
    replay: str,
) -> None:
    """Write detections in the form that `read_edits` reads.

    Parameters
    ----------
    frames : name, dropped, and highlights one a ball
    replay : the command that replays the file
    """
    camera = balls[0].camera
    table = {
        "ball": [_ball(ball.circle) for ball in balls],
        **({} if camera is None else {"camera": camera.model_dump()}),
        "frame": [_frame(*frame) for frame in frames],
    }
    head = (
        f"# Made by litrig {litrig_version()}, and written anew by every run. To move or drop a detection, change a\n"
        f"# copy and replay it:\n# {replay}\n\n"
    )
    write_atomically(path, (head + tomli_w.dumps(table)).encode())


def _ball(circle: Circle) -> dict[str, float]:
    return {"x_px": float(circle.x_px), "y_px": float(circle.y_px), "radius_px": float(circle.radius_px)}


def _frame(name: str, dropped: bool, highlights: Sequence[Highlight | None]) -> dict[str, object]:
    return {
        "name": name,
        **({"drop": True} if dropped else {}),
        "highlight": [
            {
                "ball": number,
                "x_px": float(found.x_px),
                "y_px": float(found.y_px),
                "spread_px": float(found.spread_px),
                **({"flags": [str(flag) for flag in found.flags]} if found.flags else {}),
            }
            for number, found in enumerate(highlights, 1)
            if found is not None
        ],
    }
