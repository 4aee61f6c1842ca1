"""OpenGL functions that moderngl has no word for: upload of chosen mip levels into volumes and layers.

The calls run in the current context and leave its state as they found it.
"""

import ctypes
from collections.abc import Sequence
from typing import NamedTuple

import moderngl
import numpy as np
from numpy.typing import NDArray

from viewer.gl_context import Backend

_TEXTURE_MAX_LEVEL = 0x813D
_PIXEL_UNPACK_BUFFER = 0x88EC
_PIXEL_UNPACK_BUFFER_BINDING = 0x88EF
_UNPACK_ALIGNMENT = 0x0CF5
_HALF_FLOAT, _FLOAT = 0x140B, 0x1406


class _Kind(NamedTuple):
    target: int
    binding: int


_VOLUME = _Kind(0x806F, 0x806A)
_LAYERS = _Kind(0x8C1A, 0x8C1D)
_FORMATS = {3: 0x1907, 4: 0x1908}
_STORED = {
    (3, np.dtype(np.float32)): (0x8815, _FLOAT),
    (4, np.dtype(np.float32)): (0x8814, _FLOAT),
    (4, np.dtype(np.float16)): (0x881A, _HALF_FLOAT),
}
"""OpenGL's internal format and type, by channels and type."""

_int, _uint, _pointer = ctypes.c_int, ctypes.c_uint, ctypes.c_void_p
_SIGNATURES: dict[str, tuple[type[ctypes.c_int | ctypes.c_uint | ctypes.c_void_p], ...]] = {
    "glGetIntegerv": (_uint, _pointer),
    "glBindTexture": (_uint, _uint),
    "glBindBuffer": (_uint, _uint),
    "glPixelStorei": (_uint, _int),
    "glTexParameteri": (_uint, _uint, _int),
    "glTexImage3D": (_uint, _int, _int, _int, _int, _int, _int, _uint, _uint, _pointer),
}


def upload_levels(
    backend: Backend,
    texture: moderngl.Texture3D | moderngl.TextureArray,
    levels: Sequence[NDArray[np.float16] | NDArray[np.float32]],
) -> None:
    """Fill a volume, or layers, level by level and say that there are no more.

    Parameters
    ----------
    levels : (D, rows, columns, C) each, the full one first, every further one halved and rounded down; of layers the
        number D stays. C is 3 or 4 of float32, or 4 of float16, as the texture was made
    """
    kind = _VOLUME if isinstance(texture, moderngl.Texture3D) else _LAYERS
    calls = _Calls(backend)
    bound, buffer = calls.integer(kind.binding), calls.integer(_PIXEL_UNPACK_BUFFER_BINDING)
    alignment = calls.integer(_UNPACK_ALIGNMENT)
    try:
        calls("glBindTexture", kind.target, texture.glo)
        calls("glBindBuffer", _PIXEL_UNPACK_BUFFER, 0)
        calls("glPixelStorei", _UNPACK_ALIGNMENT, 1)
        calls("glTexParameteri", kind.target, _TEXTURE_MAX_LEVEL, len(levels) - 1)
        for number, texels in enumerate(levels):
            whole = np.ascontiguousarray(texels)
            depth, height, width, channels = whole.shape
            stored, form = _STORED[channels, whole.dtype]
            calls(
                *("glTexImage3D", kind.target, number, stored, width, height, depth, 0),
                *(_FORMATS[channels], form, whole.ctypes.data),
            )
    finally:
        calls("glPixelStorei", _UNPACK_ALIGNMENT, alignment)
        calls("glBindBuffer", _PIXEL_UNPACK_BUFFER, buffer)
        calls("glBindTexture", kind.target, bound)


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
