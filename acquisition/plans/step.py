"""One wanted frame, as plan.jsonl and the runner know it."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any

from litrig.base.capture_folder.capture import Role


@dataclass(frozen=True)
class Aim:
    """A light direction in the view frame, in degrees, and the lamp that shines from it."""

    azimuth_deg: float
    elevation_deg: float
    lamp: int = 0


@dataclass(frozen=True)
class Step:
    """One wanted frame.

    Attributes
    ----------
    step : its number in the plan, by which the frame is known for ever
    role : what the frame is for
    angle_deg : where the turntable stands; None leaves it alone
    aim : where the light comes from; None leaves the lights alone
    exposure_ev : stops above the rig's own exposure time, for brackets
    repeat : which of the frames that are alike, for averages
    lit : whether the lamps shine; a dark frame is shot without
    ask : what a person must have done before, such as to put the white card there; empty for nothing
    """

    step: int
    role: Role = Role.FRAME
    angle_deg: float | None = None
    aim: Aim | None = None
    exposure_ev: float = 0.0
    repeat: int = 0
    lit: bool = True
    ask: str = ""

    @property
    def stem(self) -> str:
        """A file name without ending that tells the pose to a human reader."""
        parts = [f"{self.step:06d}"]
        if self.role is not Role.FRAME:
            parts.append(self.role)
        if self.angle_deg is not None:
            parts.append(f"tt{self.angle_deg:06.2f}")
        if self.aim is not None:
            parts.append(f"az{self.aim.azimuth_deg:06.2f}_el{self.aim.elevation_deg:05.2f}")
        if self.exposure_ev:
            parts.append(f"ev{self.exposure_ev:+.1f}")
        if self.repeat:
            parts.append(f"n{self.repeat + 1:02d}")
        return "_".join(parts)

    def as_json(self) -> Mapping[str, Any]:
        """Return the step as plan.jsonl has it: what is as usual is left out."""
        usual = {field.name: field.default for field in fields(self) if field.name not in ("step", "role")}
        return {key: value for key, value in asdict(self).items() if key not in usual or value != usual[key]}
