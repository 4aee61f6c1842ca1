"""What windows look at: brightness, or its slope, along the meridians of pixels."""

from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from processing.matcap.estimate.meridians import Meridians

F64 = NDArray[np.float64]
Of = Literal["values", "bumps", "edges"]

SAMPLES_A_TEXEL = 2
_FAINT_SHARE = 0.01


class Profiles:
    """R, or |R′|, along θ around P pixels: the paper's R′ changes its sign, which no density does.

    Attributes
    ----------
    t : (T,) radians from the pixel, outwards
    inner, outer : (P,) where along t the disc ends, through the pole and directly
    spacing : radians from sample to sample
    """

    def __init__(self, meridians: Meridians, theta: F64, phi: F64, of: Of, reach: float) -> None:
        self.spacing = meridians.texel / SAMPLES_A_TEXEL
        self._half = int(np.ceil(reach / self.spacing)) + 1
        self.t: F64 = self.spacing * np.arange(-self._half, self._half + 1.0)
        self.inner, self.outer = -meridians.rim - theta, meridians.rim - theta
        angles = theta[:, None] + self.t
        within = np.clip(angles, -meridians.rim, meridians.rim)
        # Mirrored at its end point, a profile keeps its slope across the rim.
        mirrored = meridians.at(2 * within - angles, phi[:, None])
        beyond = within != angles
        self._values = np.where(beyond, 2 * meridians.at(within, phi[:, None]) - mirrored, mirrored)
        self._brightest = meridians.brightest
        self._edges = of == "edges"
        self._spectrum = _Spectrum(self._values, self.spacing)

    def near(self, window: float) -> slice:
        """Return which samples lie within a window, and a few more."""
        count = int(window / self.spacing) + 2
        return slice(max(self._half - count, 0), self._half + count + 1)

    def raw(self) -> F64:
        """Return brightness (P, T) as it is."""
        return np.maximum(self._values, 0)

    def smoothed(self, smoothing: float) -> F64:
        """Return the profiles (P, T), not negative, after a Gaussian of that standard deviation in radians."""
        found = self._spectrum.smoothed(smoothing, derived=self._edges)
        return np.abs(found) if self._edges else np.maximum(found, 0)

    def faint(self, weighed: F64) -> NDArray[np.bool_]:
        """Tell which windowed profiles (P, …) are of no more light, or no greater a step, than 8 bits hold."""
        most = weighed.sum(axis=1) * self.spacing if self._edges else weighed.max(axis=1)
        return np.asarray(most <= _FAINT_SHARE * self._brightest)

    def between_samples(self, profiles: F64, t: F64) -> F64:
        """Read profiles (P, T) anywhere within reach, at (C,) radians from their pixels."""
        place = t / self.spacing + self._half
        first = np.floor(place).astype(int)
        part = place - first
        read: F64 = profiles[:, first] * (1 - part) + profiles[:, first + 1] * part
        return read

    def share_between(self, begin: F64 | float, end: F64 | float, among: slice) -> F64:
        """Return the share 0..1 of each sample's cell between two ends (…, 1): windows end anywhere."""
        half = self.spacing / 2
        cell: F64 = np.minimum(self.t[among] + half, end) - np.maximum(self.t[among] - half, begin)
        return np.clip(cell / self.spacing, 0, 1)


class _Spectrum:
    """Sampled profiles, or their derivatives, smoothed by any Gaussian."""

    def __init__(self, values: F64, spacing: float) -> None:
        kept = values.shape[1]
        margin = kept // 4
        padded = np.pad(values, ((0, 0), (margin, margin)), mode="reflect", reflect_type="odd")
        count = padded.shape[1]
        # Without its trend a profile ends as it begins, as the transform takes for granted.
        self._rise = (padded[:, -1:] - padded[:, :1]) / (count - 1)
        self._trend = self._rise * np.arange(count)
        self._spectrum = fft.rfft(padded - self._trend, axis=1)
        self._frequency = 2 * np.pi * fft.rfftfreq(count, spacing)
        self._count, self._kept, self._spacing = count, slice(margin, margin + kept), spacing

    def smoothed(self, smoothing: float, *, derived: bool) -> F64:
        kernel = np.exp(-((self._frequency * smoothing) ** 2) / 2)
        changed = self._spectrum * (1j * self._frequency * kernel if derived else kernel)
        found: F64 = fft.irfft(changed, self._count, axis=1)
        found += self._rise / self._spacing if derived else self._trend
        return found[:, self._kept]
