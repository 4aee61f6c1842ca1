"""GLB scenes: placed by their nodes, and nothing believed that their JSON says."""

import copy
import json
import struct
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from litrig.base.errors import FormatError, InputError
from processing.mesh.either import mesh_of
from processing.mesh.files.glb import read_glb
from tests.processing.mesh.files.scenes import HALVES, NORMALS, SQUARE, UVS, glb, scene, square_scene

Header = dict[str, Any]


def written(folder: Path, header: Header, binary: bytes) -> Path:
    path = folder / "x.glb"
    path.write_bytes(glb(header, binary))
    return path


def test_a_square_comes_as_it_went(tmp_path: Path) -> None:
    (piece,), remarks = read_glb(written(tmp_path, *square_scene()))
    assert remarks == []
    np.testing.assert_array_equal(piece.positions, SQUARE)
    np.testing.assert_array_equal(piece.triangles, HALVES)
    np.testing.assert_array_equal(piece.normals, NORMALS)
    assert piece.uvs is not None
    np.testing.assert_allclose(piece.uvs, UVS, err_msg="v grows upwards here, downwards there")


@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
def test_coordinates_may_be_integers(tmp_path: Path, kind: type[np.unsignedinteger[Any]]) -> None:
    stored = (UVS * [1, -1] + [0, 1]) * np.iinfo(kind).max
    arrays = ("POSITION", SQUARE), ("TEXCOORD_0", stored.astype(kind)), ("indices", HALVES.astype(np.uint16))
    (piece,), _ = read_glb(written(tmp_path, *scene(*arrays, normalized=True)))
    assert piece.uvs is not None
    np.testing.assert_allclose(piece.uvs, UVS, atol=1e-12)


def test_nodes_place_their_mesh_one_inside_the_other(tmp_path: Path) -> None:
    nodes = [
        {"translation": [10, 0, 0], "children": [1]},
        {"mesh": 0, "scale": [2, 2, 2], "rotation": [0, 0, 0.5**0.5, 0.5**0.5]},
        {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 7, 1]},
    ]
    pieces, _ = read_glb(written(tmp_path, *square_scene(nodes=nodes)))
    turned, moved = sorted(pieces, key=lambda piece: -piece.positions[:, 0].max())
    np.testing.assert_allclose(turned.positions, [[10, 0, 0], [10, 2, 0], [8, 2, 0], [8, 0, 0]], atol=1e-12)
    np.testing.assert_allclose(moved.positions, SQUARE + np.array([0, 0, 7]))


def test_a_deep_tree_is_no_harder_than_a_flat_one(tmp_path: Path) -> None:
    nodes: list[Header] = [{"children": [number + 1], "translation": [0, 1, 0]} for number in range(3000)]
    (piece,), _ = read_glb(written(tmp_path, *square_scene(nodes=[*nodes, {"mesh": 0}])))
    np.testing.assert_allclose(piece.positions, SQUARE + np.array([0, 3000, 0]))


def test_a_mirrored_node_keeps_its_outside_outside(tmp_path: Path) -> None:
    """And a scale turns normals the other way round than points."""
    leaning = np.tile(np.array([0.6, 0, 0.8], np.float32), (4, 1))
    arrays = ("POSITION", SQUARE), ("NORMAL", leaning), ("indices", HALVES)
    (piece,), _ = read_glb(written(tmp_path, *scene(*arrays, nodes=[{"mesh": 0, "scale": [-2, 1, 1]}])))
    assert piece.normals is not None
    np.testing.assert_allclose(
        piece.normals[0] / np.linalg.norm(piece.normals[0]), np.array([-0.3, 0, 0.8]) / 0.73**0.5, atol=1e-6
    )
    corners = piece.positions[piece.triangles]
    assert np.all(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] > 0)


def test_strips_are_triangles_and_lines_are_left_out_and_said(tmp_path: Path) -> None:
    header, binary = scene(("POSITION", SQUARE), ("indices", np.array([0, 1, 3, 2], np.uint16)))
    header["meshes"][0]["primitives"][0]["mode"] = 5
    header["meshes"][0]["primitives"].append({"attributes": {"POSITION": 0}, "mode": 1})
    header["nodes"][0]["skin"] = 0
    pieces, remarks = read_glb(written(tmp_path, header, binary))
    assert sum(len(piece.triangles) for piece in pieces) == 2
    assert len(remarks) == 2 and "lines" in remarks[0] and "bones" in remarks[1]
    assert mesh_of(tmp_path / "x.glb")[1][0].startswith(f"{tmp_path}/x.glb: 1 of its parts")


