"""Faults of lamps on a uDMX: whatever happens on the bus, exactly the lamp that was asked for is lit."""

import random
from collections.abc import Callable

from firmware_sim.config import SimConfig
from firmware_sim.launch import RunningSim, simulated_rig
from rig.config import read_rig
from rig.errors import RigError
from rig.rig import open_rig
from rig.udmx.config import UdmxConfig
from rig.udmx.lights import levels
from tests.faults.outcome import Outcome, Scale

LAMPS = 24
AWAY_S = 0.01
SEED = 7
Mishap = Callable[[RunningSim, random.Random], object]


def fault_24_lamps_through_drop_outs(campaign: Scale) -> Outcome:
    """The controller leaves the bus in the middle of a transfer, its lamps dark or half lit, and comes back."""

    def befall(sim: RunningSim, chance: random.Random) -> object:
        forgets, after = chance.random() < 0.5, chance.randrange(3)
        return sim.side_channel.request("lights.drop_out", seconds=AWAY_S, after=after, forgets=forgets)

    return _light_lamps_at_random(campaign, befall, most_unlit=0)


def fault_24_lamps_through_stalls(campaign: Scale) -> Outcome:
    """The controller stalls one or two transfers."""

    def befall(sim: RunningSim, chance: random.Random) -> object:
        return sim.side_channel.request("lights.stall", transfers=chance.randint(1, 2), after=chance.randrange(3))

    return _light_lamps_at_random(campaign, befall, most_unlit=0)


def fault_24_lamps_refused(campaign: Scale) -> Outcome:
    """The controller answers with an error byte: the driver says so, and the next attempt lights the right lamp."""

    def befall(sim: RunningSim, chance: random.Random) -> object:
        return sim.side_channel.request("lights.refuse", code=chance.randint(1, 2), after=chance.randrange(3))

    return _light_lamps_at_random(campaign, befall, most_unlit=campaign.trials)


def _light_lamps_at_random(campaign: Scale, befall: Mishap, most_unlit: int) -> Outcome:
    """Light lamps while things happen; wrong is a lamp that the driver calls lit, and that is not or not alone."""
    chance = random.Random(SEED)
    wrong = unlit = 0
    config = SimConfig.model_validate({"scene": {"kind": "relief"}, "dome": {"lamps": LAMPS}})
    with simulated_rig(config) as sim, open_rig(read_rig(sim.rig_toml), use=frozenset({"lights"})) as rig:
        lights = rig.config.lights
        assert isinstance(lights, UdmxConfig)
        for _ in range(campaign.trials):
            lamp = chance.randrange(LAMPS)
            befall(sim, chance)
            try:
                rig.lights.switch_on(lamp)
            except RigError:
                unlit += 1
                rig.lights.switch_on(lamp)
            wrong += _slots(sim) != bytes(levels(lights, lamp)[slot] for slot in range(LAMPS))
    detail = f"{unlit} times the driver gave up with an error, and the next attempt lit the lamp"
    return Outcome(campaign.trials, wrong, detail, passed=wrong == 0 and unlit <= most_unlit)


def _slots(sim: RunningSim) -> bytes:
    return bytes.fromhex(sim.side_channel.status()["usb"][0]["slots"])[:LAMPS]
