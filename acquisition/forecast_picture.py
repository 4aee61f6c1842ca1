"""How long a picture takes, and how large its file is."""

from dataclasses import dataclass
from typing import Self

from rig.config import CameraConfig
from rig.sections import CameraSection

USUAL_FPS = 30.0
"""Of a camera whose RIG.toml leaves it as it is."""
DELIVERY_FRAMES = 2.0
"""Frame periods until a frame is read out, transferred and handed on (measured on the simulated camera)."""
CHANGE_FRAMES = 2.0
"""Frame periods until another exposure time has taken effect, as UVC cameras are known for."""
BYTES_A_PIXEL = {"MJPG": 0.4, "YUYV": 1.9}
"""A JPEG of the simulated camera, at quality 95 and with noise, has 0.21 (a sphere on black) to 0.37 (a coin that fills
the picture); a PNG of noisy pictures saves about a third of 3. So these are rather too high."""
UNKNOWN_PICTURE_BYTES = 30_000_000
"""Of a camera of another package, of which nothing is known: a RAW file of 24 million pixels."""
UNKNOWN_PICTURE_S = 3.0
"""The same for its time: a release, and the transfer of such a file."""


@dataclass(frozen=True)
class Picture:
    """What a camera delivers.

    Attributes
    ----------
    exposure_s : the rig's own exposure time
    period_s : from frame to frame
    size_bytes : estimate of one file
    meaning : how it was estimated
    """

    exposure_s: float
    period_s: float
    size_bytes: float
    meaning: str

    @classmethod
    def of(cls, config: CameraSection | None) -> Self:
        """Take it from RIG.toml."""
        if not isinstance(config, CameraConfig):
            return cls(0.0, UNKNOWN_PICTURE_S, UNKNOWN_PICTURE_BYTES, "30 MB a picture, for a camera of unknown size")
        share = BYTES_A_PIXEL[config.pixel_format]
        kind = "JPEG" if config.pixel_format == "MJPG" else "PNG"
        meaning = f"{config.width} × {config.height} {kind} at {share:g} bytes a pixel"
        period_s = 1 / (config.fps or USUAL_FPS)
        return cls(config.exposure_ms / 1000, period_s, share * config.width * config.height, meaning)

    def time_s(self, exposure_ev: float, *, changed: bool) -> float:
        """Return the time until a frame that began to be exposed after it was asked for is there.

        Half a period passes on average until one begins; a frame takes no less than its exposure.

        Parameters
        ----------
        changed : whether the exposure time is another than the last one's
        """
        exposure_s = float(self.exposure_s * 2.0**exposure_ev)
        period_s = max(self.period_s, exposure_s)
        waits = 0.5 + DELIVERY_FRAMES + (CHANGE_FRAMES if changed else 0.0)
        return exposure_s + waits * period_s
