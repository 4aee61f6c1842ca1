"""From what a person wishes of the lights to a path over what the rig has."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from acquisition.plans.light_path import (
    EVERYWHERE,
    USEFUL,
    LightPath,
    Order,
    Sector,
    evenly,
    far_apart,
    in_tour,
    lamps_of,
    on_rings,
    onto_lamps,
    towards,
)
from acquisition.plans.step import Aim
from litrig.base.errors import InputError
from litrig.base.light_files import read_lights
from rig.config import ArmConfig, RigConfig


@dataclass(frozen=True)
class LightWish:
    """Which lights a person wants: a number of them, rings, or a file's.

    Attributes
    ----------
    count : how many: spread evenly, or of a dome or a file those that lie far apart; None for all there are
    rings : elevation in degrees and number of lights of each
    file : an `.lp` or `.dome`
    sector : lights beyond it are left out; None for everywhere, or where lights are spread evenly for `USEFUL`
    order : of shooting: a tour that keeps the arm's way short, or as they come; a dome's lamps are lit as they come
    """

    count: int | None = None
    rings: tuple[tuple[float, int], ...] = ()
    file: Path | None = None
    sector: Sector | None = None
    order: Order = "tour"

    def __post_init__(self) -> None:
        """Refuse wishes that contradict each other."""
        if self.rings and (self.file is not None or self.count is not None):
            raise InputError("rings: say how many lights there are and where; leave out count and file")


def choose_lights(wish: LightWish, config: RigConfig | None) -> LightPath:
    """Find the lights and their order.

    Parameters
    ----------
    config : the rig, whose dome's lamps are taken and whose arm's travel time counts; None if it is not known

    Raises
    ------
    InputError, FormatError
        The file is missing or damaged, nothing lies in the sector, or the dome has no such lamps.
    """
    dome = () if config is None or config.lights is None else config.lights.directions_deg
    aims, made_from = _find(wish, dome)
    if not dome and wish.order == "tour":
        aims = in_tour(aims, _arm_of(config))
    if dome:
        made_from = {**made_from, "lamps": [aim.lamp for aim in aims]}
    return LightPath(tuple(aims), {**made_from, "order": "given" if dome else wish.order})


def _find(wish: LightWish, dome: Sequence[tuple[float, float]]) -> tuple[list[Aim], Mapping[str, Any]]:
    """Return the lights, not in order yet, and where they come from."""
    sector = wish.sector or (EVERYWHERE if dome or wish.file else USEFUL)
    if wish.rings:
        aims = on_rings(wish.rings, sector.azimuth_deg)
        rings = [{"elevation_deg": elevation_deg, "count": count} for elevation_deg, count in wish.rings]
        made_from = {"source": "rings", "rings": rings, "azimuth_deg": list(sector.azimuth_deg)}
        return onto_lamps(aims, dome) if dome else aims, made_from
    if wish.file is not None:
        listed = towards(read_lights(wish.file).directions)
        aims = onto_lamps(listed, dome) if dome else listed
        return _pick(aims, wish, sector), {"source": "file", "file": wish.file.name, **sector.parameters()}
    if dome:
        return _pick(lamps_of(dome), wish, sector), {"source": "dome", **sector.parameters()}
    if wish.count is None:
        raise InputError(
            "count: is missing, for the rig has no dome whose lamps could all be taken; say how many lights"
        )
    return evenly(wish.count, sector), {"source": "even", **sector.parameters()}


def _pick(aims: Sequence[Aim], wish: LightWish, sector: Sector) -> list[Aim]:
    within = [aim for aim in aims if sector.holds(aim)]
    if not within:
        raise InputError(
            f"lights: widen the sector; none of {len(aims)} lies within the elevations {sector.min_elevation_deg:g}.."
            f"{sector.max_elevation_deg:g}° and azimuths {sector.azimuth_deg[0]:g}..{sector.azimuth_deg[1]:g}°"
        )
    return within if wish.count is None else far_apart(within, wish.count)


def _arm_of(config: RigConfig | None) -> ArmConfig | None:
    """Return the rig's arm if its travel can be predicted."""
    return config.arm if config is not None and isinstance(config.arm, ArmConfig) else None
