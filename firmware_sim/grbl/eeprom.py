"""What survives resets and the loss of power: settings, coordinate systems, start-up lines, build info."""

from firmware_sim.grbl.settings import Settings, axis_count
from firmware_sim.motion import Vector

COORDINATE_SYSTEMS = ("G54", "G55", "G56", "G57", "G58", "G59")
STORED_PLACES = ("G28", "G30")


class Eeprom:
    """The memory of one controller, and how it was delivered."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self._delivered = dict(settings)
        self.startup_lines = ["", ""]
        self.build_info = ""
        self.places: dict[str, Vector] = {}
        self.restore_places()

    @property
    def zero(self) -> Vector:
        """All axes at zero."""
        return (0.0,) * axis_count(self.settings)

    def restore_settings(self) -> None:
        """Do what $RST=$ does."""
        self.settings.update(self._delivered)

    def restore_places(self) -> None:
        """Do what $RST=# does."""
        self.places = dict.fromkeys((*COORDINATE_SYSTEMS, *STORED_PLACES), self.zero)

    def restore_all(self) -> None:
        """Do what $RST=* does."""
        self.restore_settings()
        self.restore_places()
        self.startup_lines = ["", ""]
        self.build_info = ""
