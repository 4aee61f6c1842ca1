"""Shaders are files beside this module; one may include another by a line `#include "NAME"`."""

import re
from importlib.resources import files

_INCLUDE = re.compile(r'^#include "(?P<name>[\w.]+)"$', re.MULTILINE)


def shader_source(name: str) -> str:
    """Return the text of a shader with what it includes put in place."""
    text = files("viewer").joinpath("shaders", name).read_text(encoding="utf-8")
    return _INCLUDE.sub(lambda line: shader_source(line["name"]), text)
