"""From light to the bytes of a picture: exposure, noise, gain, white balance, sRGB, eight bits."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from firmware_sim.scene.pose import F32

U8 = NDArray[np.uint8]

REFERENCE_S = 0.01
"""Light of 1 fills a pixel in this time without gain."""
DOUBLING_GAIN = 25
"""Steps of the gain control that double the signal."""
NEUTRAL_K = 4600
"""White balance temperature at which the scene's white comes out white."""
_WAVELENGTHS_M = np.array([600e-9, 540e-9, 450e-9])
_SECOND_RADIATION_CONSTANT_M_K = 0.014388
_TABLE_STEPS = 1 << 14


def _srgb_table() -> U8:
    linear = np.arange(_TABLE_STEPS) / (_TABLE_STEPS - 1)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.asarray(np.rint(encoded * 255), np.uint8)


_SRGB = _srgb_table()


@dataclass(frozen=True)
class Exposure:
    """How one picture is taken.

    Attributes
    ----------
    time_s : exposure time
    gain : control value, 0 for none
    white_balance_k : colour temperature that is rendered white
    brightness : added to the codes of the picture
    """

    time_s: float
    gain: int = 0
    white_balance_k: int = NEUTRAL_K
    brightness: int = 0


class Sensor:
    """A sensor with shot noise and read noise; every picture has its own."""

    def __init__(self, full_well_electrons: float, read_noise_electrons: float, seed: int) -> None:
        self._full_well = np.float32(full_well_electrons)
        self._read_noise = np.float32(read_noise_electrons)
        self._random = np.random.Generator(np.random.SFC64(seed))

    def expose(self, light: F32, exposure: Exposure) -> U8:
        """Take a picture.

        Parameters
        ----------
        light : (H, W, 3) float32, linear RGB as a scene gives it
        exposure : how

        Returns
        -------
        picture : (H, W, 3) uint8, sRGB; what exceeds the full well is clipped
        """
        electrons = light * np.float32(exposure.time_s / REFERENCE_S * self._full_well)
        noise = self._random.standard_normal(electrons.shape, dtype=np.float32)
        noise *= np.sqrt(electrons + self._read_noise**2)
        electrons += noise
        np.minimum(electrons, self._full_well, out=electrons)
        factors = _balance(exposure.white_balance_k) * np.float32(
            2 ** (exposure.gain / DOUBLING_GAIN) / self._full_well
        )
        electrons *= factors
        return _encode(electrons, exposure.brightness)


def _encode(linear: F32, brightness: int) -> U8:
    steps = linear * np.float32(_TABLE_STEPS - 1) + np.float32(0.5)
    picture: U8 = _SRGB.take(steps.clip(0, _TABLE_STEPS - 1).astype(np.int32))
    if brightness:
        picture = np.clip(picture.astype(np.int16) + brightness, 0, 255).astype(np.uint8)
    return picture


def _balance(temperature_k: float) -> F32:
    """Return factors on R, G, B that make a black body of that temperature look like one of the neutral one."""

    def radiance(kelvin: float) -> NDArray[np.float64]:
        # Planck's law up to a factor that only depends on wavelength, which cancels.
        return 1 / np.expm1(_SECOND_RADIATION_CONSTANT_M_K / (_WAVELENGTHS_M * kelvin))

    factors = radiance(NEUTRAL_K) / radiance(temperature_k)
    return np.asarray(factors / factors[1], np.float32)


class AutoExposure:
    """The camera's own choice of exposure time: it walks towards a mid-grey mean."""

    TARGET = 0.12
    SHORTEST_S = 1e-4

    def __init__(self) -> None:
        self.time_s = REFERENCE_S

    def observe(self, light: F32, longest_s: float) -> None:
        """Take half the way, in stops, to the time that would have met the target."""
        mean = float(light.mean()) * self.time_s / REFERENCE_S
        wanted_s = self.time_s * math.sqrt(self.TARGET / max(mean, 1e-6))
        self.time_s = min(max(wanted_s, self.SHORTEST_S), longest_s)
