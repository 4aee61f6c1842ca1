"""Materials as textures of vectors that can be compared: what is synthesised is these, and turned back at the end."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.ptm.model import Ptm
from processing.ptm.synthesis.orthonormal import Domain, Orthonormal, orthonormal

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]


@dataclass(frozen=True)
class Textures:
    """Several materials in one orthonormal basis, centred and scaled, so that float32 computes with numbers about 1.

    Attributes
    ----------
    planes : one (H, W, P) a material. The first `compared` planes are the vectors whose distance counts: b of the
        luminance, or of R, G and B one after the other; then the colour of an LRGB material
    compared : how many planes are compared; the colour only where it has weight
    distance_unit : squared distance of two pixels whose values differ by 1, from black to white, under all lights
    """

    planes: tuple[F32, ...]
    compared: int
    distance_unit: float
    _change: Orthonormal
    _means: F32
    _scales: F32
    _like: Ptm

    def pixels(self, planes: F32) -> tuple[F32, F32]:
        """Turn planes (N, P) back into coefficients (T, N, C) and colours (N, 3); (N, 0) of an RGB material."""
        values = planes * self._scales + self._means
        terms, channels = self._like.basis.terms, self._like.coefficients.shape[3]
        vectors = values[:, : terms * channels].reshape(-1, channels, terms)
        return self._change.back(np.moveaxis(vectors, 2, 0)), values[:, terms * channels :]


def to_textures(materials: Sequence[Ptm], names: Sequence[str], domain: Domain, chroma: float) -> Textures:
    """Bring materials into one space.

    Parameters
    ----------
    names : of the materials in errors
    chroma : weight of the colour of LRGB materials in comparisons. With 1 a difference of colours costs about what it
        costs in the pictures; the paper has 0, luminance alone

    Raises
    ------
    InputError
        A material has coefficients that are not finite numbers, or is of another kind than the first.
    """
    first = materials[0]
    for material, name in zip(materials, names, strict=True):
        _check_alike(material, name, first, names[0])
        _check_finite(material, name)
    change = orthonormal(first.basis, domain)
    planes = [_planes(material, change) for material in materials]
    count = sum(part.shape[0] * part.shape[1] for part in planes)
    means = sum(part.sum(axis=(0, 1), dtype=np.float64) for part in planes) / count
    centred = tuple(part - means.astype(np.float32) for part in planes)
    squares = sum(np.einsum("ijk,ijk->k", part, part, dtype=np.float64) for part in centred) / count
    vectors = first.basis.terms * first.coefficients.shape[3]
    scale = float(np.sqrt(squares[:vectors].mean())) or 1.0
    scales = np.full(len(means), scale)
    compared = vectors
    if first.colour is not None:
        energies = squares + np.square(means)
        # |L₁c₁ − L₂c₂|² is |L|²·|c₁ − c₂|² where luminances are the same, and |c|²·|L₁ − L₂|² where colours are.
        lightness = float(np.sqrt(energies[:vectors].sum() / (energies[vectors:].sum() or 1.0))) or 1.0
        scales[vectors:] = scale / (lightness * (chroma or 1.0))
        compared += 3 if chroma else 0
    for part in centred:
        part /= scales.astype(np.float32)
    unit = change.measure * first.coefficients.shape[3] / scale**2
    return Textures(centred, compared, unit, change, means.astype(np.float32), scales.astype(np.float32), first)


def emptied(material: Ptm, hole: NDArray[np.bool_]) -> Ptm:
    """Put the mean of the rest into the hole, where it disturbs no centring."""
    coefficients = material.coefficients.copy()
    rest = coefficients[:, ~hole]
    coefficients[:, hole] = rest.mean(axis=1)[:, None] if rest.size else 0
    colour = None
    if material.colour is not None:
        colour = material.colour.copy()
        colour[hole] = colour[~hole].mean(axis=0) if rest.size else 0
    return replace(material, coefficients=coefficients, colour=colour)


def _planes(material: Ptm, change: Orthonormal) -> F32:
    vectors = change.forward(material.coefficients)
    terms, height, width, channels = vectors.shape
    planes = np.moveaxis(vectors, 0, 3).reshape(height, width, channels * terms)
    return np.concatenate([planes] if material.colour is None else [planes, material.colour], axis=-1)


def _check_alike(material: Ptm, name: str, first: Ptm, first_name: str) -> None:
    for what, mine, others in (
        ("basis", material.basis, first.basis),
        ("colour", material.kind, first.kind),
        ("values", material.space, first.space),
    ):
        if mine != others:
            raise InputError(
                f"{name}: its {what} is {mine} where {first_name} has {others}; fit both alike to mix them"
            )


def _check_finite(material: Ptm, name: str) -> None:
    # A sum is finite only where all of its terms are.
    total = float(np.sum(material.coefficients, dtype=np.float64))
    if material.colour is not None:
        total += float(np.sum(material.colour, dtype=np.float64))
    if not np.isfinite(total):
        raise InputError(f"{name}: has coefficients that are not finite numbers; fit it again")
