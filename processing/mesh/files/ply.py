"""PLY and STL, through trimesh."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from trimesh.exchange.ply import load_ply
from trimesh.exchange.stl import load_stl

from litrig.base.errors import FormatError
from litrig.base.files import read_limited
from processing.mesh.files.by_library import read_by_library, table, triangle_table
from processing.mesh.files.pieces import MOST_BYTES, MOST_LINES, MOST_TRIANGLES, Piece

_UV_NAMES = (("s", "t"), ("u", "v"), ("texture_u", "texture_v"))
_HEADER_BYTES = 1 << 16


def read_ply(path: Path) -> list[Piece]:
    """Read a PLY file, ASCII or binary, with texture coordinates at vertices or at the corners of faces.

    Raises
    ------
    InputError, FormatError
        The file is missing, too large, damaged, or has no faces.
    """
    content = read_limited(path, MOST_BYTES)
    _check_header(path, content)
    found = read_by_library(
        path, content, lambda file: _ply_piece(load_ply(file, fix_texture=False, skip_materials=True))
    )
    if found is None:
        raise FormatError(f"{path}: holds no faces; export it again, as triangles")
    return [_limited(path, found)]


def read_stl(path: Path) -> list[Piece]:
    """Read an STL file, ASCII or binary.

    Raises
    ------
    InputError, FormatError
        The file is missing, too large, damaged, or has no faces.
    """
    content = read_limited(path, MOST_BYTES)
    if content.lower().count(b"vertex") > 3 * MOST_TRIANGLES:
        raise FormatError(f"{path}: has more than {MOST_TRIANGLES:,} triangles; reduce it")
    found = read_by_library(path, content, lambda file: _stl_pieces(load_stl(file)))
    if not found:
        raise FormatError(f"{path}: holds no faces; export it again, as triangles")
    return [_limited(path, piece) for piece in found]


def _limited(path: Path, piece: Piece) -> Piece:
    if len(piece.triangles) > MOST_TRIANGLES:
        raise FormatError(f"{path}: has {len(piece.triangles):,} triangles, {MOST_TRIANGLES:,} are the most; reduce it")
    return piece


def _check_header(path: Path, content: bytes) -> None:
    """Refuse what claims more rows than its bytes can hold, before anything is allocated for them."""
    header, end, _ = content[:_HEADER_BYTES].partition(b"end_header")
    if not header.startswith(b"ply") or not end:
        raise FormatError(f"{path}: is cut short or no PLY, its header does not end; export it again")
    if b"format ascii" in header and max(content.count(b"\n"), content.count(b"\r")) > MOST_LINES:
        raise FormatError(f"{path}: has more than {MOST_LINES:,} lines; reduce it")
    for line in header.splitlines():
        words = line.split()
        if words[:1] != [b"element"]:
            continue
        if len(words) != 3 or not words[2].isdigit():
            raise FormatError(f"{path}: its header says no number of elements; export it again")
        if int(words[2]) > len(content):
            raise FormatError(f"{path}: claims {int(words[2]):,} elements in {len(content):,} bytes; export it again")


def _ply_piece(read: dict[str, Any]) -> Piece | None:
    faces = read.get("faces")
    if faces is None or not len(faces):
        return None
    positions, triangles = table(read["vertices"], 3), triangle_table(faces)
    normals = read.get("vertex_normals")
    elements = read["metadata"]["_ply_raw"]
    uvs, uv_triangles = _corner_uvs(elements["face"]["data"], len(triangles)), None
    if uvs is not None:
        uv_triangles = np.arange(len(uvs)).reshape(-1, 3)
    else:
        uvs = _vertex_uvs(elements["vertex"]["data"])
        uv_triangles = triangles if uvs is not None else None
    return Piece(
        positions,
        triangles,
        uvs=uvs,
        uv_triangles=uv_triangles,
        normals=None if normals is None else table(normals, 3),
        normal_triangles=None if normals is None else triangles,
    )


def _columns(data: Any) -> tuple[str, ...]:
    return tuple(data) if isinstance(data, dict) else tuple(data.dtype.names or ())


def _vertex_uvs(data: Any) -> NDArray[np.float64] | None:
    for u_name, v_name in _UV_NAMES:
        if {u_name, v_name} <= set(_columns(data)):
            columns = [np.asarray(data[name], np.float64).reshape(-1) for name in (u_name, v_name)]
            return np.stack(columns, axis=1)
    return None


def _corner_uvs(data: Any, triangles: int) -> NDArray[np.float64] | None:
    """Return the texture coordinates of every corner (3T, 2), as MeshLab writes them beside each face's indices."""
    if "texcoord" not in _columns(data):
        return None
    values = data["texcoord"] if isinstance(data, dict) else data["texcoord"]["f1"]
    rows = np.array([np.asarray(row, np.float64).reshape(-1) for row in values])
    if rows.shape != (triangles, 6):
        raise ValueError("texture coordinates at faces that are no triangles")
    return rows.reshape(-1, 2)


def _stl_pieces(read: dict[str, Any]) -> list[Piece]:
    solids = read["geometry"].values() if "geometry" in read else [read]
    return [Piece(table(solid["vertices"], 3), triangle_table(solid["faces"])) for solid in solids]
