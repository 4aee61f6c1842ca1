"""Materials whose colour varies over the surface: light and albedo apart (the Shape paper, section 6)."""

from litrig.base.errors import InputError
from processing.shape.model import Environments, ShadingBuffers

_SIDES = (("diffuse_is_illumination", "albedo"), ("reflection_is_illumination", "reflection_albedo"))


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
