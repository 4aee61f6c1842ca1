"""Decomposed MatCaps opened for drawing: turned, edited, varied over the surface, several on one mesh."""

import dataclasses
import math
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from litrig.base.errors import InputError
from processing.matcap.matcap_exr import read_matcap
from processing.matcap.model import DecomposedMatcap
from processing.matcap.recipe.apply import apply_recipe
from processing.matcap.recipe.recipe_toml import read_recipe
from viewer.geometry import Geometry
from viewer.look import Look
from viewer.looks import Looks
from viewer.materials.decomposed_matcap import DecomposedMatcapMaterial
from viewer.motion import Course, Moment
from viewer.refusals import is_decomposed, refuse_amc_staging
from viewer.renderer import Renderer
from viewer.staging import MatcapStaging, PtmStaging, Staging


@contextmanager
def decomposed_looks(renderer: Renderer, file: Path, staging: Staging, _geometry: Geometry) -> Iterator[Looks]:
    """Read and upload a decomposed MatCap, and those that share the mesh with it.

    Raises
    ------
    InputError, FormatError
        A file is missing or damaged, or the staging does not go with it.
    """
    refuse_amc_staging(file, staging, "a MatCap")
    light = _light(file, staging)
    said = staging.matcap
    _refuse_idle(file, staging)
    matcaps = [edited(file, said.recipe), *(_read_other(other) for other in said.others)]
    if said.others and said.variation.materials is None:
        raise InputError(f"{said.others[0]}: where it goes was not said; give --material-ids, or leave out --with")
    variation = said.variation.read(len(matcaps))
    goes_round = staging.motion is not None and staging.motion.course is Course.TOUR
    with ExitStack() as held:
        first, *others = (
            held.enter_context(renderer.upload(DecomposedMatcapMaterial, matcap, variation, number))
            for number, matcap in enumerate(matcaps)
        )

        def looks(moment: Moment) -> Look:
            round_deg = moment.lights_turn_deg if goes_round else 0.0
            turn = Rotation.from_euler("z", round_deg, degrees=True) * towards(moment.matcap_light or light)
            each = [
                material.look(occluded=staging.occluded, occlusion=said.occlusion, light_turn=turn)
                for material in (first, *others)
            ]
            return dataclasses.replace(each[0], others=tuple(each[1:]))

        yield looks


def edited(file: Path, recipe: Path | None) -> DecomposedMatcap:
    """Read a decomposed MatCap and do a recipe's steps to it.

    Raises
    ------
    InputError, FormatError
        A file is missing or damaged, or a step cannot be done.
    """
    matcap = read_matcap(file)
    return matcap if recipe is None else apply_recipe(matcap, read_recipe(recipe), recipe.parent, str(recipe))


def towards(light: tuple[float, float]) -> Rotation:
    """Return the smallest turn that brings light from the camera to a direction with this x and y, view frame."""
    x, y = light
    height = math.sqrt(max(1 - x * x - y * y, 0.0))
    return Rotation.from_rotvec(_axis(x, y) * math.acos(min(height, 1.0)))


def _axis(x: float, y: float) -> NDArray[np.float64]:
    length = math.hypot(x, y)
    return np.array([-y, x, 0.0]) / length if length else np.zeros(3)


def _light(file: Path, staging: Staging) -> tuple[float, float]:
    """Return where the light from the camera goes; the camera itself if nobody said.

    Raises
    ------
    InputError
        There are several lights, they are no directions, or something else is said of PTMs.
    """
    lights = staging.ptm.lights
    if staging.ptm != PtmStaging(lights=lights):
        raise InputError(
            f"{file}: a MatCap has its light in it, which --light turns; leave out what is for PTMs: --light-colour, "
            "--softness, --diffuse-gain, --specular, --normals, --window and --repeat"
        )
    if len(lights) > 1:
        raise InputError(f"{file}: all of a MatCap's light turns together; give --light once")
    if lights and not math.hypot(*lights[0]) <= 1:
        raise InputError(f"{file}: light {lights[0][0]:g} {lights[0][1]:g} is no direction; keep U² + V² within 1")
    return lights[0] if lights else (0.0, 0.0)


def _refuse_idle(file: Path, staging: Staging) -> None:
    """Refuse what would change nothing, for something else was left out.

    Raises
    ------
    InputError
        There is an occlusion of one half without any occlusion, or a roughness without its picture.
    """
    said, plain = staging.matcap, MatcapStaging()
    if said.occlusion != plain.occlusion and not staging.occluded and said.variation.openness is None:
        raise InputError(f"{file}: --occlusion-of has nothing to choose; give --occlusion or --occlusion-map too")
    if said.variation.roughest_deg != plain.variation.roughest_deg and said.variation.roughness is None:
        raise InputError(f"{file}: --roughest needs to know where; give --roughness-texture too")


def _read_other(file: Path) -> DecomposedMatcap:
    if not is_decomposed(file):
        raise InputError(f"{file}: is no decomposed MatCap by its ending; give one to --with")
    return read_matcap(file)
