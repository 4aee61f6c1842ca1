"""What cannot be drawn is one line that says what to do, and never a crash."""

import dataclasses
import os
import subprocess
import sys
from pathlib import Path

import moderngl
import numpy as np
import pytest

from litrig.base.errors import InputError
from processing.amc.files.ktx2 import write_amc
from processing.amc.files.meaning import Meaning
from processing.amc.low_rank import LowRankAmc
from processing.amc.model import Amc
from processing.mesh.builtin import torus
from processing.mesh.model import Mesh
from processing.ptm.model import Ptm
from tests.viewer.analytic import brushed_amc
from viewer.errors import GraphicsError
from viewer.flat_picture import flat_picture
from viewer.geometry import mesh_geometry
from viewer.gl_context import INSTALL
from viewer.materials.amc import AmcMaterial
from viewer.materials.low_rank import LowRankMaterial
from viewer.materials.ptm import PtmMaterial
from viewer.materials.ptm_shading import PtmShading
from viewer.renderer import Renderer
from viewer.targets import Target

GOOD = torus(8, 4)


def with_one(values: np.ndarray, value: float) -> np.ndarray:
    changed = values.copy()
    changed.reshape(-1)[7] = value
    return changed


BROKEN: dict[str, tuple[Mesh, str]] = {
    "no area": (dataclasses.replace(GOOD, positions=np.zeros_like(GOOD.positions)), "none of its 64 triangles has an"),
    "flat on a line": (
        dataclasses.replace(GOOD, positions=GOOD.positions * np.array([1, 0, 0], np.float32)),
        "none of its 64 triangles has an area",
    ),
    "no triangle": (dataclasses.replace(GOOD, triangles=np.zeros((0, 3), np.int32)), "none of its 0 triangles has an"),
    "no vertex": (
        Mesh(
            positions=np.zeros((0, 3), np.float32),
            normals=np.zeros((0, 3), np.float32),
            tangents=np.zeros((0, 3), np.float32),
            uvs=np.zeros((0, 2), np.float32),
            triangles=np.zeros((0, 3), np.int32),
        ),
        "none of its 0 triangles has an area",
    ),
    "NaN": (dataclasses.replace(GOOD, positions=with_one(GOOD.positions, np.nan)), "positions of 1 of 45 vertices are"),
    "infinite": (dataclasses.replace(GOOD, uvs=with_one(GOOD.uvs, np.inf)), "uvs of 1 of 45 vertices are no numbers"),
    "no normals": (dataclasses.replace(GOOD, normals=np.zeros_like(GOOD.normals)), "normals of 45 of 45 vertices have"),
    "no tangents": (
        dataclasses.replace(GOOD, tangents=np.zeros_like(GOOD.tangents)),
        "tangents of 45 of 45 vertices have no length",
    ),
    "vertices that are not there": (
        dataclasses.replace(GOOD, triangles=GOOD.triangles + np.int32(1 << 30)),
        "vertices that are not among its 45",
    ),
    "vertices below the first": (
        dataclasses.replace(GOOD, triangles=GOOD.triangles - np.int32(1)),
        "vertices that are not among its 45",
    ),
    "too few normals": (dataclasses.replace(GOOD, normals=GOOD.normals[:-1]), "44 normals for 45 positions"),
    "occlusion of another mesh": (
        dataclasses.replace(GOOD, occlusion=np.ones(9, np.float32)),
        "9 occlusion for 45 positions",
    ),
    "occlusion that is none": (
        dataclasses.replace(GOOD, occlusion=np.full(45, np.nan, np.float32)),
        "occlusion of 45 of 45 vertices are no numbers",
    ),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_mesh_is_refused(renderer: Renderer, name: str) -> None:
    mesh, reason = BROKEN[name]
    with pytest.raises(InputError, match=f"mesh: .*{reason}") as caught, renderer.upload(mesh_geometry, mesh):
        pass
    assert "\n" not in str(caught.value)


def test_a_table_that_the_driver_does_not_take_is_refused(renderer: Renderer) -> None:
    deep = Amc(np.zeros((2049, 2, 2, 3), np.float32), np.ones((2049, 2, 2), bool), 1)
    reason = r"AMC: 2 × 2 × 2049 texels, but this graphics driver ends at \d+; shrink it"
    with pytest.raises(InputError, match=reason), renderer.upload(AmcMaterial, deep):
        pass


@pytest.mark.parametrize(
    ("rank", "depth"), [pytest.param(1, 20_000, id="slices"), pytest.param(3000, 3000, id="pictures")]
)
def test_a_low_rank_table_that_the_driver_does_not_take_is_refused(renderer: Renderer, rank: int, depth: int) -> None:
    meaning = Meaning.of(brushed_amc(2, 1, "isotropic"))
    table = LowRankAmc(
        np.zeros((rank, 2, 2, 3), np.float32), np.zeros((depth, rank), np.float32), np.ones((2, 2), bool), meaning
    )
    reason = r"AMC: .* but this graphics driver ends at \d+ texels and \d+ pictures; shrink it"
    with pytest.raises(InputError, match=reason), renderer.upload(LowRankMaterial, table):
        pass


def test_a_ptm_wider_than_the_driver_takes_is_refused_and_a_higher_one_is_drawn(renderer: Renderer) -> None:
    coefficients = np.full((6, 1, 20_000, 3), 0.1, np.float32)
    with pytest.raises(InputError, match=r"PTM: 20000 × 1 texels, but .* cut or shrink it"):
        flat_picture(renderer, Ptm(coefficients, None), PtmShading())
    high = Ptm(coefficients.transpose(0, 2, 1, 3), None)
    with pytest.raises(InputError, match="PTM: 1 × 20000 texels"), renderer.upload(PtmMaterial, high):
        pass


@pytest.mark.parametrize("part", ["texture", "depth_renderbuffer", "framebuffer"])
def test_a_driver_without_room_is_one_line(renderer: Renderer, monkeypatch: pytest.MonkeyPatch, part: str) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise moderngl.Error("out of memory")

    monkeypatch.setattr(f"moderngl.Context.{part}", refuse)
    with (
        pytest.raises(GraphicsError, match=r"no room for 32 × 24 pixels \(out of memory\); ask for a smaller picture"),
        renderer.upload(Target, (16, 12), 2),
    ):
        pass


def test_so_is_a_driver_without_room_for_a_material(renderer: Renderer, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise moderngl.Error("cannot create texture")

    monkeypatch.setattr("moderngl.Context.texture3d", refuse)
    with (
        pytest.raises(GraphicsError, match=r"upload: .* \(cannot create texture\); ask for less"),
        renderer.upload(AmcMaterial, brushed_amc(4, 2)),
    ):
        pass


@pytest.mark.parametrize(
    "setting",
    [
        pytest.param({"GLCONTEXT_LINUX_LIBGL": "libnowhere.so.9"}, id="no libGL"),
        pytest.param({"MESA_GL_VERSION_OVERRIDE": "2.1"}, id="a driver of OpenGL 2.1"),
    ],
)
def test_without_a_fit_opengl_the_command_says_what_to_install(tmp_path: Path, setting: dict[str, str]) -> None:
    """The real loader and the real driver, the latter told to be an old one."""
    write_amc(tmp_path / "x.amc.ktx2", brushed_amc(8, 4))
    environment = {**os.environ, **setting, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    command = [sys.executable, "-m", "litrig", "render", "x.amc.ktx2", "-o", "x.png"]
    ran = subprocess.run(command, env=environment, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert ran.returncode == 1
    assert ran.stderr.count("\n") == 1
    assert INSTALL in ran.stderr
    assert not (tmp_path / "x.png").exists()
