"""What can go wrong while a picture is drawn.

LitrigError
└── GraphicsError   the graphics driver reported an error: nothing of what it drew is used
"""

from litrig.base.errors import LitrigError


class GraphicsError(LitrigError):
    """The graphics driver refused something; the message has its word for it."""
