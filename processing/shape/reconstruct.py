"""From shading buffers to the environments of their surfaces (the Shape paper, section 3)."""

from collections.abc import Collection
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.progress import Progress, Report, silent
from processing.shape.albedo import illumination
from processing.shape.diffuse.fit import DiffuseOptions, fit_diffuse
from processing.shape.diffuse.hot_pixels import hot_pixels
from processing.shape.extended.environments import Light, with_regions
from processing.shape.model import Environments, ShadingBuffers, SurfaceEnvironment
from processing.shape.reflection.environment import ReflectionEnvironment, ReflectionOptions, reconstruct_reflection

F32 = NDArray[np.float32]
Mask = NDArray[np.bool_]
_UNIT = 1e-2
MOST_REGIONS = 64


@dataclass(frozen=True)
class ReconstructOptions:
    """How to reconstruct environments.

    Attributes
    ----------
    hot_pixels : pixels whose diffuse shading is brighter than so many times all around them but two are left out of
        it; None leaves none out
    regions : parts of each surface with light of their own, for surfaces so extended that it is not the same everywhere
    """

    diffuse: DiffuseOptions = field(default_factory=DiffuseOptions)
    reflection: ReflectionOptions = field(default_factory=ReflectionOptions)
    hot_pixels: float | None = None
    regions: int = 1

    def __post_init__(self) -> None:
        """Refuse what means nothing."""
        if self.hot_pixels is not None and not 1 < self.hot_pixels < np.inf:
            raise InputError(f"hot pixels: {self.hot_pixels:g} times all around means nothing; give more than 1")
        if not 1 <= self.regions <= MOST_REGIONS:
            raise InputError(f"regions: {self.regions} of a surface mean nothing; give 1 to {MOST_REGIONS}")


@dataclass(frozen=True)
class Reconstruction:
    """Environments, and what is to be known about each.

    Attributes
    ----------
    known : by surface, (2, S, S), what it shows of its reflection environment within the unit circle; front and back
    coverage : by surface, the share of all directions that this is
    remarks : in the order of the surfaces
    """

    environments: Environments
    known: dict[int, Mask]
    coverage: dict[int, float]
    remarks: tuple[str, ...]


def reconstruct(
    buffers: ShadingBuffers,
    surfaces: Collection[int] | None = None,
    options: ReconstructOptions | None = None,
    report: Report = silent,
) -> Reconstruction:
    """Reconstruct the diffuse and the reflection environment of surfaces.

    Where buffers have an albedo, it is the light before it that is reconstructed.

    Parameters
    ----------
    surfaces : numbers of surfaces; None takes all that are seen

    Raises
    ------
    InputError
        A surface is not seen, or none of its pixels can be used.
    """
    options = options or ReconstructOptions()
    seen = buffers.seen
    if surfaces is None and not seen:
        raise InputError("shading buffers: show no surface, only background; give a picture of something")
    wanted = seen if surfaces is None else sorted(set(surfaces))
    for number in wanted:
        if number not in seen:
            found = ", ".join(str(one) for one in seen) or "none"
            raise InputError(f"surface {number}: is not seen; choose among {found}")
    environments: dict[int, SurfaceEnvironment] = {}
    known: dict[int, Mask] = {}
    coverage: dict[int, float] = {}
    remarks: list[str] = []
    for done, number in enumerate(wanted):
        window = _window(buffers.surfaces == number)
        environments[number], rebuilt, said = _surface(_cut(buffers, window), number, options)
        known[number], coverage[number] = rebuilt.known, rebuilt.coverage
        remarks += [f"surface {number}: {remark}" for remark in said]
        report(Progress("reconstruct environments", done + 1, len(wanted), f"surface {number}"))
    return Reconstruction(environments, known, coverage, tuple(remarks))


def sound_pixels(buffers: ShadingBuffers) -> Mask:
    """Tell which pixels have light and a direction."""
    planes = [buffers.diffuse, buffers.reflection, buffers.normals, buffers.positions]
    planes += [albedo for albedo in (buffers.albedo, buffers.reflection_albedo) if albedo is not None]
    sound = np.isfinite(buffers.reflection_occlusion)
    for plane in planes:
        sound &= np.isfinite(plane).all(axis=-1)
    with np.errstate(invalid="ignore", over="ignore"):
        sound &= np.abs(np.linalg.norm(buffers.normals, axis=-1) - 1) < _UNIT
    return sound


