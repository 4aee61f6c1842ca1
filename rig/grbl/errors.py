"""What a GRBL controller may answer, for callers that can do something about it.

DeviceError
├── RefusedError        a line was answered with `error:N`
├── KeptAlarmError      an alarm that kept the position: `GrblController.halt` leads out
├── StillMovingError    the motion has not ended in time
└── DimError            the lamp's output does not stand where it was told
"""

from rig.errors import DeviceError


class RefusedError(DeviceError):
    """A line was answered with `error:N`."""


class KeptAlarmError(DeviceError):
    """An alarm that kept the position."""


class StillMovingError(DeviceError):
    """The motion has not ended in time."""


class DimError(DeviceError):
    """The lamp's output does not stand where it was told."""
