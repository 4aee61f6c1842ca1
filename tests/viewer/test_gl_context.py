"""Opening OpenGL, and what a newcomer reads when it is not there."""

import ctypes
import os
import subprocess
import sys
from typing import Any

import moderngl
import numpy as np
import pytest

from litrig.base.errors import MissingToolError
from processing.mesh.builtin import torus
from tests.viewer.analytic import brushed_amc
from viewer.errors import GraphicsError
from viewer.gl_calls import upload_levels
from viewer.gl_context import INSTALL, open_context
from viewer.materials.amc import amc_picture
from viewer.renderer import Renderer
from viewer.shader_source import shader_source
from viewer.targets import check_errors
from viewer.view import View


def test_a_context_needs_no_display(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with Renderer() as renderer:
        assert amc_picture(renderer, brushed_amc(8, 4), torus(12, 8), View(), size=(16, 16))[..., 3].any()


@pytest.mark.parametrize(
    "reason",
    [
        "libGL.so not loaded",
        "libEGL.so not loaded",
        "libGL.so not found in /lib, /usr/lib or LD_LIBRARY_PATH",
        "eglCreateContext failed (0x3009)",
        "eglGetDisplay failed (0x3008)",
    ],
)
def test_every_failure_of_the_loader_ends_in_the_line_that_installs_it(reason: str) -> None:
    def broken_loader() -> Any:
        raise Exception(reason)  # noqa: TRY002 # as the loader does

    with pytest.raises(MissingToolError) as caught:
        open_context(broken_loader)
    message = str(caught.value)
    assert reason in message
    assert "apt-get install -y --no-install-recommends libegl1 libgl1" in message
    assert "\n" not in message


@pytest.mark.parametrize("variable", ["GLCONTEXT_LINUX_LIBGL", "GLCONTEXT_LINUX_LIBEGL"])
def test_a_machine_without_the_library_gets_one_line(variable: str) -> None:
    """The real loader, told to look for a library that is not there."""
    script = (
        "from litrig.base.errors import LitrigError\n"
        "from viewer.renderer import Renderer\n"
        "try:\n    Renderer()\n"
        "except LitrigError as error:\n    print(f'{type(error).__name__}: {error}')\n"
    )
    environment = {**os.environ, variable: "libnowhere.so.9", "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    ran = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=False)
    assert ran.stderr == ""
    assert ran.stdout.startswith("MissingToolError: OpenGL: ")
    assert ran.stdout.rstrip().endswith(INSTALL)


def test_an_error_of_the_driver_is_an_error() -> None:
    gl = open_context()
    with gl.moderngl:
        ctypes.CFUNCTYPE(None, ctypes.c_uint)(gl.backend.load("glEnable"))(0xFFFF)
        with pytest.raises(GraphicsError, match="picture: the graphics driver reports GL_INVALID_ENUM"):
            check_errors(gl.moderngl, "picture")
        check_errors(gl.moderngl, "picture")
    gl.moderngl.release()


def test_uploading_leaves_bindings_as_they_were() -> None:
    gl = open_context()
    with gl.moderngl as context:
        other = context.texture3d((2, 2, 2), 4, dtype="f2")
        get = ctypes.CFUNCTYPE(None, ctypes.c_uint, ctypes.c_void_p)(gl.backend.load("glGetIntegerv"))
        bind = ctypes.CFUNCTYPE(None, ctypes.c_uint, ctypes.c_uint)(gl.backend.load("glBindTexture"))
        texture = context.texture3d((4, 4, 4), 4, dtype="f2")
        bind(0x806F, other.glo)
        upload_levels(gl.backend, texture, [np.ones((4, 4, 4, 4), np.float16), np.ones((2, 2, 2, 4), np.float16)])
        found = ctypes.c_int()
        get(0x806A, ctypes.addressof(found))
        assert found.value == other.glo
        assert context.error == "GL_NO_ERROR"
        assert np.frombuffer(texture.read(), np.float16).min() == 1
    gl.moderngl.release()


def test_a_renderer_can_be_closed_twice() -> None:
    renderer = Renderer()
    renderer.close()
    renderer.close()


@pytest.mark.parametrize("name", ["amc.frag", "ptm_flat.frag", "ptm_mesh.frag", "mesh.vert", "flat.vert"])
def test_shaders_are_whole_after_their_includes(name: str) -> None:
    source = shader_source(name)
    assert source.startswith("#version 330")
    assert "#include" not in source
    assert source.count("void main()") == 1


def test_moderngl_is_asked_for_the_version_that_the_shaders_name() -> None:
    gl = open_context()
    assert isinstance(gl.moderngl, moderngl.Context)
    assert gl.moderngl.version_code >= 330
    gl.moderngl.release()
