"""Material files opened for drawing on a mesh, told apart by their endings.

A new kind of material is one more opener in `_OPENERS`.
"""

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
from processing.ptm.basis import PTM
from processing.ptm.files.either import ENDINGS as PTM_ENDINGS
from processing.ptm.files.either import holds_material, read_any
from processing.ptm.model import Ptm
from processing.ptm.relighting.normals import normals_of
from viewer.geometry import Geometry
from viewer.key_shadow import KeyShadow
from viewer.look import Look
from viewer.materials.amc import AmcMaterial, Coordinates
from viewer.materials.low_rank import LowRankMaterial
from viewer.materials.matcap import MatcapMaterial
from viewer.materials.ptm import PtmMaterial
from viewer.renderer import Renderer
from viewer.staging import DEFAULT_LIGHT, AmcStaging, PtmStaging, Staging

Opener = Callable[[Renderer, Path, Staging, Geometry], AbstractContextManager[Look]]

MATCAP_ENDINGS = (*sorted(DISPLAY_ENDINGS), ".exr", ".hdr")


def open_look(renderer: Renderer, file: Path, staging: Staging, geometry: Geometry) -> AbstractContextManager[Look]:
    """Read a material file, upload it, and say how it looks on a geometry as it is staged.

    Raises
    ------
    InputError, FormatError
        The file is missing, damaged or of an unknown kind, or the staging does not go with it.
    """
    for holds, opener in _OPENERS:
        if holds(file):
            return opener(renderer, file, staging, geometry)
    endings = ", ".join((*either.ENDINGS, *PTM_ENDINGS, *MATCAP_ENDINGS))
    raise InputError(f"{file}: unknown ending; give a file that ends in {endings}, or a web folder")


def is_amc(file: Path) -> bool:
    return file.name.lower().endswith(either.ENDINGS)


def read_ptm_to_draw(file: Path) -> Ptm:
    """Read a PTM whose basis the shaders know."""
    ptm = read_any(file)
    if ptm.basis != PTM:
        raise InputError(f"{file}: is an {ptm.basis}; only {PTM} is drawn here, so give it to litrig ptm relight")
    return ptm


def refuse_amc_staging(file: Path, staging: Staging, kind: str) -> None:
    """Refuse what is said of AMCs for another kind of material.

    Raises
    ------
    InputError
        The staging turns or paints the grain, or names other tables.
    """
    amc = staging.amc
    if amc.directions is not None or amc.turn_deg:
        raise InputError(
            f"{file}: {kind} has no grain to turn or to paint; leave out the turn and the directions, or give an AMC"
        )
    if amc != AmcStaging():
        raise InputError(
            f"{file}: {kind} has no tables to choose from or to add; leave out --unlit, --key, --add and "
            "--coordinates, or give an AMC"
        )


def refuse_ptm_staging(file: Path, staging: Staging, kind: str) -> None:
    """Refuse what is said of PTMs for another kind of material."""
    if staging.ptm != PtmStaging():
        raise InputError(
            f"{file}: {kind} takes no --specular and no --repeat, which are for a PTM; leave them out, or give a PTM"
        )


@contextmanager
def _amc_look(renderer: Renderer, file: Path, staging: Staging, geometry: Geometry) -> Iterator[Look]:
    if staging.light is not None:
        raise InputError(f"{file}: an AMC was lit when it was captured; leave out the light, turn the object instead")
    refuse_ptm_staging(file, staging, "an AMC")
    amc = staging.amc
    _check_tables(file, amc)
    with ExitStack() as held:
        if _is_low_rank(file) and amc.unlit is None and amc.add is None and amc.coordinates is Coordinates.FRAGMENT:
            low_rank = held.enter_context(renderer.upload(LowRankMaterial, read_low_rank(file)))
            yield low_rank.look(occluded=staging.occluded)
            return
        table, *others = (
            held.enter_context(renderer.upload(AmcMaterial, *_read_amc(name)))
            for name in (file, amc.unlit, amc.add)
            if name is not None
        )
        if amc.unlit is not None and amc.key is not None:
            shadow = held.enter_context(renderer.upload(KeyShadow))
            shadow.cast(renderer, geometry, staging.view, amc.key)
            yield table.keyed_look(others[0], shadow, occluded=staging.occluded)
        elif amc.add is not None:
            yield table.look_with(others[0], occluded=staging.occluded)
        else:
            yield table.look(coordinates=amc.coordinates, occluded=staging.occluded)


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
def _ptm_look(renderer: Renderer, file: Path, staging: Staging, _geometry: Geometry) -> Iterator[Look]:
    refuse_amc_staging(file, staging, "a PTM")
    ptm, staged = read_ptm_to_draw(file), staging.ptm
    normals = None if staged.highlight is None else normals_of(ptm)
    with renderer.upload(PtmMaterial, ptm, smooth=True, normals=normals, repeat=staged.repeat) as material:
        light = staging.light or DEFAULT_LIGHT
        yield material.mesh_look(light, occluded=staging.occluded, highlight=staged.highlight)


@contextmanager
def _matcap_look(renderer: Renderer, file: Path, staging: Staging, _geometry: Geometry) -> Iterator[Look]:
    if staging.light is not None:
        raise InputError(f"{file}: a MatCap has its light in it; leave out the light, turn the object instead")
    refuse_amc_staging(file, staging, "a MatCap")
    refuse_ptm_staging(file, staging, "a MatCap")
    disc = read_linear(file)
    if disc.shape[0] != disc.shape[1]:
        raise InputError(
            f"{file}: {disc.shape[1]} × {disc.shape[0]} pixels are no MatCap; crop it to a square that its ball fills"
        )
    with renderer.upload(MatcapMaterial, disc) as material:
        yield material.look(occluded=staging.occluded)


def _is_picture(file: Path) -> bool:
    return file.name.lower().endswith(MATCAP_ENDINGS)


# The endings of the first two are longer than those of plain pictures.
_OPENERS: tuple[tuple[Callable[[Path], bool], Opener], ...] = (
    (is_amc, _amc_look),
    (holds_material, _ptm_look),
    (_is_picture, _matcap_look),
)
