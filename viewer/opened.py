"""Material files opened for drawing on a mesh, told apart by their endings.

A new kind of material is one more opener in `_OPENERS`.
"""

import dataclasses
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from pathlib import Path

from litrig.base.errors import InputError
from litrig.base.pictures import DISPLAY_ENDINGS, read_linear
from processing.amc.files import either
from processing.amc.files.ktx2 import read_levels
from processing.amc.files.low_rank_exr import read_low_rank
from processing.amc.mips import MipLevel
from processing.amc.model import Amc
from processing.matcap.matcap_exr import ENDING as DECOMPOSED
from processing.ptm.basis import PTM
from processing.ptm.files.either import ENDINGS as PTM_ENDINGS
from processing.ptm.files.either import holds_material, read_any
from processing.ptm.model import Ptm
from viewer.geometry import Geometry
from viewer.key_shadow import KeyShadow
from viewer.look import Look
from viewer.looks import Looks
from viewer.materials.amc import AmcMaterial, Coordinates
from viewer.materials.low_rank import LowRankMaterial
from viewer.materials.matcap import MatcapMaterial
from viewer.materials.ptm import PtmMaterial
from viewer.materials.ptm_shading import PtmShading
from viewer.motion import Course, Moment, turned_lights
from viewer.opened_matcap import decomposed_looks
from viewer.refusals import is_decomposed, refuse_amc_staging, refuse_matcap_staging, refuse_ptm_staging
from viewer.renderer import Renderer
from viewer.staging import AmcStaging, Staging

Opener = Callable[[Renderer, Path, Staging, Geometry], AbstractContextManager[Looks]]

MATCAP_ENDINGS = (*sorted(DISPLAY_ENDINGS), ".exr", ".hdr")


def open_looks(renderer: Renderer, file: Path, staging: Staging, geometry: Geometry) -> AbstractContextManager[Looks]:
    """Read a material file, upload it, and say how it looks on a geometry as it is staged, moment by moment.

    Raises
    ------
    InputError, FormatError
        The file is missing, damaged or of an unknown kind, or the staging does not go with it.
    """
    refuse_matcap_staging(file, staging)
    for holds, opener in _OPENERS:
        if holds(file):
            return opener(renderer, file, staging, geometry)
    endings = ", ".join((*either.ENDINGS, *PTM_ENDINGS, DECOMPOSED, *MATCAP_ENDINGS))
    raise InputError(f"{file}: unknown ending; give a file that ends in {endings}, or a web folder")


def is_amc(file: Path) -> bool:
    return file.name.lower().endswith(either.ENDINGS)


@contextmanager
def _amc_looks(renderer: Renderer, file: Path, staging: Staging, geometry: Geometry) -> Iterator[Looks]:
    refuse_ptm_staging(file, staging, "an AMC was lit when it was captured", "turn the object instead")
    amc = staging.amc
    _check_tables(file, amc)
    with ExitStack() as held:
        if _is_low_rank(file) and amc.unlit is None and amc.add is None and amc.coordinates is Coordinates.FRAGMENT:
            low_rank = held.enter_context(renderer.upload(LowRankMaterial, read_low_rank(file)))
            yield lambda _: low_rank.look(occluded=staging.occluded)
            return
        table, *others = (
            held.enter_context(renderer.upload(AmcMaterial, *_read_amc(name)))
            for name in (file, amc.unlit, amc.add)
            if name is not None
        )
        if amc.unlit is not None and amc.key is not None:
            yield _keyed(renderer, geometry, table, others[0], held.enter_context(renderer.upload(KeyShadow)), staging)
        elif amc.add is not None:
            yield lambda _: table.look_with(others[0], occluded=staging.occluded)
        else:
            yield lambda _: table.look(coordinates=amc.coordinates, occluded=staging.occluded)


def _keyed(
    renderer: Renderer,
    geometry: Geometry,
    table: AmcMaterial,
    unlit: AmcMaterial,
    shadow: KeyShadow,
    staging: Staging,
) -> Looks:
    def looks(moment: Moment) -> Look:
        shadow.cast(renderer, geometry, moment.view, staging.amc.key or (0.0, 0.0))
        return table.keyed_look(unlit, shadow, occluded=staging.occluded)

    return looks


