"""Plans in one line: the usual session of each kind."""

from acquisition.plans.choose_lights import LightWish, choose_lights
from acquisition.plans.light_path import Order, Sector
from acquisition.plans.limits import FEWEST_LIGHTS, MOST_LIGHTS, check_range
from acquisition.plans.plan import Plan
from acquisition.plans.poses import AmcPoses, PtmPoses
from acquisition.plans.turn import Turn
from rig.config import RigConfig


def amc_plan(slices: int, *, closure: bool = False) -> Plan:
    """Plan one frame a slice over a whole turn from 0° on, and nothing else unless the closure is asked for.

    Raises
    ------
    InputError
        No table can be built from so few, or they are too many to shoot.
    """
    return Plan(AmcPoses(Turn(slices, closure=closure)))


def ptm_plan(
    lights: int, config: RigConfig | None = None, *, sector: Sector | None = None, order: Order = "tour"
) -> Plan:
    """Plan one frame a light: as many lamps of the rig's dome, or directions spread evenly for its arm.

    Parameters
    ----------
    config : the rig; without one, directions in an order whose ways are short by their angles
    sector : where the lights lie

    Raises
    ------
    InputError
        No PTM can be fitted to so few, or there are not so many lamps.
    """
    check_range("lights", lights, FEWEST_LIGHTS, MOST_LIGHTS, "40 to 80 are usual")
    return Plan(PtmPoses(choose_lights(LightWish(lights, sector=sector, order=order), config)))
