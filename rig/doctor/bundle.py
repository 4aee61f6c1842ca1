"""What a bug report needs, in one archive: versions, configuration, findings, wires. Nothing private."""

import json
import platform
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import tomli_w

from litrig.base.files import replacing
from litrig.base.version import litrig_version
from rig.config import RigConfig
from rig.doctor.privacy import HIDDEN, Mask
from rig.wire_record import KIND

LIBRARIES = ("dynamixel-sdk", "numpy", "opencv-contrib-python-headless", "pydantic", "pyserial", "pyusb")
README = """\
What litrig's doctor found, for a bug report.

versions.json    litrig, Python, the system, libraries
rig.toml         the configuration as it was understood; comments and the rig's name are left out
doctor.json      the findings
wires.jsonl      every byte that the doctor exchanged with the devices
session.jsonl    the record of a session, if one was given

Home folders, names of people and machines, serial numbers, addresses and secrets are hidden. Look through it all the
same before you give it away.
"""


def write_bundle(
    path: Path,
    config: RigConfig,
    report: Mapping[str, Any],
    wires: Sequence[Mapping[str, Any]],
    session: Sequence[Mapping[str, Any]] = (),
    mask: Mask | None = None,
) -> None:
    """Write the archive.

    Parameters
    ----------
    report : the findings as `--json` prints them
    wires : what the doctor recorded
    session : a record of a session that went wrong
    mask : what is private; by default what this machine knows of its user

    Raises
    ------
    InputError
        It cannot be written; nothing is left behind.
    """
    hide = mask or Mask.of_this_machine()
    settings = config.model_dump(exclude_none=True)
    settings["rig"]["name"] = HIDDEN
    with replacing(path) as temporary, zipfile.ZipFile(temporary, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("README.txt", README)
        archive.writestr("versions.json", _json(_versions()))
        archive.writestr("rig.toml", tomli_w.dumps(hide.structure(settings)))
        archive.writestr("doctor.json", _json(hide.structure({**report, "rig": HIDDEN})))
        archive.writestr("wires.jsonl", "".join(_lines(wires, hide)))
        if session:
            archive.writestr("session.jsonl", "".join(_lines(session, hide)))


def _versions() -> Mapping[str, Any]:
    libraries = {}
    for name in LIBRARIES:
        try:
            libraries[name] = version(name)
        except PackageNotFoundError:
            continue
    try:
        system = platform.freedesktop_os_release().get("PRETTY_NAME", "")
    except OSError:
        system = ""
    return {
        "litrig": litrig_version(),
        "python": platform.python_version(),
        "kernel": platform.release(),
        "machine": platform.machine(),
        "system": system,
        "libraries": libraries,
    }


def _lines(entries: Iterable[Mapping[str, Any]], hide: Mask) -> Iterable[str]:
    yield json.dumps({"kind": KIND, "litrig": litrig_version(), "hidden": "what is private"}) + "\n"
    for entry in _joined(entries):
        yield json.dumps({**entry, "port": hide.text(entry["port"]), "bytes": hide.bytes(entry["bytes"]).hex()}) + "\n"


def _joined(entries: Iterable[Mapping[str, Any]]) -> Iterable[dict[str, Any]]:
    """Join bytes that came in pieces, so that no name hides between two of them."""
    last: dict[str, dict[str, Any]] = {}
    joined = []
    for entry in entries:
        before = last.get(entry["port"])
        if before is not None and before["way"] == entry["way"] and entry["way"] != "open":
            before["bytes"] += entry["bytes"]
        else:
            last[entry["port"]] = dict(entry)
            joined.append(last[entry["port"]])
    return joined


def _json(value: Any) -> str:
    return json.dumps(value, indent=1, ensure_ascii=False) + "\n"
