"""Where the lamps hang, how bright each is, and which of them shine."""

import math

from firmware_sim.errors import SimError
from firmware_sim.scene.pose import LitLamp
from firmware_sim.udmx.config import DomeSim

GOLDEN_RATIO = (1 + math.sqrt(5)) / 2


class Dome:
    """The lamps behind the dimmers. Wires may be crossed and lamps dead."""

    def __init__(self, config: DomeSim) -> None:
        self._config = config
        self.directions_deg = tuple(direction_deg(config, lamp) for lamp in range(config.lamps))
        self.brightness = tuple(brightness(config, lamp) for lamp in range(config.lamps))
        self.wiring = list(range(config.lamps))
        self.dead = set(config.dead)
        if config.swapped:
            self.swap(*config.swapped)

    def swap(self, one: int, other: int) -> None:
        """Exchange the wires of two lamps."""
        self._check(one, other)
        self.wiring[one], self.wiring[other] = self.wiring[other], self.wiring[one]

    def kill(self, lamp: int) -> None:
        """Let a lamp shine no more."""
        self._check(lamp)
        self.dead.add(lamp)

    def mend(self) -> None:
        """Put every wire back, and replace dead lamps."""
        self.wiring = list(range(self._config.lamps))
        self.dead = set()

    def lit(self, slots: bytes) -> tuple[LitLamp, ...]:
        """Return the lamps that shine when the dimmers have these values."""
        shining = []
        for place, lamp in enumerate(self.wiring):
            share = self._share(slots, place)
            if share and lamp not in self.dead:
                shining.append(LitLamp(*self.directions_deg[lamp], share * self.brightness[lamp]))
        return tuple(shining)

    def _check(self, *lamps: int) -> None:
        if any(lamp >= self._config.lamps for lamp in lamps):
            raise SimError(f"there are lamps 0..{self._config.lamps - 1} only")

    def _share(self, slots: bytes, place: int) -> float:
        width = self._config.slots_a_lamp
        value = int.from_bytes(slots[place * width : (place + 1) * width], "big")
        return value / float(256**width - 1)


def direction_deg(config: DomeSim, lamp: int) -> tuple[float, float]:
    """Return azimuth and elevation of a lamp: equal areas, each turned by the golden ratio."""
    low, high = (math.sin(math.radians(e)) for e in (config.min_elevation_deg, config.max_elevation_deg))
    height = low + (high - low) * (lamp + 0.5) / config.lamps
    return round(lamp * 360 / GOLDEN_RATIO % 360, 3), round(math.degrees(math.asin(height)), 3)


def brightness(config: DomeSim, lamp: int) -> float:
    """Return the power of a lamp at full value: from 1 down by the unevenness, without order."""
    return 1 - config.unevenness * (lamp * 7 % config.lamps) / max(1, config.lamps - 1)
