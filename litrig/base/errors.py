"""What litrig says when something is wrong, and the exit status that goes with it.

LitrigError                 status 1
├── InputError              a file, a folder or a value is wrong: mend what the message names
│   ├── FormatError         a file is not what its name says, or is damaged
│   └── ConfigError         a TOML file is wrong: mend the line that the message names
├── MissingToolError        a library or program of the system is not there: install it
├── rig.errors.RigError     the rest of the tree is drawn there
└── HoldError               status 3: the rig is on hold and needs a person

A message names the file or device, the reason, and the next step. It is composed where the numbers are, so that every
error here takes one argument and survives the way through a process pool.
"""


class LitrigError(Exception):
    """Root of everything that litrig raises on purpose; the command prints it as one line."""

    exit_status = 1


class InputError(LitrigError):
    """What the user handed in is wrong."""


class FormatError(InputError):
    """A file is damaged, or is not of the format that its name promises."""


class ConfigError(InputError):
    """A TOML file has an unknown key, a missing one, or a value out of range."""


class MissingToolError(LitrigError):
    """A shared library, compiler or other part of the system is missing; the message says what to install."""


class HoldError(LitrigError):
    """The rig stopped safely and a person must look at it."""

    exit_status = 3
