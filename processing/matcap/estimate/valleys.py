"""Where one feature of a profile ends and the next begins."""

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
Index = NDArray[np.intp]

# A profile has left a feature when it has risen again by this share of the feature's height.
_RISE_SHARE = 0.05


def between_valleys(profiles: F64, modes: Index) -> tuple[Index, Index]:
    """Find the valleys to the left and right of a mode.

    Parameters
    ----------
    profiles : (P, T) not negative
    modes : (P,) the sample at which each has the mode that is meant

    Returns
    -------
    left, right : (P,) samples of the lowest values before a profile rises again; its ends where it does not
    """
    count = profiles.shape[1]
    left = count - 1 - _valley(profiles[:, ::-1], count - 1 - modes)
    return left, _valley(profiles, modes)


def _valley(profiles: F64, modes: Index) -> Index:
    rows, columns = np.arange(len(profiles)), np.arange(profiles.shape[1])
    heights = profiles[rows, modes]
    beyond = np.where(columns >= modes[:, None], profiles, np.inf)
    lowest = np.minimum.accumulate(beyond, axis=1)
    risen = (columns > modes[:, None]) & (beyond > lowest + _RISE_SHARE * heights[:, None])
    end = np.where(risen.any(axis=1), risen.argmax(axis=1), profiles.shape[1])
    before = np.where(columns < end[:, None], beyond, np.inf)
    # The last of the lowest, for what lies between equal ones belongs to the feature as much as not.
    valley: Index = profiles.shape[1] - 1 - np.argmin(before[:, ::-1], axis=1)
    return np.where(risen.any(axis=1), valley, profiles.shape[1] - 1)
