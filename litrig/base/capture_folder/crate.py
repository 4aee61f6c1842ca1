"""The RO-Crate 1.1 description of a session, so that archives know what the files are."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from litrig.base.capture_folder import layout

CONTEXT = "https://w3id.org/ro/crate/1.1/context"
MOST_LISTED_FRAMES = 2000

_MEDIA_TYPES = {
    ".jpg": "image/jpeg",
    ".png": "image/png",
    ".tif": "image/tiff",
    ".exr": "image/x-exr",
    ".dng": "image/x-adobe-dng",
    ".toml": "application/toml",
    ".jsonl": "application/jsonl",
    ".lp": "text/plain",
    ".md": "text/markdown",
}


@dataclass(frozen=True)
class Description:
    """What is said of a session besides its files.

    Attributes
    ----------
    version : of litrig
    started, ended : wall clock, ISO 8601
    instruments : the devices, with what is known of them
    operator : who shot it; empty if nobody said
    """

    version: str
    started: str
    ended: str = ""
    instruments: tuple[str, ...] = ()
    operator: str = ""

    def ending(self, ended: str) -> "Description":
        """Say when it ended."""
        return replace(self, ended=ended)


def crate_of(folder: Path, name: str, about: Description) -> bytes:
    """Describe what lies in `folder` now, as ro-crate-metadata.json has it."""
    data = folder / "data"
    files = sorted(path for path in data.rglob("*") if path.is_file() and path != folder / layout.CRATE)
    frames = [path for path in files if path.is_relative_to(folder / layout.FRAMES)]
    listed = files if len(frames) <= MOST_LISTED_FRAMES else [path for path in files if path not in set(frames)]
    parts = [_file(path, data) for path in listed]
    devices = [{"@id": f"#{device}", "@type": "IndividualProduct", "name": device} for device in about.instruments]
    software = {"@id": "#litrig", "@type": "SoftwareApplication", "name": "litrig", "softwareVersion": about.version}
    action = {
        "@id": "#session",
        "@type": "CreateAction",
        "name": f"Capture session of {name}",
        "startTime": about.started,
        "endTime": about.ended,
        "instrument": [{"@id": entity["@id"]} for entity in (software, *devices)],
        "result": {"@id": "./"},
    }
    root = {
        "@id": "./",
        "@type": "Dataset",
        "name": name,
        "description": f"Capture session of {name}: {len(frames)} frames, journal, plan and settings",
        "datePublished": about.ended,
        "license": "All rights reserved unless the owner of the object says otherwise",
        "hasPart": [{"@id": part["@id"]} for part in parts],
        "mentions": {"@id": "#session"},
    }
    descriptor = {
        "@id": "ro-crate-metadata.json",
        "@type": "CreativeWork",
        "conformsTo": {"@id": "https://w3id.org/ro/crate/1.1"},
        "about": {"@id": "./"},
    }
    people = [{"@id": "#operator", "@type": "Person", "name": about.operator}] if about.operator else []
    if people:
        action["agent"] = {"@id": "#operator"}
    graph = [descriptor, root, action, software, *people, *devices, *parts]
    crate = {"@context": CONTEXT, "@graph": graph}
    return (json.dumps(crate, indent=1, ensure_ascii=False) + "\n").encode()


def _file(path: Path, data: Path) -> Mapping[str, Any]:
    relative = path.relative_to(data).as_posix()
    return {
        "@id": relative,
        "@type": "File",
        "name": path.name,
        "contentSize": str(path.stat().st_size),
        "encodingFormat": _MEDIA_TYPES.get(path.suffix.lower(), "application/octet-stream"),
    }
