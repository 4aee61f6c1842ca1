"""A material whose colour and luminance are multiplied out, for files that hold a polynomial a channel and no other."""

from dataclasses import dataclass

from processing.ptm.basis import Basis
from processing.ptm.model import Colour, Material, Space, Strip


@dataclass(frozen=True)
class MultipliedOut:
    """A `Material` of kind rgb that gives what `material` gives."""

    material: Material

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width."""
        return self.material.shape

    @property
    def kind(self) -> Colour:
        """A set of coefficients a channel."""
        return "rgb"

    @property
    def space(self) -> Space:
        """Which values were fitted."""
        return self.material.space

    @property
    def source(self) -> str:
        """Digest of the frames."""
        return self.material.source

    @property
    def basis(self) -> Basis:
        """What the coefficients belong to."""
        return self.material.basis

    def strip(self, rows: slice) -> Strip:
        """Return some rows."""
        return _multiplied(self.material.strip(rows))

    def sample(self, count: int) -> Strip:
        """Return about so many pixels from all over, as one row."""
        return _multiplied(self.material.sample(count))


def _multiplied(strip: Strip) -> Strip:
    return strip if strip.colour is None else Strip(strip.coefficients * strip.colour, None)
