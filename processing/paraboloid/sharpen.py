"""The blur of a material taken back: what a shinier one would show.

Light is deconvolved (Richardson and Lucy), which keeps it positive and keeps its sum, and the result is taken only
where the light varies by more than its noise. Flat places stay as they are, so that their noise does not grow.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.paraboloid.blur import blurred, resized

F32 = NDArray[np.float32]
Pair = tuple[F32, F32]

ROUNDS = 10
_TEXELS = 4.0
"""A standard deviation of the blur that is taken back has at least so many texels, where a map has that many."""
_TEXEL_RAD = 4.0
"""What a texel in the middle of a map is wide, times the map's side."""
_NOISE_TEXELS = 1.0
_CERTAIN = 6.0
"""Light is believed to vary where its variance is more than so many times its noise's."""
_MEDIAN_OF_SQUARES = 0.4549
"""The median of the square of a normal variable."""


def sharpened(front: F32, back: F32, variance: float, rounds: int = ROUNDS) -> Pair:
    """Take back a blur of a dual paraboloid map (S, S, 3) each, as far as its noise lets.

    Parameters
    ----------
    variance : that is taken away, radians squared, along any great circle
    rounds : of deconvolution; more are sharper

    Returns
    -------
    front, back : (S, S, 3) float32, not negative; as they came where the blur is narrower than a texel

    Raises
    ------
    InputError
        The variance is negative or no number.
    """
    if variance == 0:
        return front, back
    if not 0 < variance < np.inf:
        raise InputError(f"sharpen: a variance of {variance:g} is none; give 0 or more, in radians squared")
    if np.sqrt(variance) < _TEXEL_RAD / front.shape[0]:
        return front, back
    given = np.stack([front, back]).astype(np.float32)
    # What was blurred so much needs no more texels than this.
    size = front.shape[0]
    while size % 2 == 0 and size // 2 >= _TEXELS * _TEXEL_RAD / np.sqrt(variance):
        size //= 2
    change = _change(np.stack(resized(given[0], given[1], size)), variance, rounds)
    result = np.maximum(given + np.stack(resized(change[0], change[1], front.shape[0])), np.minimum(given, 0))
    return result[0], result[1]


def _change(given: F32, variance: float, rounds: int) -> F32:
    """Return what is to be added to light (2, S, S, 3)."""
    light = np.maximum(given, 0)
    least = max(float(light.max()), 1e-20) * 1e-6
    estimate = np.asarray(light + least, np.float32)
    for _ in range(rounds):
        ratio = np.asarray((light + least) / np.maximum(_blur(estimate, variance), least), np.float32)
        estimate *= np.maximum(_blur(ratio, variance), 0)
    return np.asarray(_certainty(light, variance) * (np.maximum(estimate - least, 0) - given), np.float32)


def _certainty(light: F32, variance: float) -> F32:
    """Say how sure it is that light (2, S, S, 3) varies by itself around each texel: (2, S, S, 1) from 0 to 1."""
    noise = _noise(light)
    around = _blur(light, variance)
    spread = (_blur(light * light, variance) - around * around).sum(axis=-1, keepdims=True)
    tiny = np.float32(1e-12) * max(float(light.max()) ** 2, 1e-20)
    sure = np.clip(1 - (_CERTAIN * noise + tiny) / np.maximum(spread, tiny), 0, 1)
    return np.asarray(sure, np.float32)


def _noise(light: F32) -> float:
    """Estimate the variance of noise, all channels together, from what a blur of about a texel takes away.

    The median over the sphere is of places without edges, as long as those are most.
    """
    size = light.shape[1]
    along = (2 * np.arange(size) + 1) / size - 1
    within = np.hypot(along[:, None], along[None, :]) < 1
    rest = [
        side - cv2.GaussianBlur(side, (0, 0), _NOISE_TEXELS, borderType=cv2.BORDER_REPLICATE)
        for side in (light[0], light[1])
    ]
    squares = np.concatenate([side[within] for side in rest]) ** 2
    # A Gaussian of one texel leaves this share of white noise: 1 − 2·k₀ + Σk².
    left = 1 - 2 / (2 * np.pi * _NOISE_TEXELS**2) + 1 / (4 * np.pi * _NOISE_TEXELS**2)
    return float(np.sum(np.median(squares, axis=0)) / _MEDIAN_OF_SQUARES / left)


def _blur(pair: F32, variance: float) -> F32:
    return np.stack(blurred(pair[0], pair[1], variance))
