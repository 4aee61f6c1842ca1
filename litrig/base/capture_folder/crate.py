"""The RO-Crate 1.1 description of a session, so that archives know what the files are."""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from litrig.base.capture_folder import layout
from litrig.base.files import write_atomically

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


def write_crate(folder: Path, *, name: str, started: str, ended: str, version: str, instruments: Iterable[str]) -> None:
    """Describe what lies in `folder` now, at the end of a session."""
    data = folder / "data"
    files = sorted(path for path in data.rglob("*") if path.is_file() and path != folder / layout.CRATE)
    frames = [path for path in files if path.is_relative_to(folder / layout.FRAMES)]
    listed = files if len(frames) <= MOST_LISTED_FRAMES else [path for path in files if path not in set(frames)]
    parts = [_file(path, data) for path in listed]
    devices = [{"@id": f"#{device}", "@type": "IndividualProduct", "name": device} for device in instruments]
    software = {"@id": "#litrig", "@type": "SoftwareApplication", "name": "litrig", "softwareVersion": version}
    action = {
        "@id": "#session",
        "@type": "CreateAction",
        "name": f"Capture session of {name}",
        "startTime": started,
        "endTime": ended,
        "instrument": [{"@id": entity["@id"]} for entity in (software, *devices)],
        "result": {"@id": "./"},
    }
    root = {
        "@id": "./",
        "@type": "Dataset",
        "name": name,
        "description": f"Capture session of {name}: {len(frames)} frames, journal, plan and settings",
        "datePublished": ended,
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
    graph = [descriptor, root, action, software, *devices, *parts]
    crate = {"@context": CONTEXT, "@graph": graph}
    write_atomically(folder / layout.CRATE, (json.dumps(crate, indent=1, ensure_ascii=False) + "\n").encode())


def _file(path: Path, data: Path) -> Mapping[str, Any]:
    relative = path.relative_to(data).as_posix()
    return {
        "@id": relative,
        "@type": "File",
        "name": path.name,
        "contentSize": str(path.stat().st_size),
        "encodingFormat": _MEDIA_TYPES.get(path.suffix.lower(), "application/octet-stream"),
    }
