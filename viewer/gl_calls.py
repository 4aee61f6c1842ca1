"""OpenGL functions that moderngl has no word for: upload of chosen mip levels into a volume.

The calls run in the current context and leave its state as they found it.
"""

import ctypes
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from viewer.gl_context import Backend

_TEXTURE_3D = 0x806F
_TEXTURE_BINDING_3D = 0x806A
_TEXTURE_MAX_LEVEL = 0x813D
_PIXEL_UNPACK_BUFFER = 0x88EC
_PIXEL_UNPACK_BUFFER_BINDING = 0x88EF
_UNPACK_ALIGNMENT = 0x0CF5
_RGBA, _RGBA16F, _HALF_FLOAT = 0x1908, 0x881A, 0x140B

_int, _uint, _pointer = ctypes.c_int, ctypes.c_uint, ctypes.c_void_p
_SIGNATURES: dict[str, tuple[type[ctypes.c_int | ctypes.c_uint | ctypes.c_void_p], ...]] = {
    "glGetIntegerv": (_uint, _pointer),
    "glBindTexture": (_uint, _uint),
    "glBindBuffer": (_uint, _uint),
    "glPixelStorei": (_uint, _int),
    "glTexParameteri": (_uint, _uint, _int),
    "glTexImage3D": (_uint, _int, _int, _int, _int, _int, _int, _uint, _uint, _pointer),
}


def upload_volume_levels(backend: Backend, texture: int, levels: Sequence[NDArray[np.float16]]) -> None:
    """Fill an RGBA half-float volume level by level and say that there are no more.

    Parameters
    ----------
    texture : OpenGL's number of a 3D texture
    levels : (D, rows, columns, 4) float16 each, the full one first, every further one halved and rounded down
    """
    calls = _Calls(backend)
    bound, buffer = calls.integer(_TEXTURE_BINDING_3D), calls.integer(_PIXEL_UNPACK_BUFFER_BINDING)
    alignment = calls.integer(_UNPACK_ALIGNMENT)
    try:
        calls("glBindTexture", _TEXTURE_3D, texture)
        calls("glBindBuffer", _PIXEL_UNPACK_BUFFER, 0)
        calls("glPixelStorei", _UNPACK_ALIGNMENT, 1)
        calls("glTexParameteri", _TEXTURE_3D, _TEXTURE_MAX_LEVEL, len(levels) - 1)
        for number, texels in enumerate(levels):
            whole = np.ascontiguousarray(texels)
            depth, height, width = whole.shape[:3]
            calls(
                *("glTexImage3D", _TEXTURE_3D, number, _RGBA16F, width, height, depth, 0),
                *(_RGBA, _HALF_FLOAT, whole.ctypes.data),
            )
    finally:
        calls("glPixelStorei", _UNPACK_ALIGNMENT, alignment)
        calls("glBindBuffer", _PIXEL_UNPACK_BUFFER, buffer)
        calls("glBindTexture", _TEXTURE_3D, bound)


class _Calls:
    """Functions by name, with their C signatures."""

    def __init__(self, backend: Backend) -> None:
        self._functions = {
            name: ctypes.CFUNCTYPE(None, *arguments)(backend.load(name)) for name, arguments in _SIGNATURES.items()
        }

    def __call__(self, name: str, *arguments: int) -> None:
        self._functions[name](*arguments)

    def integer(self, name: int) -> int:
        value = ctypes.c_int()
        self("glGetIntegerv", name, ctypes.addressof(value))
        return value.value
