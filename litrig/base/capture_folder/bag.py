"""Closing a capture folder as a valid BagIt 1.0 bag (RFC 8493), and checking one."""

import hashlib
import logging
import re
from collections.abc import Collection, Iterable, Mapping
from datetime import UTC, datetime
from pathlib import Path

import bagit

from litrig.base.capture_folder import layout
from litrig.base.errors import InputError, LitrigError
from litrig.base.files import resolve_inside, write_atomically
from litrig.base.store import DISK, Store

_CHUNK_BYTES = 1 << 20
_CHANGED = "changed since the bag was closed"


def sha256_of(path: Path) -> str:
    """Digest a file in pieces."""
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while chunk := file.read(_CHUNK_BYTES):
            digest.update(chunk)
    return digest.hexdigest()


def close_bag(folder: Path, known_digests: Mapping[str, str], info: Mapping[str, str], store: Store = DISK) -> None:
    """Write the tag files that make the folder a complete bag; the tag manifest comes last and completes it.

    Parameters
    ----------
    known_digests : sha256 by path relative to the folder, of files that are never rewritten: read once when they were
        stored, and not again
    info : what to say in bag-info.txt besides date and size

    Raises
    ------
    InputError
        The disk is full or gone; the bag is not complete then.
    """
    payload = sorted(path for path in (folder / "data").rglob("*") if path.is_file())
    digests = {path.relative_to(folder).as_posix(): "" for path in payload}
    others = [path for path, name in zip(payload, digests, strict=True) if name not in known_digests]
    _make_durable(others, store)
    for path, name in zip(payload, digests, strict=True):
        digests[name] = known_digests.get(name) or sha256_of(path)
    size = sum(path.stat().st_size for path in payload)
    lines = {
        **info,
        "Bagging-Date": datetime.now(UTC).date().isoformat(),
        "Payload-Oxum": f"{size}.{len(payload)}",
    }
    about = "".join(f"{key}: {lines[key]}\n" for key in sorted(lines))
    write_atomically(folder / layout.MANIFEST, _manifest(digests), store=store)
    write_atomically(folder / layout.BAG_INFO, about.encode(), store=store)
    tags = {name: sha256_of(folder / name) for name in (layout.BAGIT, layout.BAG_INFO, layout.MANIFEST)}
    write_atomically(folder / layout.TAG_MANIFEST, _manifest(tags), store=store)


def _make_durable(paths: Iterable[Path], store: Store) -> None:
    """Sync what was written without: a manifest must not promise what a power cut can still take back."""
    above = set()
    try:
        for path in paths:
            store.sync(path)
            above.add(path.parent)
        for folder in sorted(above):
            store.sync_folder(folder)
    except OSError as error:
        raise InputError(f"{error.filename}: cannot be made durable ({error.strerror}); check the disk") from error


def bag_findings(folder: Path, known: Collection[str] = ()) -> list[str]:
    """Check a closed bag; name every missing, foreign and changed file, all at once.

    What is found to be in order here is read once more by the Library of Congress's reader, whose word counts.

    Parameters
    ----------
    known : names below the folder of files that are known to be missing or changed: not named again
    """
    findings: list[str] = []
    tags = _entries(folder / layout.TAG_MANIFEST, findings)
    payload = _entries(folder / layout.MANIFEST, findings)
    named = {**payload, **tags}
    looked_at = sorted(set(named) - set(known))
    for name in looked_at:
        if finding := _finding(folder, name, named[name]):
            doubt = f", or its line in {layout.TAG_MANIFEST}" if name in tags and finding is _CHANGED else ""
            findings.append(f"{name}: {finding}{doubt}")
    there = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if not path.is_dir()}
    strangers = there - set(named) - {layout.TAG_MANIFEST} - set(known)
    findings += [f"{name}: on the disk, not in the manifest" for name in sorted(strangers)]
    if not findings and not known:
        logging.getLogger("bagit").setLevel(logging.CRITICAL)  # it logs what we return
        try:
            bagit.Bag(str(folder)).validate()
        except (bagit.BagError, OSError, ValueError, KeyError) as error:
            findings.append(str(error))
    return findings


def _entries(manifest: Path, findings: list[str]) -> dict[str, str]:
    """Read the digests of a manifest by file; a line that is none is a finding."""
    digests = {}
    for number, line in enumerate(manifest.read_bytes().splitlines(), 1):
        digest, _, name = line.decode("utf-8", "replace").partition("  ")
        if re.fullmatch("[0-9a-f]{64}", digest) and name:
            digests[_unescape(name)] = digest
        else:
            findings.append(f"{manifest.name}, line {number}: is no line of a manifest; restore the file from a copy")
    return digests


def _finding(folder: Path, name: str, digest: str) -> str:
    try:
        path = resolve_inside(folder, name)
        if not path.is_file():
            return "in the manifest, not on the disk"
        return "" if sha256_of(path) == digest else _CHANGED
    except (LitrigError, OSError, ValueError) as error:
        return str(error)


def _manifest(digests: Mapping[str, str]) -> bytes:
    return "".join(f"{digests[name]}  {_escape(name)}\n" for name in sorted(digests)).encode()


def _escape(name: str) -> str:
    return name.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _unescape(name: str) -> str:
    return name.replace("%0D", "\r").replace("%0A", "\n").replace("%25", "%")
