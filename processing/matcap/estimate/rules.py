"""Which window tells a feature's variance: where its signature settles (the MatCap paper, section 3.3 and figure 4)."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from processing.matcap.estimate.signatures import Signatures

F64 = NDArray[np.float64]
Rule = Literal["plateau", "paper"]

# A window narrower than this many standard deviations sees the top of a bump, which looks like anything.
_NARROWEST = 1.2
_TAPS = 5
# Neighbours as flat as this belong to the plateau; of a sloping one, those that slope twice as much.
_FLAT = 0.03
_LEAST_BEND = 0.0004


@dataclass(frozen=True)
class Settled:
    """Where P signatures settle.

    Attributes
    ----------
    variances : (P,) rad²; NaN where a signature never does (the paper's figure 4d)
    at : (P,) which window; −1 where none
    slopes : (P,) |d log variance/d log ε| there: how much the choice of the window matters
    """

    variances: F64
    at: NDArray[np.intp]
    slopes: F64


def settle(signatures: Signatures, rule: Rule) -> Settled:
    """Let each signature choose its window.

    Parameters
    ----------
    rule : "plateau": where variance changes least with ε, of windows wide enough to see both flanks. "paper": its four
        cases, for signatures by equation 6
    """
    one = _plateau if rule == "plateau" else _inflections
    count = len(signatures.variances)
    variances, at, slopes = np.full(count, np.nan), np.full(count, -1, np.intp), np.full(count, np.nan)
    for row in range(count):
        chosen = one(signatures.windows, signatures.variances[row], signatures.widths[row])
        if chosen is not None:
            variances[row], at[row], slopes[row] = chosen
    return Settled(variances, at, slopes)


def log_slopes(windows: F64, variances: F64) -> F64:
    """Return |d log variance/d log ε| (E,), smoothed over 5 windows; NaN at the ends and beside windows without one."""
    raw = np.gradient(np.log(variances), np.log(windows))
    smooth = np.full(raw.shape, np.nan)
    edge = _TAPS // 2
    smooth[edge:-edge] = np.convolve(raw, np.full(_TAPS, 1 / _TAPS), "valid")
    return np.abs(smooth)


def _plateau(windows: F64, variances: F64, widths: F64) -> tuple[float, int, float] | None:
    slopes = log_slopes(windows, variances)
    with np.errstate(invalid="ignore"):
        slopes[~(widths > _NARROWEST * np.sqrt(variances))] = np.nan
    if np.all(np.isnan(slopes)):
        return None
    at = int(np.nanargmin(slopes))
    flat = slopes < max(_FLAT, 2 * slopes[at])
    first = at - int(np.argmin(np.append(flat[at::-1], False))) + 1
    last = at + int(np.argmin(np.append(flat[at:], False)))
    # Over the whole plateau noise averages out; which of its windows is flattest is chance.
    return float(np.median(variances[first:last])), at, float(slopes[at])


def _inflections(windows: F64, variances: F64, _: F64) -> tuple[float, int, float] | None:
    usable = np.flatnonzero(np.isfinite(variances))
    if not usable.size:
        return None
    slopes = log_slopes(windows, variances)
    # The signature after its last degenerate window: before it the approximation does not hold.
    broken = np.flatnonzero(~np.isfinite(variances))
    first = 0 if not broken.size else int(broken[-1]) + 1
    if first > int(usable[-1]):
        return None
    tail = variances[first:]
    at = first + _settling(tail)
    return float(variances[at]), at, float(slopes[at])


def _settling(signature: F64) -> int:
    """Return the first minimum after the second inflection (case a), that inflection (b), or the widest window (c)."""
    if len(signature) < _TAPS + 2:
        return len(signature) - 1
    padded = np.pad(signature, _TAPS // 2, mode="edge")
    smooth = np.convolve(padded, np.full(_TAPS, 1 / _TAPS), "valid")
    bend = np.diff(smooth, 2)
    # Steps of 8 bits bend it everywhere, but little beside what it rises to.
    clear = np.flatnonzero(np.abs(bend) > _LEAST_BEND * np.median(smooth))
    turns = clear[1:][np.diff(np.sign(bend[clear])) != 0]
    if len(turns) < 2:
        return len(signature) - 1
    second = int(turns[1]) + 1
    rising = np.diff(smooth)
    minima = np.flatnonzero((rising[:-1] < 0) & (rising[1:] >= 0)) + 1
    later = minima[minima >= second]
    return int(later[0]) if later.size else second
