"""GLB, the one-file form of glTF 2.0, through trimesh; what its JSON may ask for is checked before."""

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray

from litrig.base.errors import FormatError
from litrig.base.files import read_limited
from processing.mesh.files.by_library import read_by_library, table, triangle_table
from processing.mesh.files.glb_header import reduce_header
from processing.mesh.files.pieces import F64, MOST_BYTES, Piece

_MAGIC, _JSON, _BINARY = 0x46546C67, 0x4E4F534A, 0x004E4942
_MOST_JSON_BYTES = 1 << 26


def read_glb(path: Path) -> tuple[list[Piece], list[str]]:
    """Read all triangles of a GLB file's scene, moved to where its nodes put them.

    Returns
    -------
    pieces, remarks : what is left out, in words

    Raises
    ------
    InputError, FormatError
        The file is missing, too large, damaged, wants other files, or has no triangles.
    """
    text, binary = _chunks(path, read_limited(path, MOST_BYTES))
    reduced = reduce_header(path, text, len(binary))
    pieces = read_by_library(path, _glb(reduced.header, binary), _pieces)
    if not pieces:
        raise FormatError(f"{path}: its scene holds no triangles; export it again")
    return pieces, reduced.remarks


def _chunks(path: Path, content: bytes) -> tuple[bytes, bytes]:
    """Return the JSON and the binary part."""
    if len(content) < 20 or struct.unpack_from("<I", content)[0] != _MAGIC:
        raise FormatError(f"{path}: is no GLB, it does not begin like one; export it again")
    version, length, json_bytes, kind = struct.unpack_from("<IIII", content, 4)
    if version != 2:
        raise FormatError(f"{path}: is GLB of version {version}, only 2 is read; export it again")
    if length > len(content) or 20 + json_bytes > len(content):
        raise FormatError(f"{path}: is cut short, {len(content):,} of {length:,} bytes are there; copy it again")
    if kind != _JSON or json_bytes > _MOST_JSON_BYTES:
        raise FormatError(f"{path}: does not begin with a header of fewer than {_MOST_JSON_BYTES:,} bytes")
    start = 20 + json_bytes
    if start + 8 > length:
        return content[20:start], b""
    binary_bytes, kind = struct.unpack_from("<II", content, start)
    if start + 8 + binary_bytes > len(content):
        raise FormatError(f"{path}: is cut short in its data; copy it again")
    return content[20:start], content[start + 8 : start + 8 + binary_bytes] if kind == _BINARY else b""


def _glb(header: dict[str, Any], binary: bytes) -> bytes:
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    length = 28 + len(text) + len(binary)
    return b"".join(
        [
            struct.pack("<IIIII", _MAGIC, 2, length, len(text), _JSON),
            text,
            struct.pack("<II", len(binary), _BINARY),
            binary,
        ]
    )


def _pieces(file: Any) -> list[Piece]:
    scene = trimesh.load_scene(file, file_type="glb", process=False, skip_materials=True)
    found = []
    for node in sorted(scene.graph.nodes_geometry):
        placement, name = scene.graph[node]
        found.append(_placed(scene.geometry[name], np.asarray(placement, np.float64)))
    return [piece for piece in found if len(piece.triangles)]


def _placed(part: trimesh.Trimesh, placement: F64) -> Piece:
    linear, stored = placement[:3, :3], part.vertex_attributes
    mirrored = np.linalg.det(linear) < 0
    triangles = triangle_table(part.faces)[:, :: -1 if mirrored else 1]
    normals = uvs = None
    if "_NORMAL" in stored:
        # Cofactors turn normals as the inverse transpose does, and do not mind a scale of 0; a mirror swaps their side.
        rows = [np.cross(linear[1], linear[2]), np.cross(linear[2], linear[0]), np.cross(linear[0], linear[1])]
        normals = table(_unscaled(stored["_NORMAL"]), 3) @ np.stack(rows).T * (-1 if mirrored else 1)
    if "_TEXCOORD_0" in stored:
        uvs = table(_unscaled(stored["_TEXCOORD_0"]), 2) * [1, -1] + [0, 1]  # v grows downwards in glTF
    return Piece(
        table(part.vertices, 3) @ linear.T + placement[:3, 3],
        triangles,
        uvs=uvs,
        uv_triangles=None if uvs is None else triangles,
        normals=normals,
        normal_triangles=None if normals is None else triangles,
    )


def _unscaled(stored: Any) -> NDArray[np.float64]:
    """Return what integers stand for: 0..1, or −1..1 if they are signed. Floats stay."""
    values = np.asarray(stored)
    if values.dtype.kind == "f":
        return values.astype(np.float64)
    scaled: NDArray[np.float64] = np.maximum(values.astype(np.float64) / np.iinfo(values.dtype).max, -1)
    return scaled
