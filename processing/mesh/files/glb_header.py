"""The JSON of a GLB file, reduced to what a mesh needs, and checked before anything is allocated by its numbers.

What is left names one buffer, the one in the file itself, so that no other file is ever opened.
"""

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from litrig.base.errors import FormatError
from processing.mesh.files.glb_nodes import as_index, flat_nodes
from processing.mesh.files.pieces import MOST_TRIANGLES

Json = dict[str, Any]

MOST_PARTS = 20_000
_TRIANGLES, _STRIP = 4, 5
_COMPONENT_BYTES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
_FLOAT = 5126
_COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}
_KINDS = {"POSITION": "VEC3", "NORMAL": "VEC3", "TEXCOORD_0": "VEC2"}
_COMPRESSED = ("draco", "meshopt", "instancing")


@dataclass
class Reduced:
    """A header with geometry alone.

    Attributes
    ----------
    header : its attributes NORMAL and TEXCOORD_0 are renamed to _NORMAL and _TEXCOORD_0, so that readers hand them over
        as they are stored
    remarks : what is left out of the picture
    """

    header: Json
    remarks: list[str] = field(default_factory=list)


def reduce_header(path: Path, text: bytes, binary_bytes: int) -> Reduced:
    """Check the JSON and keep the geometry of its scene.

    Parameters
    ----------
    binary_bytes : length of the file's binary part

    Raises
    ------
    FormatError
        It is no JSON, contradicts itself or the file's length, wants other files, or more than the limits.
    """
    try:
        header = json.loads(text)
        reduced = _Reduction(path, header, binary_bytes).run()
    except FormatError:
        raise
    # Any value may be of any type, and any index wrong.
    except (ValueError, KeyError, IndexError, TypeError, AttributeError, OverflowError, RecursionError) as error:
        raise FormatError(
            f"{path}: its header is damaged ({type(error).__name__}: {error}); export it again"
        ) from error
    return reduced


class _Reduction:
    def __init__(self, path: Path, header: Json, binary_bytes: int) -> None:
        self._path = path
        self._old = header
        self._binary_bytes = binary_bytes
        self._accessors: list[Json] = []
        self._renamed: dict[int, int] = {}
        self._triangles: list[int] = []
        self._parts: list[int] = []
        self._skipped = 0
        self._elsewhere: set[int] = set()

    def run(self) -> Reduced:
        for name in self._old.get("extensionsRequired", []):
            if any(word in str(name).lower() for word in _COMPRESSED):
                raise FormatError(f"{self._path}: needs {str(name)[:60]!r}; export it without compression")
        meshes = [self._mesh(mesh) for mesh in self._old.get("meshes", [])]
        scene = self._old.get("scenes", [{}])[as_index(self._old.get("scene", 0))]
        nodes = self._nodes(scene.get("nodes", []))
        header = {
            "asset": {"version": "2.0"},
            "buffers": [{"byteLength": self._binary_bytes}],
            "bufferViews": [self._view(number) for number in range(len(self._old.get("bufferViews", [])))],
            "accessors": self._accessors,
            "meshes": meshes,
            "nodes": nodes,
            "scenes": [{"nodes": list(range(len(nodes)))}],
            "scene": 0,
        }
        reduced = Reduced(header)
        if self._skipped:
            reduced.remarks.append(f"{self._skipped} of its parts are points, lines or fans, and are left out")
        if any("skin" in node for node in self._old.get("nodes", [])):
            reduced.remarks.append("its figure has bones; it is shown in the pose in which they were put in")
        return reduced

    def _mesh(self, mesh: Json) -> Json:
        kept, triangles = [], 0
        for primitive in mesh["primitives"]:
            mode = primitive.get("mode", _TRIANGLES)
            if mode not in (_TRIANGLES, _STRIP):
                self._skipped += 1
                continue
            attributes = primitive["attributes"]
            new: Json = {
                "mode": mode,
                "attributes": {
                    (name if name == "POSITION" else f"_{name}"): self._accessor(attributes[name], kind)
                    for name, kind in _KINDS.items()
                    if name in attributes
                },
            }
            corners = self._old["accessors"][as_index(attributes["POSITION"])]["count"]
            if "indices" in primitive:
                new["indices"] = self._accessor(primitive["indices"], "SCALAR")
                corners = self._old["accessors"][as_index(primitive["indices"])]["count"]
            triangles += corners // 3 if mode == _TRIANGLES else max(0, corners - 2)
            kept.append(new)
        self._triangles.append(triangles)
        self._parts.append(len(kept))
        return {"primitives": kept}

    def _accessor(self, number: int, kind: str) -> int:
        """Check a table of numbers, and return the number that it has in what is kept."""
        number = as_index(number)
        if number in self._renamed:
            return self._renamed[number]
        old = self._old["accessors"][number]
        component, count = old["componentType"], as_index(old["count"])
        if "sparse" in old or "bufferView" not in old:
            raise FormatError(
                f"{self._path}: its accessor {number} is sparse or compressed, which is not read; export it plainly"
            )
        if old["type"] != kind or component not in _COMPONENT_BYTES or (kind == "SCALAR" and component == _FLOAT):
            raise FormatError(f"{self._path}: its accessor {number} is no {kind} of this use; export it again")
        view = self._view(as_index(old["bufferView"]))
        row_bytes = _COMPONENTS[kind] * _COMPONENT_BYTES[component]
        if old["bufferView"] in self._elsewhere:
            raise FormatError(f"{self._path}: keeps its geometry in another file, which is not read; export it as one")
        start, stride = as_index(old.get("byteOffset", 0)), view.get("byteStride", row_bytes)
        needed = start + (count - 1) * stride + row_bytes if count else 0
        if needed > view["byteLength"] or stride < row_bytes:
            raise FormatError(
                f"{self._path}: its accessor {number} claims {count:,} rows, beyond the file's end; copy it again"
            )
        kept = {key: old[key] for key in ("bufferView", "componentType", "count", "type")}
        self._accessors.append({**kept, "byteOffset": start})
        self._renamed[number] = len(self._accessors) - 1
        return self._renamed[number]

    def _view(self, number: int) -> Json:
        old = self._old["bufferViews"][number]
        start, length = as_index(old.get("byteOffset", 0)), as_index(old["byteLength"])
        buffer = self._old["buffers"][as_index(old["buffer"])]
        if old["buffer"] != 0 or "uri" in buffer:
            self._elsewhere.add(number)  # pictures may be, for they are not looked at
            return {"buffer": 0, "byteOffset": 0, "byteLength": 0}
        if start + length > self._binary_bytes:
            raise FormatError(
                f"{self._path}: wants {start + length:,} of {self._binary_bytes:,} bytes of its data; copy it again"
            )
        view = {"buffer": 0, "byteOffset": start, "byteLength": length}
        return {**view, "byteStride": as_index(old["byteStride"])} if "byteStride" in old else view

    def _nodes(self, roots: list[int]) -> list[Json]:
        nodes = flat_nodes(self._path, self._old.get("nodes", []), roots)
        parts = max(sum(self._parts), sum(self._parts[node["mesh"]] for node in nodes))
        if parts > MOST_PARTS:
            raise FormatError(f"{self._path}: has {parts:,} parts, {MOST_PARTS:,} are the most; join them")
        total = sum(self._triangles[node["mesh"]] for node in nodes)
        if total > MOST_TRIANGLES:
            raise FormatError(f"{self._path}: has {total:,} triangles, {MOST_TRIANGLES:,} are the most; reduce it")
        return nodes
