"""How a texture is to be synthesised."""

from dataclasses import dataclass
from typing import Literal

from litrig.base.errors import InputError
from processing.ptm.synthesis.orthonormal import Domain

Join = Literal["cut", "blend"]
SearchKind = Literal["fft", "svd", "dct", "haar", "walsh", "brute"]
Copies = Literal["avoid", "allow"]

SMALLEST_BLOCK_PX, LARGEST_BLOCK_PX = 4, 256


@dataclass(frozen=True)
class Synthesis:
    """Choices of block-based synthesis.

    Attributes
    ----------
    block_px : side of a block, its overlap included
    overlap_px : rows and columns that a block shares with the ones beside it, at most half a block
    tolerance : τ; all blocks within (1 + τ) of the best may be chosen
    delta : RMS difference, where 1 is white; all blocks within it may be chosen, too
    join : "cut" along the path of least error through an overlap; "blend" with weights that rise across it
    tileable : the result goes on where it ends
    search : how blocks are found; all find the same
    domain : over what lights functions are compared; None for the usual of the basis
    chroma : weight of colour in LRGB materials, 0 to compare luminance alone
    copies : "avoid" never goes on with the source just where a neighbour left off
    guide_weight : weight of the guidance map against the texture
    seed : of the choice among good blocks; the same seed gives the same coefficients
    """

    block_px: int = 30
    overlap_px: int = 6
    tolerance: float = 0.1
    delta: float = 0.004
    join: Join = "cut"
    tileable: bool = False
    search: SearchKind = "fft"
    domain: Domain | None = None
    chroma: float = 1.0
    copies: Copies = "avoid"
    guide_weight: float = 1.0
    seed: int = 0

    def __post_init__(self) -> None:
        if not SMALLEST_BLOCK_PX <= self.block_px <= LARGEST_BLOCK_PX:
            raise InputError(
                f"a block of {self.block_px} pixels is not used; choose {SMALLEST_BLOCK_PX} to {LARGEST_BLOCK_PX}"
            )
        if not 1 <= self.overlap_px <= self.block_px // 2:
            raise InputError(
                f"blocks of {self.block_px} pixels cannot overlap by {self.overlap_px}; choose 1 to "
                f"{self.block_px // 2}"
            )
