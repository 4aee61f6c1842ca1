"""The configurations that the parts of a session were shot with."""

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from litrig.base.capture_folder import layout
from litrig.base.capture_folder.bag import sha256_of
from litrig.base.capture_folder.crate import Description
from litrig.base.capture_folder.journal import Entry
from litrig.base.capture_folder.session_file import vouched_for
from litrig.base.config import LARGEST_TOML_BYTES
from litrig.base.errors import FormatError, InputError
from litrig.base.files import read_limited, resolve_inside
from litrig.base.version import litrig_version
from rig.config import RigConfig
from rig.rig_lock import PORT_KEYS


@dataclass(frozen=True)
class Frozen:
    """What a session was begun with, or its last segment."""

    config: RigConfig
    about: Description


def segment_settings(folder: Path, entries: Sequence[Entry]) -> Frozen:
    """Read the configuration of the last segment, as the journal vouches for it.

    Raises
    ------
    InputError, FormatError
        A file is missing, is not as it was written, or does not hold a rig's configuration.
    """
    vouched = vouched_for(entries)
    if not vouched:
        raise FormatError(f"{folder / layout.JOURNAL}: does not begin with a session; nothing was shot, capture anew")
    for file, digest in vouched.items():
        path = resolve_inside(folder, file)
        if not path.is_file() or sha256_of(path) != digest:
            raise FormatError(f"{path}: changed since the session began, or missing; restore it from a copy")
    last = [file for file in vouched if file != layout.PLAN][-1]
    begun, latest = _read(folder / layout.SESSION), _read(folder / last)
    try:
        config = RigConfig.model_validate(latest.get("rig", {}))
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        key = ".".join(str(part) for part in first["loc"])
        raise FormatError(
            f"{folder / last}: rig.{key}: {first['msg']}; it was written by another version, name a RIG.toml with --rig"
        ) from error
    session = begun.get("session", {})
    about = Description(litrig_version(), str(session.get("started", "")), operator=str(session.get("operator", "")))
    return Frozen(config, about)


def check_configuration(folder: Path, frozen: RigConfig, used: RigConfig, *, accept: bool) -> list[str]:
    """Return what differs between two configurations, device paths aside: a port may come back under another name.

    Raises
    ------
    InputError
        Something does, and it is not accepted; the message names the keys.
    """
    before, now = dict(_flat(frozen.model_dump())), dict(_flat(used.model_dump()))
    changes = [
        f"{key} ({before.get(key)} → {now.get(key)})"
        for key in sorted({*before, *now})
        if before.get(key) != now.get(key)
    ]
    if changes and not accept:
        raise InputError(
            f"{folder}: was shot with another configuration: {'; '.join(changes)}. Put it back, or accept the change "
            "with --new-segment"
        )
    return changes


def _flat(table: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{above}{key}.")
        elif key not in PORT_KEYS:
            yield f"{above}{key}", list(value) if isinstance(value, tuple) else value


def _read(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(read_limited(path, LARGEST_TOML_BYTES).decode())
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise FormatError(f"{path}: is no TOML ({error}); restore it from a copy") from error
