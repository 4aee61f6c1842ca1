"""Lamps on a uDMX, one lit at a time."""

from collections.abc import Mapping

from rig.clock import Clock
from rig.errors import OutOfRangeError
from rig.udmx.codec import slot_values
from rig.udmx.config import UdmxConfig
from rig.udmx.guard import Guard
from rig.udmx.link import UdmxLink


class UdmxLights:
    """Fits `rig.devices.Lights`."""

    def __init__(self, link: UdmxLink, config: UdmxConfig, clock: Clock, guard: Guard) -> None:
        self._link, self._config, self._clock, self._guard = link, config, clock, guard
        self._lit: int | None = None

    def check(self, lamp: int) -> None:
        """Refuse a lamp that RIG.toml does not name."""
        count = len(self._config.lamp)
        if lamp not in range(count):
            raise OutOfRangeError(f"lights: lamp {lamp} does not exist; this rig has lamps 0..{count - 1}")

    def switch_on(self, lamp: int = 0) -> None:
        """Light one lamp and darken all others; wait until it is warm."""
        self.check(lamp)
        was_lit, self._lit = self._lit, None
        self._link.show(levels(self._config, lamp))
        if lamp != was_lit:
            self._clock.sleep(self._config.warm_up_s)
        self._lit = lamp

    def switch_off(self) -> None:
        """Darken all."""
        self._lit = None
        self._link.show(levels(self._config, None))

    def close(self) -> None:
        """Give the controller back, the lamps as they are."""
        self._link.close()
        self._guard.release()


def levels(config: UdmxConfig, lit: int | None) -> Mapping[int, int]:
    """Return each slot's value when one lamp is lit, or none."""
    wanted = {slot: 0 for number in range(len(config.lamp)) for slot in config.slots(number)}
    if lit is not None:
        values = [
            value for gain in config.lamp[lit].gains for value in slot_values(gain, sixteen_bit=config.sixteen_bit)
        ]
        wanted |= zip(config.slots(lit), values, strict=True)
    return wanted