def test_no_other_file_is_opened(tmp_path: Path) -> None:
    """Neither for geometry, which is refused, nor for pictures, which are not wanted."""
    (tmp_path / "secret.bin").write_bytes(b"\0" * 1000)
    header, binary = square_scene()
    header["images"] = [{"uri": "secret.bin"}, {"uri": "../../etc/passwd"}, {"uri": "http://example.invalid/x.png"}]
    header["textures"] = [{"source": 0}]
    header["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]
    header["meshes"][0]["primitives"][0]["material"] = 0
    path = written(tmp_path, header, binary)
    with watched() as opened:
        assert read_glb(path)
    assert opened == {str(path)}
    header["buffers"][0]["uri"] = "secret.bin"
    path = written(tmp_path, header, binary)
    with watched() as opened, pytest.raises(FormatError, match="keeps its geometry in another file"):
        read_glb(path)
    assert opened == {str(path)}


_watching: list[set[str]] = []


def _note(event: str, arguments: tuple[Any, ...]) -> None:
    if _watching and event in ("open", "socket.connect", "urllib.Request"):
        _watching[-1].add(str(arguments[0]))


@contextmanager
def watched() -> Iterator[set[str]]:
    """Collect what Python opens meanwhile."""
    if not getattr(watched, "hooked", False):
        sys.addaudithook(_note)
        watched.hooked = True  # type: ignore[attr-defined]
    _watching.append(set())
    try:
        yield _watching[-1]
    finally:
        _watching.pop()


def change(*steps: str | int, to: Any) -> Callable[[Header], None]:
    def apply(header: Header) -> None:
        place: Any = header
        for step in steps[:-1]:
            place = place[step]
        place[steps[-1]] = to

    return apply


@pytest.mark.parametrize(
    ("harm", "reason"),
    [
        pytest.param(change("accessors", 0, "count", to=750_000_000_000), "claims 750,000,000,000 rows", id="9 TB"),
        pytest.param(change("bufferViews", 0, "byteLength", to=9 << 40), "bytes of its data; copy", id="9 TB of data"),
        pytest.param(
            lambda header: header["accessors"][0].pop("bufferView"), "sparse or compressed", id="rows out of nothing"
        ),
        pytest.param(change("accessors", 0, "sparse", to={"count": 1}), "sparse or compressed", id="sparse"),
        pytest.param(change("accessors", 0, "count", to=-1), "its header is damaged", id="a negative count"),
        pytest.param(change("accessors", 0, "count", to=1e99), "its header is damaged", id="a count with a point"),
        pytest.param(change("accessors", 0, "type", to="MAT4"), "is no VEC3", id="another type"),
        pytest.param(change("accessors", 3, "componentType", to=5126), "is no SCALAR", id="indices with a point"),
        pytest.param(change("bufferViews", 0, "byteStride", to=0), "claims 4 rows", id="no stride"),
        pytest.param(change("scene", to=7), "its header is damaged", id="no such scene"),
        pytest.param(change("nodes", 0, "mesh", to=7), "its header is damaged", id="no such mesh"),
        pytest.param(change("nodes", 0, "children", to=[0]), "are no tree", id="a node in itself"),
        pytest.param(change("nodes", 0, "children", to=[7]), "not among its 1", id="no such node"),
        pytest.param(change("nodes", 0, "matrix", to=[1, 2]), "its header is damaged", id="half a matrix"),
        pytest.param(
            lambda header: header["meshes"].__setitem__(0, {"primitives": header["meshes"][0]["primitives"] * 20_001}),
            "20,001 parts",
            id="many parts",
        ),
        pytest.param(
            change("nodes", 0, "rotation", to=[0, 0, 0, 0]), "its header is damaged", id="a turn about nothing"
        ),
        pytest.param(change("nodes", 0, "scale", to=[1, 1, 1e999]), "its header is damaged", id="an endless scale"),
        pytest.param(change("nodes", to=[{"mesh": 0}] * 20_001), "20,001 nodes", id="many nodes"),
        pytest.param(change("scenes", 0, "nodes", to=[]), "holds no triangles", id="an empty scene"),
        pytest.param(change("meshes", to=[]), "its header is damaged", id="no meshes"),
        pytest.param(change("meshes", to=7), "its header is damaged", id="meshes as a number"),
        pytest.param(change("extensionsRequired", to=["KHR_draco_mesh_compression"]), "without comp", id="Draco"),
        pytest.param(
            lambda header: header["meshes"][0]["primitives"][0]["attributes"].pop("POSITION"), "damaged", id="nowhere"
        ),
    ],
)
def test_a_header_that_lies_is_one_clear_error(tmp_path: Path, harm: Callable[[Header], Any], reason: str) -> None:
    header, binary = square_scene()
    header = copy.deepcopy(header)
    harm(header)
    with pytest.raises(FormatError, match=reason) as caught:
        read_glb(written(tmp_path, header, binary))
    assert str(caught.value).startswith(f"{tmp_path}/x.glb: ") and "\n" not in str(caught.value)


def test_one_mesh_in_many_places_is_counted_before_it_is_made(tmp_path: Path) -> None:
    triangles = np.zeros((4000, 3), np.uint32)
    header, binary = scene(("POSITION", SQUARE), ("indices", triangles), nodes=[{"mesh": 0}] * 2000)
    with pytest.raises(FormatError, match="has 8,000,000 triangles"):
        read_glb(written(tmp_path, header, binary))


def test_indices_that_point_nowhere_are_refused(tmp_path: Path) -> None:
    written(tmp_path, *scene(("POSITION", SQUARE), ("indices", HALVES + 2)))
    with pytest.raises(FormatError, match="a triangle names positions that are not among its 4"):
        mesh_of(tmp_path / "x.glb")


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        pytest.param(b"", "is no GLB", id="empty"),
        pytest.param(b"{}" * 40, "is no GLB", id="JSON"),
        pytest.param(struct.pack("<IIIII", 0x46546C67, 1, 20, 0, 0), "of version 1", id="version 1"),
        pytest.param(glb({"asset": {}}, b"")[:-10], "cut short", id="cut"),
        pytest.param(struct.pack("<IIIII", 0x46546C67, 2, 20, 2**32 - 1, 0x4E4F534A), "cut short", id="a long header"),
        pytest.param(glb({}, b"").replace(b"{}", b"[["), "its header is damaged", id="no JSON"),
        pytest.param(glb({}, b"").replace(b"{}", b"[]"), "its header is damaged", id="a list"),
    ],
)
def test_what_is_no_glb_is_one_clear_error(tmp_path: Path, content: bytes, reason: str) -> None:
    (tmp_path / "x.glb").write_bytes(content)
    with pytest.raises(FormatError, match=reason):
        read_glb(tmp_path / "x.glb")


