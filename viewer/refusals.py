"""Refusing what is said of one kind of material for another."""

from pathlib import Path

from litrig.base.errors import InputError
from processing.matcap.matcap_exr import ENDING as DECOMPOSED
from viewer.motion import Course
from viewer.staging import AmcStaging, MatcapStaging, PtmStaging, Staging


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


def refuse_ptm_staging(file: Path, staging: Staging, kind: str, instead: str) -> None:
    """Refuse what is said of PTMs for another kind of material.

    Parameters
    ----------
    kind : what the file is, and why that has no use for it
    instead : what else to do

    Raises
    ------
    InputError
        The staging has lights, or other things that a PTM alone takes.
    """
    ptm = staging.ptm
    if ptm.lights or (staging.motion is not None and staging.motion.course is Course.TOUR):
        raise InputError(f"{file}: {kind}; leave out the light, {instead}")
    if ptm != PtmStaging():
        raise InputError(
            f"{file}: {kind}; leave out what is for PTMs: --light-colour, --softness, --diffuse-gain, --specular, "
            "--normals, --window and --repeat"
        )


def is_decomposed(file: Path) -> bool:
    return file.name.lower().endswith(DECOMPOSED)


def refuse_matcap_staging(file: Path, staging: Staging) -> None:
    """Refuse what is said of decomposed MatCaps for another kind of material.

    Raises
    ------
    InputError
        The staging has a recipe, more MatCaps, or pictures that vary one.
    """
    if staging.matcap != MatcapStaging() and not is_decomposed(file):
        raise InputError(
            f"{file}: is no decomposed MatCap; leave out what is for those: --recipe (but for a rendered picture with "
            "its --environment), --with, --material-ids, the textures, --occlusion-map and --occlusion-of"
        )
