"""Files of materials in any form, told apart by the ending: `.ptm`, `.rti`, `.ptm.exr`, and web folders without one."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from litrig.base.errors import InputError
from litrig.base.files import check_new_folder, is_folder
from litrig.base.progress import Report, silent
from processing.ptm.basis import PTM, TERMS, Basis
from processing.ptm.files import rti_file, web_folder
from processing.ptm.files.coder import Coder
from processing.ptm.files.ptm_exr import describe_ptm_exr, read_ptm_exr, write_ptm_exr
from processing.ptm.files.ptm_file import describe_ptm, ptm_coder, read_ptm, write_ptm
from processing.ptm.files.rti_file import describe_rti, read_rti, rti_coder, write_rti
from processing.ptm.files.web_folder import (
    INFO,
    describe_web_folder,
    read_web_folder,
    web_folder_coder,
    write_web_folder,
)
from processing.ptm.model import Material, Ptm

_EVERY_BASIS = tuple(Basis(kind, terms) for kind, counts in TERMS.items() for terms in counts)


@dataclass(frozen=True)
class Form:
    """A way to keep a material.

    Attributes
    ----------
    bases : those that it can hold
    coder : chooses codes of eight bits; None where it holds floats
    """

    name: str
    ending: str
    bases: tuple[Basis, ...]
    read: Callable[[Path], Ptm]
    write: Callable[[Path, Material, Coder | None, Report], None]
    describe: Callable[[Path], dict[str, Any]]
    coder: Callable[[Path, Material], Coder] | None


def _write_floats(path: Path, material: Material, _: Coder | None, report: Report) -> None:
    write_ptm_exr(path, material, report)


FORMS = (
    Form(".ptm.exr", ".ptm.exr", _EVERY_BASIS, read_ptm_exr, _write_floats, describe_ptm_exr, None),
    Form(".ptm", ".ptm", (PTM, Basis("ptm", 3)), read_ptm, write_ptm, describe_ptm, ptm_coder),
    Form(".rti", ".rti", rti_file.BASES, read_rti, write_rti, describe_rti, rti_coder),
    Form(
        "a web folder",
        "",
        web_folder.BASES,
        read_web_folder,
        write_web_folder,
        describe_web_folder,
        web_folder_coder,
    ),
)
"""Every form; the last is the one of names without an ending."""
ENDINGS = tuple(form.ending for form in FORMS if form.ending)


def holds_material(path: Path) -> bool:
    """Tell whether a path is read as one of the forms; a folder is."""
    return path.name.lower().endswith(ENDINGS) or path.name == INFO or is_folder(path)


def read_any(path: Path) -> Ptm:
    """Read a material in the form that the path names; of a web folder, its `info.json` will do.

    Raises
    ------
    InputError, FormatError
        The ending is of no form, or the file is missing, damaged, or of a kind that is not read.
    """
    form, place = _form_to_read(path)
    return form.read(place)


def describe(path: Path) -> dict[str, Any]:
    """Say what a file holds: its form, sizes, basis, colour, space and source."""
    form, place = _form_to_read(path)
    return {"form": form.name, **form.describe(place)}


def choose_coder(path: Path, material: Material) -> Coder | None:
    """Choose how a material is rounded in the form that the path names; None if it is not.

    Raises
    ------
    InputError
        As `check_form`, or a coefficient is not finite.
    """
    form = check_form(path, material.basis)
    return None if form.coder is None else form.coder(path, material)


def write_any(
    path: Path,
    material: Material,
    coder: Coder | None = None,
    report: Report = silent,
    *,
    quality: int | None = None,
) -> None:
    """Write a material in the form that the path names.

    Parameters
    ----------
    coder : as `choose_coder` chooses it, if that has been done
    quality : of a web folder's JPEGs, 1 to 100

    Raises
    ------
    InputError
        The ending is of no form, the form cannot hold the material's basis or takes no quality, or the path cannot be
        written.
    """
    form = check_form(path, material.basis)
    if quality is None:
        form.write(path, material, coder, report)
    elif form.ending:
        raise InputError(f"{path}: holds no JPEGs whose quality could be chosen; leave the quality out")
    else:
        write_web_folder(path, material, coder, report, quality=quality)


def check_form(path: Path, basis: Basis) -> Form:
    """Refuse before the work a path whose form cannot hold a basis, and a place where it could not be written.

    Raises
    ------
    InputError
        The message names the forms that can.
    """
    form = _form_of(path)
    if form is None:
        raise InputError(f"{path}: cannot be written as {path.suffix}; {_advice(FORMS)}")
    if basis not in form.bases:
        held = " and ".join(str(held) for held in form.bases)
        able = _advice(form for form in FORMS if basis in form.bases)
        raise InputError(f"{path}: {form.name} holds {held}, not {basis}; {able}")
    if not form.ending:
        check_new_folder(path)
    elif not path.absolute().parent.is_dir():
        raise InputError(f"{path}: the folder {path.parent} does not exist; create it first")
    return form


def _form_to_read(path: Path) -> tuple[Form, Path]:
    if path.name == INFO or is_folder(path):
        return FORMS[-1], path.parent if path.name == INFO else path
    form = _form_of(path)
    if form is None:
        raise InputError(f"{path}: is of no form that is known; give {', '.join(ENDINGS)} or a web folder")
    return form, path


def _form_of(path: Path) -> Form | None:
    for form in FORMS[:-1]:
        if path.name.lower().endswith(form.ending):
            return form
    return FORMS[-1] if not path.suffix else None


def _advice(forms: Iterable[Form]) -> str:
    able = list(forms)
    endings = " or ".join(form.ending for form in able if form.ending)
    return f"end the name in {endings}" + ("" if able[-1].ending else ", or give it no ending for a web folder")
