"""Whether strategies choose the blocks that brute force chooses, over a whole synthesis."""

from dataclasses import replace
from itertools import product
from typing import NamedTuple

from processing.ptm.model import Colour
from processing.ptm.synthesis.settings import Join, SearchKind, Synthesis
from processing.ptm.synthesis.synthesize import synthesize
from tests.processing.ptm.synthesis.textures import rough

BLOCK_PX, OVERLAP_PX = 16, 4
SIZE = (48, 48)


class Case(NamedTuple):
    side_px: int
    colour: Colour
    join: Join
    tileable: bool

    def __str__(self) -> str:
        return f"{self.side_px}², {self.colour.upper()}, {self.join}{', tile' if self.tileable else ''}"


COLOURS: tuple[Colour, ...] = ("lrgb", "rgb")
JOINS: tuple[Join, ...] = ("cut", "blend")
CASES = [Case(*each) for each in product((64, 128), COLOURS, JOINS, (False, True))]


class Agreement(NamedTuple):
    """How many blocks were placed, and by how many a strategy's differ."""

    blocks: int
    different: int


def agreement(case: Case, searches: tuple[SearchKind, ...], seed: int) -> dict[SearchKind, Agreement]:
    material = rough(case.side_px, case.colour, seed)
    settings = Synthesis(BLOCK_PX, OVERLAP_PX, join=case.join, tileable=case.tileable, seed=seed, search="brute")
    truth = synthesize([material], SIZE, settings).canvas.taken
    found = {}
    for search in searches:
        taken = synthesize([material], SIZE, replace(settings, search=search)).canvas.taken
        different = sum(mine != theirs for mine, theirs in zip(taken, truth, strict=True))
        found[search] = Agreement(len(truth), different)
    return found
