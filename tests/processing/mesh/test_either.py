"""A mesh by name or by file."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from litrig.base.errors import InputError
from processing.mesh.builtin import BUILTIN_NAMES, builtin_mesh
from processing.mesh.either import mesh_of
from tests.processing.mesh.files.scenes import glb, ply, square_scene, stl

OBJ = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"


@pytest.mark.parametrize("name", BUILTIN_NAMES)
def test_meshes_that_come_along_need_no_remark(name: str) -> None:
    mesh, remarks = mesh_of(name)
    assert remarks == ()
    np.testing.assert_array_equal(mesh.positions, builtin_mesh(name).positions)


@pytest.mark.parametrize("ending", ["obj", "OBJ", "glb", "stl"])
def test_files_are_read_by_their_ending(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"x.{ending}"
    path.write_bytes({"obj": OBJ, "glb": glb(*square_scene()), "stl": stl(ascii_=False)}[ending.lower()])
    mesh, remarks = mesh_of(path)
    assert mesh.occlusion is None
    assert all(remark.startswith(f"{path}: ") and "\n" not in remark for remark in remarks)
    assert len(remarks) == {"obj": 1, "glb": 0, "stl": 2}[ending.lower()]


def test_ply_is_read(tmp_path: Path) -> None:
    mesh, remarks = mesh_of(str(ply(tmp_path, ascii_=False)))
    assert remarks == () and len(mesh.triangles) == 2


@pytest.mark.parametrize("ending", ["obj", "ply", "glb", "stl"])
@pytest.mark.parametrize("what", ["nothing", "folder", "empty", "noise", "device"])
def test_what_cannot_be_read_is_one_line_that_names_it(tmp_path: Path, ending: str, what: str) -> None:
    path = tmp_path / f"x.{ending}"
    if what == "folder":
        path.mkdir()
    elif what == "device":
        path.symlink_to("/dev/zero")
    elif what != "nothing":
        path.write_bytes(b"" if what == "empty" else np.random.default_rng(3).bytes(5000))
    with pytest.raises(InputError) as caught:
        mesh_of(path)
    assert str(caught.value).startswith(f"{path}: ") and "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["teapot", "torus.fbx", "", "x" * 300, "a\0.b"])
def test_another_name_is_told_what_there_is(name: str) -> None:
    with pytest.raises(InputError, match=r"use one of torus, .*, or a file in \.obj, \.ply, \.glb, \.stl"):
        mesh_of(name)


def test_gltf_in_several_files_is_told_what_to_do() -> None:
    with pytest.raises(InputError, match="export it as GLB"):
        mesh_of("x.gltf")


def test_libraries_wait_until_a_file_is_named() -> None:
    script = "import sys, processing.mesh.either; print([m for m in ('trimesh', 'embreex') if m in sys.modules])"
    ran = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == "[]"
