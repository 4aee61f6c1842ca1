"""Correlation of a texture with small patterns, by Fourier transforms of overlapping pieces (overlap–save).

A pattern is much smaller than the texture. Cut into pieces of a side for which the work is least, the texture's spectra
are made once, a pattern's spectrum is small and the same for all pieces, and all of it stays in the processor's caches.
"""

from typing import NamedTuple

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from litrig.base.kernels import kernel

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
_SIDES = tuple(side for side in range(16, 641, 2) if scipy.fft.next_fast_len(side, real=True) == side)
_SAFETY = 2.0
"""Factor on the bound of a transform's rounding; what is seen is a twentieth of the bound and less."""


class Pieces:
    """How a plane of candidates is cut.

    Attributes
    ----------
    side : of a transform
    valid : side of the square of results that a piece gives
    grid : rows and columns of pieces
    """

    def __init__(self, shape: tuple[int, int], pattern_px: int, planes: int) -> None:
        self.shape = shape
        self.side = min(_SIDES, key=lambda side: self._work(side, pattern_px, planes))
        self.valid = self.side - pattern_px + 1
        self.grid = self._grid(self.side, pattern_px)

    def cut(self, values: NDArray[np.floating], side: int) -> NDArray[np.floating]:
        """Cut planes (..., H, W) into overlapping squares (N, ..., side, side), filled up with zeros."""
        rows, columns = self.grid
        lead = values.shape[:-2]
        padded = np.zeros((*lead, (rows - 1) * self.valid + side, (columns - 1) * self.valid + side), values.dtype)
        height, width = min(values.shape[-2], padded.shape[-2]), min(values.shape[-1], padded.shape[-1])
        padded[..., :height, :width] = values[..., :height, :width]
        squares = np.zeros((rows * columns, *lead, side, side), values.dtype)
        for index in range(rows * columns):
            y, x = (part * self.valid for part in divmod(index, columns))
            squares[index] = padded[..., y : y + side, x : x + side]
        return squares

    def join(self, squares: NDArray[np.floating]) -> NDArray[np.floating]:
        """Put squares of results (N, valid, valid) together (H, W)."""
        rows, columns = self.grid
        whole = squares.reshape(rows, columns, self.valid, self.valid).swapaxes(1, 2)
        return whole.reshape(rows * self.valid, columns * self.valid)[: self.shape[0], : self.shape[1]]

    def locate(self, flat: NDArray[np.int64]) -> NDArray[np.int64]:
        """Turn places in the squares of results, all counted on, into places in the plane of candidates."""
        piece, inside = np.divmod(flat, self.valid * self.valid)
        (piece_row, piece_column), (y, x) = np.divmod(piece, self.grid[1]), np.divmod(inside, self.valid)
        return np.asarray((piece_row * self.valid + y) * self.shape[1] + piece_column * self.valid + x, np.int64)

    def _grid(self, side: int, pattern_px: int) -> tuple[int, int]:
        valid = side - pattern_px + 1
        return -(-self.shape[0] // valid), -(-self.shape[1] // valid)

    def _work(self, side: int, pattern_px: int, planes: int) -> float:
        if side < pattern_px:
            return float("inf")
        rows, columns = self._grid(side, pattern_px)
        transform = 5 * np.log2(side)
        return float(side * side * (rows * columns * (4 * planes + transform) + planes * transform))


class Spectrum(NamedTuple):
    """Real and imaginary parts of transforms, apart, for the processor multiplies them faster so."""

    real: NDArray[np.floating]
    imaginary: NDArray[np.floating]

    def part(self, pieces: slice) -> "Spectrum":
        """Return some pieces."""
        return Spectrum(self.real[pieces], self.imaginary[pieces])


class Correlator:
    """The spectra of a texture, ready to be correlated with patterns of one size."""

    def __init__(self, texture: NDArray[np.floating], pattern_px: int) -> None:
        """Transform a texture (H, W, K), in its own precision."""
        height, width, planes = texture.shape
        if pattern_px >= _SIDES[-1]:
            raise ValueError(f"patterns of {_SIDES[-1]} pixels and more are not correlated")
        self.pieces = Pieces((height - pattern_px + 1, width - pattern_px + 1), pattern_px, planes)
        squares = self.pieces.cut(np.moveaxis(texture, 2, 0), self.pieces.side)
        # Cauchy–Schwarz, with the transforms' relative error: Higham, Accuracy and Stability, theorem 24.2.
        rounding = _SAFETY * float(np.finfo(texture.dtype).eps) * 2 * np.log2(self.pieces.side)
        self._norms = rounding * np.sqrt(np.square(squares, dtype=np.float64).sum(axis=(2, 3))).max(axis=0)
        spectra = scipy.fft.rfft2(squares, workers=-1)
        self._texture = Spectrum(np.ascontiguousarray(spectra.real), np.ascontiguousarray(spectra.imag))

    def error(self, pattern: NDArray[np.floating]) -> float:
        """Bound the error of any result of `correlate` for a pattern (B, B, K)."""
        return float(self._norms @ np.sqrt(np.square(pattern, dtype=np.float64).sum(axis=(0, 1))))

    def spectrum(self, pattern: NDArray[np.floating]) -> Spectrum:
        """Transform a pattern (B, B, K) into (K, side, side // 2 + 1)."""
        side = self.pieces.side
        spectrum = scipy.fft.rfft2(np.moveaxis(pattern, 2, 0), (side, side))
        return Spectrum(np.ascontiguousarray(spectrum.real), np.ascontiguousarray(spectrum.imag))

    def room(self) -> NDArray[np.floating]:
        """Make what `correlate` works in; to keep it spares the system from finding memory each time."""
        count, _, rows, columns = self._texture.real.shape
        return np.zeros((count, rows, columns, 2), self._texture.real.dtype)

    def correlate(self, spectrum: Spectrum, pieces: slice, room: NDArray[np.floating]) -> NDArray[np.floating]:
        """Return Σ over pattern of texture·pattern for some pieces: (N, valid, valid)."""
        product = room[pieces]
        _multiply(*self._texture.part(pieces), *spectrum, product)
        side, valid = self.pieces.side, self.pieces.valid
        values = product.view(np.result_type(product.dtype, np.complex64))[..., 0]
        whole = scipy.fft.irfft2(values, (side, side), overwrite_x=True)
        return np.asarray(whole[:, :valid, :valid])

    def plane(self, pattern: NDArray[np.floating]) -> NDArray[np.floating]:
        """Correlate with one pattern (B, B, K), everywhere: (H − B + 1, W − B + 1)."""
        return self.pieces.join(self.correlate(self.spectrum(pattern), slice(None), self.room()))


@kernel
def _multiply(real: F32, imaginary: F32, pattern_real: F32, pattern_imaginary: F32, product: F32) -> None:
    """Sum the spectra (N, K, S, S') times the conjugate of a pattern's (K, S, S') over K, into (N, S, S', 2)."""
    pieces, planes, rows, columns = real.shape
    sum_real, sum_imaginary = np.zeros(columns, real.dtype), np.zeros(columns, real.dtype)
    for n in range(pieces):
        for y in range(rows):
            sum_real[:] = 0
            sum_imaginary[:] = 0
            for k in range(planes):
                a, b = real[n, k, y], imaginary[n, k, y]
                c, d = pattern_real[k, y], pattern_imaginary[k, y]
                for x in range(columns):
                    sum_real[x] += a[x] * c[x] + b[x] * d[x]
                    sum_imaginary[x] += b[x] * c[x] - a[x] * d[x]
            for x in range(columns):
                product[n, y, x, 0] = sum_real[x]
                product[n, y, x, 1] = sum_imaginary[x]
