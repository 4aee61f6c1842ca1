"""What an opened material file offers."""

from collections.abc import Callable

from viewer.look import Look
from viewer.motion import Moment

Looks = Callable[[Moment], Look]
"""Says how a material looks at one moment; cheap, so that it is asked for every frame."""
