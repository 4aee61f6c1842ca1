"""Components of several MatCaps in one (the MatCap paper, figure 13)."""

from dataclasses import replace

from processing.matcap.model import Component, DecomposedMatcap
from processing.matcap.recipe.operations import One, Take
from processing.matcap.remainder import with_maps
from processing.paraboloid.blur import resized


def take(matcap: DecomposedMatcap, step: Take, other: DecomposedMatcap) -> DecomposedMatcap:
    """Take one component from another MatCap, as it is turned there; the smaller maps grow to the larger ones' size."""
    low, high = (other.low, matcap.high) if step.component is One.LOW else (matcap.low, other.high)
    size = max(low.front.shape[0], high.front.shape[0])
    return replace(matcap, low=_of_size(low, size), high=_of_size(high, size))


def _of_size(component: Component, size: int) -> Component:
    if component.front.shape[0] == size:
        return component
    front, back = resized(component.front, component.back, size)
    return with_maps(component, front, back)
