"""A mesh by the name that a person gives: one that comes along, or a file."""

from collections.abc import Callable
from pathlib import Path

from litrig.base.errors import InputError
from processing.mesh.builtin import BUILTIN_NAMES, builtin_mesh
from processing.mesh.model import Mesh

ENDINGS = (".obj", ".ply", ".glb", ".stl")


def mesh_of(name_or_file: str | Path) -> tuple[Mesh, tuple[str, ...]]:
    """Return a mesh that comes along, or read one from a file.

    Parameters
    ----------
    name_or_file : one of `BUILTIN_NAMES`, or a path that ends in one of `ENDINGS`

    Returns
    -------
    mesh : within the unit sphere
    remarks : what was derived or left out, a line each for standard error; none for meshes that come along

    Raises
    ------
    InputError, FormatError
        No mesh has that name; or the file is missing, damaged, too large, or holds nothing that could be shown.
    """
    if str(name_or_file) in BUILTIN_NAMES:
        return builtin_mesh(str(name_or_file)), ()
    path = Path(name_or_file)
    reader = _READERS.get(path.suffix.lower())
    if reader is not None:
        return reader(path)
    names, endings = ", ".join(BUILTIN_NAMES), ", ".join(ENDINGS)
    if path.suffix.lower() == ".gltf":
        raise InputError(f"{path}: lies in several files, which are not read; export it as GLB, which is one")
    raise InputError(f"mesh {str(name_or_file)!r}: there is no such mesh; use one of {names}, or a file in {endings}")


# The libraries that read files take a while to load, so that only who names a file waits for them.
def _obj(path: Path) -> tuple[Mesh, tuple[str, ...]]:
    from processing.mesh.assemble import assemble
    from processing.mesh.files.obj import read_obj

    return assemble(read_obj(path), str(path))


def _ply(path: Path) -> tuple[Mesh, tuple[str, ...]]:
    from processing.mesh.assemble import assemble
    from processing.mesh.files.ply import read_ply

    return assemble(read_ply(path), str(path))


def _stl(path: Path) -> tuple[Mesh, tuple[str, ...]]:
    from processing.mesh.assemble import assemble
    from processing.mesh.files.ply import read_stl

    return assemble(read_stl(path), str(path))


def _glb(path: Path) -> tuple[Mesh, tuple[str, ...]]:
    from processing.mesh.assemble import assemble
    from processing.mesh.files.glb import read_glb

    pieces, remarks = read_glb(path)
    mesh, more = assemble(pieces, str(path))
    return mesh, (*(f"{path}: {remark}" for remark in remarks), *more)


_READERS: dict[str, Callable[[Path], tuple[Mesh, tuple[str, ...]]]] = {
    ".obj": _obj,
    ".ply": _ply,
    ".glb": _glb,
    ".stl": _stl,
}
