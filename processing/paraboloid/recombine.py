"""Making one step of the last few that is better than each (Washio, Oosterlee: Krylov subspace acceleration, 1997).

Multigrid is slow where few shapes of error stay from cycle to cycle, as around a known texel that stands alone. The
combination of steps that leaves the least of the equations takes such shapes away.
"""

import numpy as np

from processing.paraboloid.seam import F64

_MOST = 4


class Recombination:
    """The last steps, and what was missing in the equations after each."""

    def __init__(self) -> None:
        self._steps: list[tuple[F64, F64]] = []

    def improve(self, values: F64, missing: F64) -> None:
        """Combine the newest step with those before, in place; of known texels all have the same values."""
        apart = [(v - values, m - missing) for v, m in self._steps]
        products = np.array([[np.vdot(one, other) for _, other in apart] for _, one in apart])
        if apart:
            towards = np.array([-np.vdot(one, missing) for _, one in apart])
            for share, (step, change) in zip(np.linalg.lstsq(products, towards, rcond=1e-12)[0], apart, strict=True):
                values += share * step
                missing += share * change
        self._steps = [*self._steps[1 - _MOST :], (values.copy(), missing.copy())]
