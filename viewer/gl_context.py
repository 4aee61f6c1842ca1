"""An OpenGL context that needs no display, or that of a window.

EGL opens it, on a graphics card or on Mesa's software rasteriser. What the loader says when a library is missing names
no package; that is translated here.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import glcontext
import moderngl

from litrig.base.errors import MissingToolError

INSTALL = "apt-get install -y --no-install-recommends libegl1 libgl1"
_VERSION = 330


class Backend(Protocol):
    """The open context of the window system, here EGL's."""

    def load(self, name: str) -> int:
        """Return the address of an OpenGL function."""


@dataclass(frozen=True)
class GlContext:
    """An open context: moderngl's face of it, and the way to functions that moderngl lacks."""

    moderngl: moderngl.Context
    backend: Backend


def open_egl() -> Any:
    """Open EGL by the names that the libraries have at run time; no development package is needed."""
    return glcontext.get_backend_by_name("egl")(
        mode="standalone", glversion=_VERSION, libgl="libGL.so.1", libegl="libEGL.so.1"
    )


def open_context(open_backend: Callable[[], Any] = open_egl) -> GlContext:
    """Open an OpenGL 3.3 context without a display.

    Raises
    ------
    MissingToolError
        A library is missing or too old; the message has the line that installs it.
    """
    try:
        backend = open_backend()
        context = moderngl.create_context(require=_VERSION, standalone=True, context=backend)
    except Exception as error:  # the loader raises plain Exception
        raise MissingToolError(_advice(str(error))) from error
    return GlContext(context, backend)


def adopt_context() -> GlContext:
    """Take the OpenGL context that a window has just made current; the window keeps it, and outlives what adopts it.

    Raises
    ------
    MissingToolError
        There is none, or it is older than 3.3.
    """
    try:
        backend = glcontext.default_backend()(
            mode="detect", glversion=_VERSION, libgl="libGL.so.1", libx11="libX11.so.6"
        )
        context = moderngl.create_context(require=_VERSION, context=backend)
    except Exception as error:  # the loader raises plain Exception
        raise MissingToolError(_advice(str(error))) from error
    return GlContext(context, backend)


def _advice(reason: str) -> str:
    if "not loaded" in reason or "not found" in reason:
        return f"OpenGL: {reason}: the library is not installed; install it with: {INSTALL}"
    return (
        f"OpenGL: no context of version 3.3 without a display ({reason}); install Mesa's with: {INSTALL} "
        "or update the graphics driver"
    )
