"""Things are uploaded once and drawn as often as wanted; drawing and reading are two steps."""

import ctypes

import numpy as np
import pytest

from processing.mesh.builtin import torus
from tests.viewer.analytic import brushed_amc
from viewer.errors import GraphicsError
from viewer.geometry import mesh_geometry
from viewer.gl_context import GlContext, open_context
from viewer.look import Look
from viewer.materials.amc import AmcMaterial, amc_picture
from viewer.renderer import Renderer
from viewer.targets import Target
from viewer.view import View

SIZE = (48, 40)
AMC, MESH = brushed_amc(16, 8), torus(24, 12)


def test_one_upload_serves_many_views(renderer: Renderer) -> None:
    views = [View(yaw_deg=yaw, pitch_deg=20) for yaw in (0, 50, 100)]
    with (
        renderer.upload(AmcMaterial, AMC) as material,
        renderer.upload(mesh_geometry, MESH) as geometry,
        renderer.upload(Target, SIZE) as target,
    ):
        for view in [*views, views[0]]:
            renderer.draw(material.look(), geometry, target, view)
            np.testing.assert_array_equal(target.read(), amc_picture(renderer, AMC, MESH, view, size=SIZE))


def test_drawing_again_uploads_nothing(renderer: Renderer, monkeypatch: pytest.MonkeyPatch) -> None:
    with (
        renderer.upload(AmcMaterial, AMC) as material,
        renderer.upload(mesh_geometry, MESH) as geometry,
        renderer.upload(Target, SIZE) as target,
    ):
        renderer.draw(material.look(), geometry, target, View())
        first = target.read()

        def refused(*_: object, **__: object) -> None:
            raise AssertionError("an upload")

        for name in ("buffer", "texture", "texture3d", "texture_array", "framebuffer", "program", "vertex_array"):
            monkeypatch.setattr(f"moderngl.Context.{name}", refused)
        renderer.draw(material.look(level=1), geometry, target, View(yaw_deg=40))
        renderer.draw(material.look(), geometry, target, View())
        np.testing.assert_array_equal(target.read(), first)


def test_what_is_drawn_without_clearing_stands_in_front_or_behind(renderer: Renderer) -> None:
    with (
        renderer.upload(AmcMaterial, AMC) as material,
        renderer.upload(mesh_geometry, MESH) as geometry,
        renderer.upload(mesh_geometry, torus(6, 3)) as coarse,
        renderer.upload(Target, SIZE) as target,
    ):
        look, view = material.look(), View(pitch_deg=40)
        renderer.draw(look, coarse, target, view)
        coverage = target.read()[..., 3]
        renderer.draw(look, geometry, target, view, clear=False)
        both = target.read()
        renderer.draw(look, geometry, target, view)
        alone = target.read()
    np.testing.assert_array_equal(both[..., 3], np.maximum(coverage, alone[..., 3]))
    assert 0 < np.count_nonzero((both == alone).all(axis=-1) & (alone[..., 3] > 0)) < np.count_nonzero(alone[..., 3])


def test_the_picture_lies_in_a_texture_for_who_shows_it(renderer: Renderer) -> None:
    with (
        renderer.upload(AmcMaterial, AMC) as material,
        renderer.upload(mesh_geometry, MESH) as geometry,
        renderer.upload(Target, SIZE, 2) as target,
    ):
        renderer.draw(material.look(), geometry, target, View())
        assert target.colour.size == target.drawn_size == (96, 80)
        assert target.read().shape == (40, 48, 4)


def test_an_error_of_the_driver_fails_the_draw() -> None:
    opened: list[GlContext] = []

    def keep() -> GlContext:
        opened.append(open_context())
        return opened[0]

    with (
        Renderer(keep) as renderer,
        renderer.upload(AmcMaterial, AMC) as material,
        renderer.upload(mesh_geometry, MESH) as geometry,
        renderer.upload(Target, SIZE) as target,
    ):
        with opened[0].moderngl:
            ctypes.CFUNCTYPE(None, ctypes.c_uint)(opened[0].backend.load("glEnable"))(0xFFFF)
        with pytest.raises(GraphicsError, match="GL_INVALID_ENUM"):
            renderer.draw(material.look(), geometry, target, View())
        renderer.draw(material.look(), geometry, target, View())


def test_what_was_uploaded_is_let_go_at_the_end_and_after_an_error(renderer: Renderer) -> None:
    class Part:
        released = 0

        def __init__(self, _gl: GlContext) -> None:
            pass

        def release(self) -> None:
            self.released += 1

    with renderer.upload(Part) as part:
        assert part.released == 0
    with pytest.raises(ZeroDivisionError), renderer.upload(Part) as other:
        _ = 1 / 0
    assert (part.released, other.released) == (1, 1)


def test_a_name_that_the_shader_does_not_use_is_an_error(renderer: Renderer) -> None:
    """A misspelt uniform would else be a picture that is quietly wrong."""
    with (
        renderer.upload(AmcMaterial, AMC) as material,
        renderer.upload(mesh_geometry, MESH) as geometry,
        renderer.upload(Target, SIZE) as target,
        pytest.raises(KeyError),
    ):
        look = material.look()
        misspelt = Look(look.fragment, {**look.uniforms, "repeat": 2.0}, look.textures)
        renderer.draw(misspelt, geometry, target, View())
