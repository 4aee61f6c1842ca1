"""Materials whose colour varies over the surface: light and albedo apart (the Shape paper, section 6)."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.shape.model import Environments, ShadingBuffers

F32 = NDArray[np.float32]
Mask = NDArray[np.bool_]
DARKEST = 1e-3
"""Of the largest albedo in a channel: what is darker tells nothing of the light."""
_SIDES = (("diffuse_is_illumination", "albedo"), ("reflection_is_illumination", "reflection_albedo"))


def illumination(shading: F32, albedo: F32, used: Mask) -> tuple[F32, Mask]:
    """Divide shading by albedo.

    A channel that is dark all over the surface stays as it is: whatever its light, the albedo takes it away again.

    Parameters
    ----------
    shading, albedo : (H, W, 3)
    used : (H, W)

    Returns
    -------
    light : (H, W, 3), 0 where not told
    told : (H, W) the used pixels whose albedo is dark in no other channel
    """
    here = albedo[used]
    largest = here.max(axis=0, initial=0)
    dark_everywhere = largest <= 0
    bright = (albedo > DARKEST * largest) | dark_everywhere
    told = used & bright.all(axis=-1)
    divisor = np.where(told[..., None] & ~dark_everywhere, albedo, 1)
    light: F32 = np.where(told[..., None], shading / divisor, 0).astype(np.float32)
    return light, told


def check_reflectance(buffers: ShadingBuffers, environments: Environments) -> None:
    """See that there is an albedo where an environment holds light that is yet to be multiplied by it.

    Raises
    ------
    InputError
        There is none.
    """
    for flag, name in _SIDES:
        numbers = [number for number, one in environments.items() if getattr(one, flag)]
        if numbers and getattr(buffers, name) is None:
            raise InputError(
                f"environments: of surface {numbers[0]} hold light before its {name.replace('_', ' ')}, which the "
                f"buffers lack; render it too, or say its layer: --layer {name}=…"
            )
