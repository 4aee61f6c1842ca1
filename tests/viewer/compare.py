"""How far a drawn picture is from its truth."""

import numpy as np
from numpy.typing import NDArray

from processing.reference.display import display_codes

Picture = NDArray[np.floating]


def codes_apart(drawn: Picture, truth: Picture, where: NDArray[np.bool_] | None = None) -> float:
    """Return the 99.9th percentile of the difference in display codes of 255 over what both or either cover.

    Parameters
    ----------
    where : (H, W) pixels to look at; None looks at all
    """
    first, second = display_codes(drawn).astype(int), display_codes(truth).astype(int)
    covered = (first[..., 3] > 0) | (second[..., 3] > 0)
    if where is not None:
        covered &= where
    assert covered.sum() > 1500, "there is something to compare"
    assert second[covered][:, :3].std() > 15, "a picture that shows the material"
    return float(np.quantile(np.abs(first - second).max(axis=-1)[covered], 0.999))


def differ(first: Picture, second: Picture) -> int:
    """Return the largest difference in display codes."""
    return int(np.abs(display_codes(first).astype(int) - display_codes(second).astype(int)).max())