def _surface(
    buffers: ShadingBuffers, number: int, options: ReconstructOptions
) -> tuple[SurfaceEnvironment, ReflectionEnvironment, list[str]]:
    here = buffers.surfaces == number
    remarks = []
    used = here & sound_pixels(buffers)
    if lost := int(np.count_nonzero(here & ~used)):
        remarks.append(f"{lost} of {np.count_nonzero(here)} pixels hold no numbers or no direction and are left out")
    if not used.any():
        raise InputError(f"surface {number}: none of its pixels holds light and a direction; render it again")
    buffers = _emptied(buffers, ~used)
    diffuse_used = reflection_used = used
    if options.hot_pixels is not None:
        diffuse_used = used & ~hot_pixels(buffers.diffuse, used, options.hot_pixels)
        if hot := int(np.count_nonzero(used & ~diffuse_used)):
            remarks.append(f"{hot} hot pixels of the diffuse shading are left out")
    diffuse, reflection = buffers.diffuse, buffers.reflection
    if buffers.albedo is not None:
        diffuse, diffuse_used = _light(diffuse, buffers.albedo, diffuse_used, number)
    if buffers.reflection_albedo is not None:
        reflection, reflection_used = _light(reflection, buffers.reflection_albedo, reflection_used, number)
    fit = fit_diffuse(buffers.normals[diffuse_used], diffuse[diffuse_used], options.diffuse)
    rebuilt = reconstruct_reflection(
        reflection,
        buffers.normals,
        buffers.to_eye,
        _positions(buffers, used),
        buffers.reflection_occlusion,
        reflection_used,
        options.reflection,
    )
    environment = SurfaceEnvironment(
        fit.coefficients,
        rebuilt.front,
        rebuilt.back,
        diffuse_is_illumination=buffers.albedo is not None,
        reflection_is_illumination=buffers.reflection_albedo is not None,
    )
    if options.regions > 1:
        if _positions(buffers, used) is None:
            raise InputError(f"surface {number}: has no positions to divide it by; render them, or leave regions out")
        light = Light(diffuse, diffuse_used, reflection, reflection_used)
        environment = with_regions(environment, buffers, light, options.regions, options.diffuse, options.reflection)
    return environment, rebuilt, [*remarks, *fit.remarks, *rebuilt.remarks]


def _light(shading: F32, albedo: F32, used: Mask, number: int) -> tuple[F32, Mask]:
    light, told = illumination(shading, albedo, used)
    if not told.any():
        raise InputError(f"surface {number}: its albedo is black everywhere; leave it out of the buffers")
    return light, told


def _emptied(buffers: ShadingBuffers, where: Mask) -> ShadingBuffers:
    """Put zeros where nothing is looked at, so that nothing there can disturb the arithmetic."""
    names = ("diffuse", "reflection", "normals", "positions", "albedo", "reflection_albedo")
    planes = {name: getattr(buffers, name) for name in names}
    kept: dict[str, Any] = {
        name: np.where(where[..., None], np.float32(0), plane) for name, plane in planes.items() if plane is not None
    }
    return replace(buffers, **kept)


def _positions(buffers: ShadingBuffers, used: Mask) -> F32 | None:
    """Return the positions, or nothing where all stand at one place because nobody knows them."""
    positions = buffers.positions[used]
    return buffers.positions if len(positions) < 2 or np.ptp(positions, axis=0).any() else None


def _window(shown: Mask) -> tuple[slice, slice]:
    rows, columns = np.flatnonzero(shown.any(axis=1)), np.flatnonzero(shown.any(axis=0))
    return slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)


def _cut(buffers: ShadingBuffers, window: tuple[slice, slice]) -> ShadingBuffers:
    values = {one.name: getattr(buffers, one.name) for one in fields(buffers)}
    planes: dict[str, Any] = {name: value[window] for name, value in values.items() if isinstance(value, np.ndarray)}
    return replace(buffers, **planes)
