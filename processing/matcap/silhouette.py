"""What a material gains towards the silhouette (the MatCap paper, figure 2 and section 5.2)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]


@dataclass(frozen=True)
class Silhouette:
    """A Hermite cubic over the angle θ off the view axis, the same for all channels; it is added to the base colour.

    It leaves 0 at θ₀ with slope 0 and arrives at α₁ with slope m₁ at the silhouette. The default adds nothing.

    Attributes
    ----------
    start_deg : θ₀, 0 to below 90
    rise : α₁, what is added where θ is 90 degrees; a negative one takes away
    slope : m₁, a radian
    """

    start_deg: float = 0.0
    rise: float = 0.0
    slope: float = 0.0

    def added(self, theta: F64) -> F64:
        """Return s(θ) for angles in radians; beyond the silhouette it stays."""
        start = np.radians(self.start_deg)
        span = np.pi / 2 - start
        t = np.clip((theta - start) / span, 0, 1)
        added: F64 = self.rise * t * t * (3 - 2 * t) + self.slope * span * t * t * (t - 1)
        return added

    def scaled(self, factor: float) -> "Silhouette":
        return Silhouette(self.start_deg, self.rise * factor, self.slope * factor)


PLAIN = Silhouette()
