"""Find the layers that buffers are made of, and make them."""

import functools
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from processing.shape.buffers.names import BUFFERS, DIALECTS, Recipe

F32 = NDArray[np.float32]
Planes = Mapping[str, NDArray[Any]]
_VECTORS = frozenset({"normal", "position"})
_NUMBERS = frozenset({"coverage", "depth", "surface_id", "ambient_occlusion", "reflection_occlusion"})
_SINGLE = ("", "Y", "Z", "V", "T", "I", "X", "R", "A")
"""What the one channel of a layer may be called, the likeliest first."""


@dataclass(frozen=True)
class Found:
    """Which layers a buffer is made of.

    Attributes
    ----------
    recipe : with the layers' whole names
    renderer : whose names these are; "--layer" if the user said so
    """

    recipe: Recipe
    renderer: str


class Layers:
    """The layers of a file, found by names without regard to capitals, blanks and what stands before the last dot."""

    def __init__(self, planes: Planes) -> None:
        self._planes = planes
        self._layers: dict[str, dict[str, str]] = {}
        for name in planes:
            layer, _, channel = name.rpartition(".")
            # A channel alone is a layer of its own, unless it is one of the picture's.
            if not layer and channel.upper() not in {"R", "G", "B", "A"}:
                layer, channel = channel, ""
            self._layers.setdefault(layer, {})[channel.upper()] = name

    @property
    def names(self) -> list[str]:
        return sorted(self._layers)

    def find(self, name: str, buffer: str) -> str | None:
        """Return the whole name of the layer that can be this buffer."""
        wanted = _plain(name)
        whole = [layer for layer in self._layers if _plain(layer) == wanted]
        ends = [layer for layer in self.names if wanted and _plain(layer.rpartition(".")[2]) == wanted]
        return next((layer for layer in whole + ends if self._channels(layer, buffer)), None)

    def resolve(self, recipe: Recipe, buffer: str) -> Recipe | None:
        """Replace names by whole names, or return None where a layer is missing."""
        terms = [self.find(name, buffer) for name in recipe.terms]
        also = [layer for name in recipe.also if (layer := self.find(name, buffer)) is not None]
        factor = None if recipe.factor is None else self.find(recipe.factor, buffer)
        if any(term is None for term in terms) or (recipe.factor is not None and factor is None):
            return None
        return Recipe(tuple(term for term in terms if term is not None), tuple(also), factor)

    def make(self, recipe: Recipe, buffer: str) -> F32:
        """Return the buffer, (H, W) or (H, W, 3) float32."""
        # From the first layer on, and not from 0, which would take the sign off −0.
        total = functools.reduce(np.add, (self._values(name, buffer) for name in (*recipe.terms, *recipe.also)))
        if recipe.factor is not None:
            total = total * self._values(recipe.factor, buffer)
        made: F32 = np.asarray(total, np.float32)
        return made

    def channels(self, layer: str, buffer: str) -> list[NDArray[Any]]:
        """Return the planes as they are stored."""
        return [self._planes[name] for name in self._channels(layer, buffer)]

    def channel_names(self, layer: str, buffer: str) -> list[str]:
        """Return the whole names of a layer's channels that make a buffer."""
        return self._channels(layer, buffer)

    def _values(self, layer: str, buffer: str) -> F32:
        planes = [plane.astype(np.float32) for plane in self.channels(layer, buffer)]
        if buffer in _NUMBERS:
            mean: F32 = np.mean(planes, axis=0, dtype=np.float32) if len(planes) > 1 else planes[0]
            return mean
        return np.stack(planes if len(planes) == 3 else planes * 3, axis=-1)

    def _channels(self, layer: str, buffer: str) -> list[str]:
        has = self._layers[layer]
        if buffer == "coverage":
            alone = [has[name] for name in ("A",) if name in has]
            return alone or ([] if layer in ("", "Combined") else _of(has, "RGB") or _single(has))
        if buffer in _VECTORS:
            return _of(has, "XYZ") or _of(has, "RGB")
        if buffer in _NUMBERS:
            return [] if not layer else _of(has, "RGB") or _single(has)
        return _of(has, "RGB") or ([] if not layer else [has["Y"]] if "Y" in has else [])


def find_buffers(layers: Layers, said: Mapping[str, Recipe]) -> dict[str, Found]:
    """Find each buffer's layers: as it was said, or by the first renderer's names that fit.

    Parameters
    ----------
    said : layers by buffer; those that are not there are left out

    Returns
    -------
    found : by buffer, in the order of `BUFFERS`
    """
    found = {}
    for buffer in BUFFERS:
        if buffer in said:
            if (recipe := layers.resolve(said[buffer], buffer)) is not None:
                found[buffer] = Found(recipe, "--layer")
            continue
        for renderer, names in DIALECTS.items():
            fits = (layers.resolve(recipe, buffer) for recipe in names.get(buffer, ()))
            if (first := next((recipe for recipe in fits if recipe is not None), None)) is not None:
                found[buffer] = Found(first, renderer)
                break
    return found


def _plain(name: str) -> str:
    return re.sub(r"[^0-9a-z]", "", name.lower())


def _of(has: Mapping[str, str], letters: str) -> list[str]:
    return [has[letter] for letter in letters] if all(letter in has for letter in letters) else []


def _single(has: Mapping[str, str]) -> list[str]:
    return next(([has[name]] for name in _SINGLE if name in has), [])
