"""What can go wrong with the rig, and who mends it.

LitrigError
├── RigError                status 1
│   ├── LinkError           bytes do not come through
│   │   ├── PortError       the port is missing, forbidden, or held by another program
│   │   ├── LinkTimeoutError    silence: power, cable, baud rate
│   │   └── GarbledReplyError   wrong checksum after every retry, or an answer that makes no sense
│   ├── DeviceError         the device answers, and says that it cannot
│   │   └── PositionLostError   it no longer knows where it is: home it
│   ├── OutOfRangeError     beyond the limits; nothing moved
│   └── CameraError         no camera, no picture, or the wrong one
│       └── CameraHangsError    it was asked, and never answered
└── HoldError               status 3: see litrig.base.errors
"""

from litrig.base.errors import LitrigError


class RigError(LitrigError):
    """Root of what the drivers raise."""


class LinkError(RigError):
    """Bytes do not come through."""


class PortError(LinkError):
    """The port cannot be opened."""


class LinkTimeoutError(LinkError):
    """Nothing came back in time, after every retry."""


class GarbledReplyError(LinkError):
    """What came back is damaged or makes no sense, after every retry."""


class DeviceError(RigError):
    """The device reports a fault, or does not do what it was told."""


class PositionLostError(DeviceError):
    """The device no longer knows where it is."""


class OutOfRangeError(RigError):
    """The goal lies outside the limits; nothing was sent."""


class CameraError(RigError):
    """The camera is missing, hangs, or delivers no usable picture."""


class CameraHangsError(CameraError):
    """The camera was asked for a picture and never answered; its process was ended."""