def _check_tables(file: Path, amc: AmcStaging) -> None:
    if amc.unlit is not None and amc.key is None:
        raise InputError(f"{amc.unlit}: does not say where the key light stands; say it with --key U V")
    if amc.key is not None and amc.unlit is None:
        raise InputError(
            f"{file}: its key light cannot be shadowed without a table that lacks it; give it with --unlit"
        )
    if amc.add is not None and amc.unlit is not None:
        raise InputError(f"{file}: --add and --unlit make pairs of their own; give one")
    if amc.coordinates is not Coordinates.FRAGMENT and (amc.add is not None or amc.unlit is not None):
        raise InputError(f"{file}: --coordinates {amc.coordinates} is for one table; leave it out for a pair")


def _is_low_rank(file: Path) -> bool:
    return file.name.lower().endswith(either.LOW_RANK)


def _read_amc(file: Path) -> tuple[Amc, list[MipLevel] | None]:
    """Read a table and its smaller levels; a file that has none leaves them to whoever reads it."""
    if not is_amc(file):
        raise InputError(f"{file}: is no AMC by its ending; give a file that ends in {', '.join(either.ENDINGS)}")
    if _is_low_rank(file):
        return either.read_any(file), None
    amc, levels = read_levels(file)
    return amc, levels if len(levels) > 1 else None


@contextmanager
def _ptm_looks(renderer: Renderer, file: Path, staging: Staging, _geometry: Geometry) -> Iterator[Looks]:
    refuse_amc_staging(file, staging, "a PTM")
    if staging.ptm.window is not None:
        raise InputError(f"{file}: a window is of a flat PTM; leave it out, or the mesh")
    refuse_changed_normals(file, staging)
    shading = staging.ptm.shading()
    ptm = read_any(file)
    check_shading(file, ptm, shading)
    wanted = {"normals": shading.needs_normals, "brightest": shading.needs_brightest}
    repeat = staging.ptm.repeat
    with renderer.upload(PtmMaterial, ptm, smooth=True, repeats=repeat > 1, **wanted) as material:
        yield lambda moment: material.mesh_look(shading_at(shading, moment), occluded=staging.occluded, repeat=repeat)


def shading_at(shading: PtmShading, moment: Moment) -> PtmShading:
    """Turn the lights as far as they are at a moment."""
    return dataclasses.replace(shading, lights=turned_lights(shading.lights, moment.lights_turn_deg))


def refuse_changed_normals(file: Path, staging: Staging) -> None:
    """Refuse what would be done to light where normals are shown.

    Raises
    ------
    InputError
        The staging has an exposure, a tone curve, or lights that move.
    """
    if staging.ptm.normals and not staging.development.changes_nothing:
        raise InputError(f"{file}: normals have no exposure and no tone; leave those out, or --normals")
    if staging.ptm.normals and staging.motion is not None and staging.motion.course is Course.TOUR:
        raise InputError(f"{file}: normals are the same under every light; leave out --tour, or --normals")


def check_shading(file: Path, ptm: Ptm, shading: PtmShading) -> None:
    """Refuse a shading that does not go with a file's basis, with the file's name.

    Raises
    ------
    InputError
        Diffuse gain was asked for, and the basis has no second derivatives.
    """
    if shading.needs_brightest and ptm.basis != PTM:
        raise InputError(
            f"{file}: is a {ptm.basis}, and diffuse gain scales the second derivatives of a {PTM}; fit one, or use "
            "--specular, which takes any material"
        )


@contextmanager
def _matcap_looks(renderer: Renderer, file: Path, staging: Staging, _geometry: Geometry) -> Iterator[Looks]:
    refuse_ptm_staging(file, staging, "a MatCap has its light in it", "turn the object instead")
    refuse_amc_staging(file, staging, "a MatCap")
    disc = read_linear(file)
    if disc.shape[0] != disc.shape[1]:
        raise InputError(
            f"{file}: {disc.shape[1]} × {disc.shape[0]} pixels are no MatCap; crop it to a square that its ball fills"
        )
    with renderer.upload(MatcapMaterial, disc) as material:
        yield lambda _: material.look(occluded=staging.occluded)


def _is_picture(file: Path) -> bool:
    return file.name.lower().endswith(MATCAP_ENDINGS)


# The endings of all but the last are longer than those of plain pictures.
_OPENERS: tuple[tuple[Callable[[Path], bool], Opener], ...] = (
    (is_amc, _amc_looks),
    (holds_material, _ptm_looks),
    (is_decomposed, decomposed_looks),
    (_is_picture, _matcap_looks),
)
