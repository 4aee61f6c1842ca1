"""What can go wrong with the simulated rig, and who mends it.

SimError                    status 1; the message is one line for a person
├── SimConfigError          SIM.toml is wrong: mend the line that the message names
├── SimToolError            the system lacks a compiler or a header: install what the message names
├── SimServerError          the simulator's process did not start, or died: the message has its last words
├── RenderError             a picture cannot be rendered: the message says why
└── SideChannelError        a request over the side channel was refused, or nobody answers there
"""


class SimError(Exception):
    """Root of everything that the simulator raises on purpose."""

    exit_status = 1


class SimConfigError(SimError):
    """SIM.toml is missing, is not TOML, or does not fit the model."""


class SimToolError(SimError):
    """The camera shim cannot be compiled here."""


class SimServerError(SimError):
    """The process that plays the devices is not there."""


class RenderError(SimError):
    """What renders the scene failed, or ended."""


class SideChannelError(SimError):
    """A request over the side channel failed."""
