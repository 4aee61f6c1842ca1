"""One renderer for the pictures of a module: opening OpenGL takes longer than drawing."""

from collections.abc import Iterator

import pytest

from viewer.renderer import Renderer


@pytest.fixture(scope="module")
def renderer() -> Iterator[Renderer]:
    with Renderer() as opened:
        yield opened
