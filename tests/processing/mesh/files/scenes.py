"""GLB, PLY and STL files, written from the formats' descriptions."""

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
UVS = SQUARE[:, :2].copy()
HALVES = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
NORMALS = np.tile(np.array([0, 0, 1], np.float32), (4, 1))
_COMPONENT = {"f4": 5126, "u4": 5125, "u2": 5123, "u1": 5121, "i1": 5120, "i2": 5122}
_TYPE = {1: "SCALAR", 2: "VEC2", 3: "VEC3"}


def glb(header: dict[str, Any], binary: bytes) -> bytes:
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


def scene(
    *arrays: tuple[str, NDArray[Any]], normalized: bool = False, nodes: list[dict[str, Any]] | None = None
) -> tuple[dict[str, Any], bytes]:
    """A scene of one mesh: named arrays are its attributes, and `indices`. Returns what `glb` takes."""
    attributes: dict[str, int] = {}
    views, accessors, binary = [], [], b""
    primitive: dict[str, Any] = {"attributes": attributes}
    for name, array in arrays:
        flat = np.ascontiguousarray(array).reshape(-1, 1) if name == "indices" else np.ascontiguousarray(array)
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": flat.nbytes})
        accessor = {
            "bufferView": len(views) - 1,
            "componentType": _COMPONENT[flat.dtype.str[1:]],
            "count": len(flat),
            "type": _TYPE[flat.shape[1]],
        }
        if normalized and name != "indices" and flat.dtype.kind != "f":
            accessor["normalized"] = True
        accessors.append(accessor)
        (primitive if name == "indices" else attributes)[name] = len(accessors) - 1
        binary += flat.tobytes() + b"\0" * (-flat.nbytes % 4)
    nodes = nodes if nodes is not None else [{"mesh": 0}]
    hanging = {child for node in nodes for child in node.get("children", [])}
    header = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": len(binary)}],
        "bufferViews": views,
        "accessors": accessors,
        "meshes": [{"primitives": [primitive]}],
        "nodes": nodes,
        "scenes": [{"nodes": [number for number in range(len(nodes)) if number not in hanging]}],
        "scene": 0,
    }
    return header, binary


def square_scene(**options: Any) -> tuple[dict[str, Any], bytes]:
    flipped = UVS * [1, -1] + [0, 1]
    return scene(
        ("POSITION", SQUARE),
        ("NORMAL", NORMALS),
        ("TEXCOORD_0", flipped.astype(np.float32)),
        ("indices", HALVES),
        **options,
    )


def ply(folder: Path, *, ascii_: bool, names: tuple[str, str] | None = ("s", "t"), normals: bool = True) -> Path:
    """The square, its texture coordinates at its vertices."""
    columns = [SQUARE] + ([NORMALS] if normals else []) + ([UVS] if names else [])
    fields = [*"xyz", *(("nx", "ny", "nz") if normals else ()), *(names or ())]
    header = "\n".join(
        [
            "ply",
            f"format {'ascii' if ascii_ else 'binary_little_endian'} 1.0",
            "comment TextureFile ../../secret.png",
            "element vertex 4",
            *(f"property float {name}" for name in fields),
            "element face 2",
            "property list uchar int vertex_indices",
            "end_header\n",
        ]
    )
    table = np.concatenate(columns, axis=1)
    if ascii_:
        lines = [" ".join(f"{value:g}" for value in row) for row in table]
        body = "\n".join(lines + [f"3 {a} {b} {c}" for a, b, c in HALVES] + [""]).encode()
    else:
        body = table.astype("<f4").tobytes() + b"".join(struct.pack("<Biii", 3, *row.tolist()) for row in HALVES)
    path = folder / "x.ply"
    path.write_bytes(header.encode() + body)
    return path


def stl(*, ascii_: bool) -> bytes:
    corners = SQUARE[HALVES]
    if ascii_:
        facets = [
            "facet normal 0 0 1\nouter loop\n"
            + "".join(f"vertex {x:g} {y:g} {z:g}\n" for x, y, z in triangle)
            + "endloop\nendfacet\n"
            for triangle in corners
        ]
        return ("solid x\n" + "".join(facets) + "endsolid x\n").encode()
    rows = b"".join(struct.pack("<12fH", 0, 0, 1, *triangle.ravel().tolist(), 0) for triangle in corners)
    return b"\0" * 80 + struct.pack("<I", 2) + rows
