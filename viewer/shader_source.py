"""Shaders are files beside this module; one may include another by a line `#include "NAME"`."""

import re
from collections.abc import Set
from importlib.resources import files

_INCLUDE = re.compile(r'^#include "(?P<name>[\w.]+)"$', re.MULTILINE)


def shader_source(name: str, switches: Set[str] = frozenset()) -> str:
    """Return the text of a shader with what it includes put in place.

    Parameters
    ----------
    switches : names to define right after the line that says the version
    """
    text = files("viewer").joinpath("shaders", name).read_text(encoding="utf-8")
    whole = _INCLUDE.sub(lambda line: shader_source(line["name"]), text)
    version, newline, rest = whole.partition("\n")
    return version + newline + "".join(f"#define {switch}\n" for switch in sorted(switches)) + rest
