"""Taking out texture: what the threads of a cloth, or stains, add to the material, evenly or not.

Every place of the sample passes under every light, so that in the sample's frame the mean over the turn holds hardly
anything of the highlights, and all of the albedo. What varies there faster than normals do is texture. The table keeps
it by default, for the paper does; averaged out it leaves the material alone.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from processing.amc.flaws.sample_frame import turn

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

_DARK_SHARE = 0.02
_BLUR, _FINEST_BLUR_PX = 1 / 24, 2.0
# Turning to and fro blurs the finest threads, and highlights are told from texture by the texture: so more than once.
_PASSES = 4
_KNEE = 1.5


def average_weave(slices: F32, angles_rad: F64, valid: Mask) -> F32:
    """Take out texture that turns rigidly with the sample.

    Parameters
    ----------
    slices : (N, S, S, 3) float32, linear light; fill marks first, for a cut is a texture too
    angles_rad : (N,) turntable angle of each slice
    valid : (S, S) bool, the disc that was seen

    Returns
    -------
    slices : (N, S, S, 3) float32, divided by the texture; what is not valid comes back as it was
    """
    turns_rad = angles_rad - angles_rad[0]
    texture = weave_texture(slices, turns_rad, valid)
    averaged = slices.copy()
    for slice_, turn_rad in zip(averaged, turns_rad, strict=True):
        slice_[valid] *= np.exp(-turn(texture, float(turn_rad), cv2.INTER_CUBIC)[valid])
    return averaged


def weave_texture(slices: F32, turns_rad: F64, valid: Mask) -> F32:
    """Find the texture: what each slice shows in finer detail than normals vary, averaged in the sample's frame.

    The average is Cauchy's M-estimate: a slice in which a highlight passes says little about the place below it.

    Parameters
    ----------
    slices : (N, S, S, 3) float32, linear light
    turns_rad : (N,) turntable angle of each slice less that of the first
    valid : (S, S) bool

    Returns
    -------
    texture : (S, S, 3) float32 in the frame of the first slice, natural logarithm of the factor; zero off the disc
    """
    dark = (_DARK_SHARE * np.median(slices[:: max(1, len(slices) // 32), valid], axis=(0, 1)) + 1e-6).astype(np.float32)
    detail = _Detail(valid)
    texture = np.zeros(slices.shape[1:], np.float32)
    knee = np.float32(np.inf)
    for _ in range(_PASSES):
        total, weight = np.zeros_like(texture), np.full(texture.shape, 1e-6, np.float32)
        sizes = []
        for slice_, turn_rad in zip(slices, turns_rad, strict=True):
            left = detail(np.log(np.maximum(slice_, 0) + dark))
            left -= turn(texture, float(turn_rad), cv2.INTER_CUBIC)
            sizes.append(np.median(np.abs(left[valid])))
            believed: F32 = np.float32(1) / (1 + (left / knee) ** 2)
            total += turn(left * believed, -float(turn_rad), cv2.INTER_CUBIC)
            weight += turn(believed, -float(turn_rad))
        texture += total / weight * valid[..., None]
        knee = np.float32(_KNEE * np.median(sizes) + 1e-6)
    # Of a factor that is 1 on average the logarithm is below 0 on average; details have none.
    return np.asarray((texture - np.log(np.exp(texture[valid]).mean(axis=0))) * valid[..., None], np.float32)


class _Detail:
    """Takes out of a picture what is smoother than texture: twice less its blur, so that cubic shading goes too."""

    def __init__(self, valid: Mask) -> None:
        self._sigma = max(_BLUR * len(valid), _FINEST_BLUR_PX)
        self._valid = valid.astype(np.float32)[..., None]
        self._share = np.maximum(self._blur(self._valid)[..., None], 1e-6)

    def __call__(self, picture: F32) -> F32:
        for _ in range(2):
            picture = np.asarray(picture - self._blur(picture * self._valid) / self._share, np.float32)
        return picture * self._valid

    def _blur(self, picture: F32) -> F32:
        blurred = cv2.GaussianBlur(picture, (0, 0), self._sigma, borderType=cv2.BORDER_CONSTANT)
        return np.asarray(blurred, np.float32)
