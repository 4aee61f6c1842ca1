"""Operations on the material of a decomposed MatCap (the MatCap paper, section 5.2)."""

import colorsys
from collections.abc import Callable
from dataclasses import replace

from processing.matcap.filter import slope_of
from processing.matcap.half_floats import rounded
from processing.matcap.model import Component, DecomposedMatcap
from processing.matcap.recipe.operations import Colour, Gain, Outline, Roughness, Which
from processing.matcap.silhouette import Silhouette
from processing.paraboloid.blur import blurred
from processing.paraboloid.sharpen import sharpened

_ALIKE = 1e-12


def roughen(matcap: DecomposedMatcap, step: Roughness) -> DecomposedMatcap:
    """Change the filter size ν: maps are blurred, or sharpened, by the difference; μ follows ν.

    Lights that were added stay sharp, for they are blurred when maps are made of them.
    """
    return _each(matcap, step.component, lambda component: with_filter_size(component, step.variance))


def with_filter_size(component: Component, filter_size: float) -> Component:
    """Return a component of another filter size ν.

    The slope changes as much as μ(ν) does; one that was not μ(ν) keeps its distance from it. What the maps lacked is
    not the same in others, and left out.
    """
    more = filter_size - component.filter_size
    if abs(more) < _ALIKE:
        return component
    change = blurred if more > 0 else sharpened
    front, back = (rounded(side) for side in change(component.front, component.back, abs(more)))
    slope = component.slope + slope_of(filter_size) - slope_of(component.filter_size)
    return replace(
        component,
        front=front,
        back=back,
        filter_size=filter_size,
        slope=min(max(slope, 0.0), 1.0),
        remainder=None,
    )


def recolour(matcap: DecomposedMatcap, step: Colour) -> DecomposedMatcap:
    """Change base colours; grey has no hue to turn."""

    def one(component: Component) -> Component:
        base = step.base_colour or component.base_colour
        if (step.hue_deg, step.saturation) != (0.0, 1.0):
            hue, saturation, value = colorsys.rgb_to_hsv(*base)
            base = colorsys.hsv_to_rgb((hue + step.hue_deg / 360) % 1, min(saturation * step.saturation, 1.0), value)
        red, green, blue = base
        return replace(component, base_colour=(red * step.value, green * step.value, blue * step.value))

    return _each(matcap, step.component, one)


def scale(matcap: DecomposedMatcap, step: Gain) -> DecomposedMatcap:
    """Scale each component's energy α(θ)."""

    def by(component: Component, factor: float) -> Component:
        red, green, blue = component.base_colour
        return replace(
            component,
            base_colour=(red * factor, green * factor, blue * factor),
            silhouette=component.silhouette.scaled(factor),
        )

    return replace(matcap, low=by(matcap.low, step.low), high=by(matcap.high, step.high))


def outline(matcap: DecomposedMatcap, step: Outline) -> DecomposedMatcap:
    """Give components a silhouette, in place of the one that they have."""
    silhouette = Silhouette(step.start_deg, step.rise, step.slope)
    return _each(matcap, step.component, lambda component: replace(component, silhouette=silhouette))


def _each(matcap: DecomposedMatcap, which: Which, change: Callable[[Component], Component]) -> DecomposedMatcap:
    return replace(
        matcap,
        low=matcap.low if which is Which.HIGH else change(matcap.low),
        high=matcap.high if which is Which.LOW else change(matcap.high),
    )
