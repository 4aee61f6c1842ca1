"""Closing a capture folder as a valid BagIt 1.0 bag (RFC 8493), and checking one."""

import hashlib
import logging
from collections.abc import Collection, Mapping
from datetime import UTC, datetime
from pathlib import Path

import bagit

from litrig.base.capture_folder import layout
from litrig.base.errors import LitrigError
from litrig.base.files import resolve_inside, write_atomically

_CHUNK_BYTES = 1 << 20


def sha256_of(path: Path) -> str:
    """Digest a file in pieces."""
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while chunk := file.read(_CHUNK_BYTES):
            digest.update(chunk)
    return digest.hexdigest()


def close_bag(folder: Path, known_digests: Mapping[str, str], info: Mapping[str, str]) -> None:
    """Write the tag files that make the folder a complete bag; the tag manifest comes last and completes it.

    Parameters
    ----------
    known_digests : sha256 by path relative to the folder, of files that are never rewritten: read once when they were
        stored, and not again
    info : what to say in bag-info.txt besides date and size
    """
    payload = sorted(path for path in (folder / "data").rglob("*") if path.is_file())
    digests = {}
    for path in payload:
        name = path.relative_to(folder).as_posix()
        digests[name] = known_digests.get(name) or sha256_of(path)
    size = sum(path.stat().st_size for path in payload)
    lines = {
        **info,
        "Bagging-Date": datetime.now(UTC).date().isoformat(),
        "Payload-Oxum": f"{size}.{len(payload)}",
    }
    write_atomically(folder / layout.MANIFEST, _manifest(digests))
    write_atomically(folder / layout.BAG_INFO, "".join(f"{key}: {lines[key]}\n" for key in sorted(lines)).encode())
    tags = (layout.BAGIT, layout.BAG_INFO, layout.MANIFEST)
    write_atomically(folder / layout.TAG_MANIFEST, _manifest({name: sha256_of(folder / name) for name in tags}))


def bag_findings(folder: Path, known: Collection[str] = ()) -> list[str]:
    """Check a closed bag with the Library of Congress's reader; name every missing, foreign and changed file.

    Parameters
    ----------
    known : names below the folder of files that are known to be missing or changed: not named again
    """
    logging.getLogger("bagit").setLevel(logging.CRITICAL)  # it logs what we return
    try:
        bag = bagit.Bag(str(folder))
        missing, foreign = bag.compare_manifests_with_fs()
        findings = [f"{name}: in the manifest, not on the disk" for name in sorted(set(missing) - set(known))]
        findings += [f"{name}: on the disk, not in the manifest" for name in sorted(foreign)]
        findings += [
            f"{name}: changed since the bag was closed"
            for name, digests in sorted(bag.payload_entries().items())
            if name not in missing
            and name not in known
            and sha256_of(resolve_inside(folder, name)) != digests["sha256"]
        ]
        if not findings and not known:
            bag.validate()
    except (bagit.BagError, LitrigError, OSError, ValueError, KeyError) as error:
        return [str(error)]
    return findings


def _manifest(digests: Mapping[str, str]) -> bytes:
    return "".join(f"{digests[name]}  {_escape(name)}\n" for name in sorted(digests)).encode()


def _escape(name: str) -> str:
    return name.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")
