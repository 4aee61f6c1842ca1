"""The shader that others paste into their own, compiled alone under a foreign `main`."""

import dataclasses
import re
from importlib.resources import files

import moderngl
import numpy as np
import pytest

from processing.matcap.model import Component, DecomposedMatcap
from processing.matcap.render import disc_picture
from processing.matcap.silhouette import Silhouette
from tests.processing.matcap.maps import analytic
from viewer.gl_context import open_context
from viewer.materials.decomposed_matcap import half

SIDE = 64
SNIPPET = files("viewer").joinpath("shaders", "litrig_matcap.glsl").read_text(encoding="utf-8")
VERTEX = """

out vec2 place;
void main() {
    place = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0;
    gl_Position = vec4(place, 0.0, 1.0);
}
"""
MAIN = """
uniform MatcapHalf low, high;
uniform sampler2D low_front, low_back, high_front, high_back, low_remainder, high_remainder;
in vec2 place;
out vec3 shown;
void main() {
    float rest = 1.0 - dot(place, place);
    if (rest <= 0.0) { shown = vec3(0.0); return; }
    vec3 n = vec3(place, sqrt(rest));
    shown = LOW + HIGH;
}
"""
CALLS = {
    "LOW": "matcap_light(low, low_front, low_back, low_remainder, n)",
    "HIGH": "matcap_light(high, high_front, high_back, high_remainder, n)",
}
PLAIN = analytic(64)
EDITED = dataclasses.replace(
    PLAIN,
    low=dataclasses.replace(
        PLAIN.low, silhouette=Silhouette(20, 0.7, 1.0), light_turn_deg=(10, 60, 5), normal_turn_deg=(0, 0, 40)
    ),
    high=dataclasses.replace(PLAIN.high, silhouette=Silhouette(50, -0.3, 0.0), light_turn_deg=(10, 60, 5)),
)


LACKING = dataclasses.replace(
    PLAIN,
    high=dataclasses.replace(
        PLAIN.high,
        remainder=np.random.default_rng(1).normal(0, 0.2, (24, 24, 3)).astype(np.float32),
        light_turn_deg=(0.3, 0.2, 30),
        normal_turn_deg=(0, 30, 0),
    ),
)


def drawn(head: str, matcap: DecomposedMatcap) -> np.ndarray:
    """Draw the ball by plain OpenGL: nothing of the renderer."""
    opened = open_context().moderngl
    with opened as context:
        maps: dict[str, Component] = {"low": matcap.low, "high": matcap.high}
        main = MAIN
        for name, component in maps.items():
            call = CALLS[name.upper()]
            main = main.replace(
                name.upper(), call if component.remainder is not None else call.replace(f" {name}_remainder,", "")
            )
        program = context.program(vertex_shader=head + VERTEX, fragment_shader=head + SNIPPET + main)
        kept: list[moderngl.Texture] = []
        for name, component in maps.items():
            for field, value in half(component).items():
                if field != "remainder_share" or component.remainder is not None:
                    program[f"{name}.{field}"] = value
            for side in ("front", "back", "remainder"):
                texels = getattr(component, side)
                if texels is None:
                    continue
                texels = np.ascontiguousarray(texels)
                texture = context.texture(texels.shape[:2], 3, texels.tobytes(), alignment=1, dtype="f4")
                texture.repeat_x = texture.repeat_y = False
                texture.use(len(kept))
                program[f"{name}_{side}"] = len(kept)
                kept.append(texture)
        target = context.framebuffer([context.texture((SIDE, SIDE), 3, dtype="f4")])
        target.use()
        context.vertex_array(program, []).render(moderngl.TRIANGLES, vertices=3)
        shown = np.frombuffer(target.read(components=3, alignment=1, dtype="f4"), np.float32)
    opened.release()
    return shown.reshape(SIDE, SIDE, 3)[::-1]


@pytest.mark.parametrize("head", ["#version 330 core\n", "#version 300 es\nprecision highp float;\n"], ids=["GL", "ES"])
@pytest.mark.parametrize("matcap", [PLAIN, EDITED, LACKING], ids=["plain", "edited", "with a remainder"])
def test_it_shows_what_litrig_shows(head: str, matcap: DecomposedMatcap) -> None:
    wanted = disc_picture(matcap, SIDE)
    assert wanted.std() > 0.1
    # OpenGL interpolates between texels in steps of 1/256.
    np.testing.assert_allclose(drawn(head, matcap), wanted, atol=0.006)


def test_it_needs_no_other_file() -> None:
    assert "#include" not in SNIPPET and "#version" not in SNIPPET
    assert not re.search(r"^\s*(uniform|in|out)\b", SNIPPET, re.MULTILINE)
