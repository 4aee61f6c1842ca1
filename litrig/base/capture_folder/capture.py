"""What a capture folder has to say to those who process it."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np
from numpy.typing import NDArray


class Role(StrEnum):
    """What a frame is for."""

    FRAME = "frame"
    WHITE = "white"
    DARK = "dark"
    BALL = "ball"
    CHART = "chart"
    CLOSURE = "closure"


@dataclass(frozen=True)
class Exposure:
    """One of the files that make a picture.

    Attributes
    ----------
    path : the file
    exposure_ev : stops above the exposure that the picture is meant to have
    """

    path: Path
    exposure_ev: float = 0.0


@dataclass(frozen=True)
class CapturedFrame:
    """One good picture of a session: a file, or several exposures at one pose that are meant to become one.

    Attributes
    ----------
    path : the picture file; of several, the first of the usual exposure
    role : what it is for
    angle_deg : turntable angle read back, counter-clockwise as the camera sees it; None where there was no turntable
    light : (3,) float64, unit, view frame, sample to light; None where the light was not the rig's to move
    light_position_mm : (3,) where the light stood, as `Lights` has it; None where it is not known
    light_gain : (3,) by what linear R, G, B are to be multiplied, to make unequal lamps equal; None where they are
    exposures : all files of a bracket or an average; empty where the picture is the one file
    """

    path: Path
    role: Role = Role.FRAME
    angle_deg: float | None = None
    light: NDArray[np.float64] | None = None
    light_position_mm: NDArray[np.float64] | None = None
    light_gain: NDArray[np.float64] | None = None
    exposures: tuple[Exposure, ...] = ()


@dataclass(frozen=True)
class Capture:
    """The good frames of a capture folder or of a plain folder of pictures.

    Attributes
    ----------
    folder : where it lies
    object_id : what was on the table
    frames : in the order in which they were planned
    tangent_zero_deg : tangent angle of the sample at turntable zero, from the view frame's x axis (AMC sessions)
    sphere_distance_radii : camera to sphere centre in sphere radii, if the operator measured it
    picture_width_mm : how much of the sample the pictures' width covers, if the list of lights says so
    lights_from : the list that the light directions came from; None where they did not come from one
    remarks : what a person should know of how pictures and lights were paired
    digest : sha256 over the names and digests of all frames, to tell in a result what it was made from
    """

    folder: Path
    object_id: str
    frames: tuple[CapturedFrame, ...]
    tangent_zero_deg: float = 0.0
    sphere_distance_radii: float | None = None
    digest: str = ""
    picture_width_mm: float | None = None
    lights_from: Path | None = None
    remarks: tuple[str, ...] = ()

    def having(self, role: Role) -> Iterator[CapturedFrame]:
        """Go through the frames of one role."""
        return (frame for frame in self.frames if frame.role is role)
