"""What litrig itself wants to know of each part in RIG.toml, whatever drives it.

A driver's own model derives from one of these, gives `kind` a Literal, and adds what it needs.
"""

from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, model_validator

from litrig.base.config import StrictModel
from rig.errors import OutOfRangeError

Positive = Annotated[float, Field(gt=0)]
Turns = Annotated[float, Field(ge=-90_000, le=90_000)]
Port = Annotated[str, Field(pattern=r"^[^\x00]+$")]


class TurntableSection(StrictModel):
    """A turntable."""

    kind: str
    """The driver."""
    serial_number: str = ""
    """Serial number or inventory mark, for the session's records."""
    port: Port
    """Where it is plugged in."""
    tolerance_deg: Positive = 0.3
    """How far the angle read back may be from its goal."""
    min_deg: Turns = -360.0
    """Lowest angle that the cables allow."""
    max_deg: Turns = 720.0
    """Highest angle that the cables allow."""
    park_deg: float = 0.0
    """Where the table rests at the end of a session."""

    @model_validator(mode="after")
    def _limits_in_order(self) -> Self:
        if not self.min_deg <= self.park_deg <= self.max_deg:
            raise ValueError(f"park_deg ({self.park_deg:g}) must lie between min_deg and max_deg, and these in order")
        return self

    @property
    def instrument(self) -> str:
        """Name it in a session's records."""
        return f"turntable of kind {self.kind}"

    def check_limits(self, angle_deg: float) -> None:
        """Refuse an angle that the cables do not allow."""
        if not self.min_deg <= angle_deg <= self.max_deg:  # so written, NaN is refused too
            raise OutOfRangeError(
                f"turntable: {angle_deg:g}° is outside {self.min_deg:g}..{self.max_deg:g}°; nothing moved. "
                "Ask for an angle inside, or widen min_deg and max_deg in RIG.toml if the cables allow."
            )


class ArmSection(StrictModel):
    """A light arm."""

    kind: str
    """The driver."""
    serial_number: str = ""
    """Serial number or inventory mark, for the session's records."""
    port: Port
    """Where it is plugged in."""
    tolerance_deg: Positive = 0.2
    """How far a joint read back may be from its goal."""
    park_azimuth_deg: float = 0.0
    """Where the arm rests at the end of a session."""
    park_elevation_deg: float = 45.0
    """Where the arm rests at the end of a session."""

    @property
    def instrument(self) -> str:
        """Name it in a session's records."""
        return f"light arm on {self.kind}"


class LightsSection(StrictModel):
    """Lamps."""

    kind: str
    """The driver."""
    serial_number: str = ""
    """Serial number or inventory mark, for the session's records."""

    @property
    def switchable(self) -> bool:
        """Whether they go dark when they are told to."""
        return True

    @property
    def directions_deg(self) -> tuple[tuple[float, float], ...]:
        """Azimuth and elevation, view frame, that each lamp of a dome shines from; empty if that is not fixed."""
        return ()

    @property
    def instrument(self) -> str:
        """Name them in a session's records; empty if there is nothing to say."""
        return ""

    def resolved(self, folder: Path) -> Self:
        """Return the same with everything read in that other files say; their paths count from the RIG.toml's folder.

        Raises
        ------
        InputError
            Such a file is missing or does not fit.
        """
        return self


class CameraSection(StrictModel):
    """A camera."""

    kind: str
    """The driver."""
    serial_number: str = ""
    """Serial number or inventory mark, for the session's records."""

    @property
    def instrument(self) -> str:
        """Name it in a session's records."""
        return f"camera of kind {self.kind}"
