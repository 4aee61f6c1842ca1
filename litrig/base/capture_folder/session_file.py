"""What readers take from session.toml; the rest of it is for people and for later."""

import hashlib
from collections.abc import Iterable
from pathlib import Path

from pydantic import Field

from litrig.base.capture_folder import layout
from litrig.base.capture_folder.journal import Entry
from litrig.base.config import LARGEST_TOML_BYTES, StrictModel, parse_toml_bytes
from litrig.base.errors import FormatError
from litrig.base.files import read_limited

LARGEST_ANGLE_DEG = 3600.0


class _Part(StrictModel, extra="ignore", strict=True):
    """What is not asked for may be anything: rigs and plans have keys of their own."""


class _Session(_Part):
    object: str | None = None
    tangent_zero_deg: float = Field(default=0.0, ge=-LARGEST_ANGLE_DEG, le=LARGEST_ANGLE_DEG)


class _Sample(_Part):
    sphere_distance_radii: float | None = Field(default=None, gt=1)


class _Rig(_Part):
    sample: _Sample = _Sample()


class SessionFile(_Part):
    """The parts of a session.toml that change what is made of its frames."""

    session: _Session = _Session()
    rig: _Rig = _Rig()


def read_session_file(folder: Path, entries: Iterable[Entry]) -> SessionFile:
    """Read the settings of a session, as its journal vouches for them.

    Raises
    ------
    InputError, FormatError, ConfigError
        The file is missing, is not the one that the session began with, or holds a value of the wrong kind.
    """
    path = folder / layout.SESSION
    content = read_limited(path, LARGEST_TOML_BYTES)
    digest = vouched_for(entries).get(layout.SESSION)
    if digest is not None and hashlib.sha256(content).hexdigest() != digest:
        raise FormatError(f"{path}: changed since the session began (its sha256 differs); restore it from a copy")
    return parse_toml_bytes(content, SessionFile, str(path))


def vouched_for(entries: Iterable[Entry]) -> dict[str, str]:
    """Return the sha256 of settings and plan, by their files, as the journal has them since they were written."""
    digests: dict[str, str] = {}
    for entry in entries:
        for key, file in (("session_sha256", entry.get("session", layout.SESSION)), ("plan_sha256", layout.PLAN)):
            if entry.get("ev") in ("session", "segment") and isinstance(entry.get(key), str):
                digests[str(file)] = entry[key]
    return digests
