"""Somebody at a terminal, with the clock in hand."""

from firmware_sim.grbl.controller import GrblController
from firmware_sim.grbl.dialect import GRBL, Dialect
from firmware_sim.grbl.settings import light_arm_settings
from tests.firmware_sim.timing import HandClock

BANNER = "\r\nGrbl 1.1h ['$' for help]\r\n"
UNLOCK = "[MSG:'$H'|'$X' to unlock]\r\n"
TRUE_START = (-100.0, -30.0, -5.0)


class Host:
    """Types to the controller; `homed` also powers up and homes."""

    def __init__(
        self,
        true_start: tuple[float, ...] = TRUE_START,
        dialect: Dialect = GRBL,
        travel: tuple[float, ...] = (360, 90, 10),
    ) -> None:
        self.clock = HandClock()
        self.arm = GrblController(self.clock, light_arm_settings(travel), true_start, dialect)

    @classmethod
    def homed(cls, dialect: Dialect = GRBL) -> "Host":
        host = cls(dialect=dialect)
        host.hear()
        host.type("$H\n")
        host.wait(60)
        return host

    def type(self, text: str | bytes) -> str:
        return self.arm.feed(text.encode("latin-1") if isinstance(text, str) else text).decode()

    def hear(self) -> str:
        return self.type("")

    def wait(self, seconds: float) -> str:
        self.clock.pass_s(seconds)
        return self.hear()

    def state(self) -> str:
        return self.fields()[0]

    def fields(self) -> list[str]:
        return self.type("?").strip().strip("<>").split("|")

    def place(self) -> tuple[float, ...]:
        return tuple(float(value) for value in self.fields()[1].removeprefix("MPos:").split(","))

    def true_place(self) -> tuple[float, ...]:
        return self.arm.position(self.clock.now_s)