def test_deeply_nested_json_is_an_error(tmp_path: Path) -> None:
    text = b"[" * 200_000
    head = struct.pack("<IIIII", 0x46546C67, 2, 20 + len(text), len(text), 0x4E4F534A)
    (tmp_path / "x.glb").write_bytes(head + text)
    with pytest.raises(FormatError, match="its header is damaged"):
        read_glb(tmp_path / "x.glb")


@given(
    place=st.integers(0, 10_000),
    value=st.sampled_from([0, 1, -1, 3, 2**31, 2**63, 1e300, "x", None, [], {}, [[]], True]),
)
def test_any_value_may_be_wrong(tmp_path_factory: pytest.TempPathFactory, place: int, value: Any) -> None:
    header, binary = square_scene(nodes=[{"mesh": 0, "translation": [1, 2, 3], "children": [1]}, {"mesh": 0}])
    header = json.loads(json.dumps(header))
    spots = list(places(header))
    spot, key = spots[place % len(spots)]
    spot[key] = value
    try:
        mesh_of(written(tmp_path_factory.getbasetemp(), header, binary))
    except InputError as error:
        assert "\n" not in str(error)


def places(value: Any) -> Any:
    """Every spot of a JSON value."""
    for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
        yield value, key
        if isinstance(inner, dict | list):
            yield from places(inner)
