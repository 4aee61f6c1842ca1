"""Does a capture folder hold what its journal and its manifest say? All findings at once, nothing is touched."""

from dataclasses import dataclass
from pathlib import Path

from litrig.base.capture_folder import layout
from litrig.base.capture_folder.bag import bag_findings, sha256_of
from litrig.base.capture_folder.journal import Entry, read_journal
from litrig.base.errors import InputError, LitrigError
from litrig.base.files import resolve_inside


@dataclass(frozen=True)
class Verification:
    """What `verify_capture` found.

    Attributes
    ----------
    frames : frames that the journal acknowledges
    closed : the folder claims to be a complete bag
    findings : all that is wrong, a sentence each; empty if nothing is
    orphans : frame files that no journal line speaks of: shot, but never acknowledged
    """

    frames: int
    closed: bool
    findings: tuple[str, ...]
    orphans: tuple[str, ...]


def verify_capture(folder: Path) -> Verification:
    """Check every file of a session against its journal, and the bag against its manifests.

    Raises
    ------
    InputError
        It is not a capture folder.
    """
    if not layout.is_capture_folder(folder):
        raise InputError(f"{folder}: not a capture folder (no {layout.JOURNAL}); name the folder given to capture -o")
    entries = [entry for entry in read_journal(folder / layout.JOURNAL) if entry["ev"] == "frame"]
    findings = [finding for entry in entries if (finding := _frame_finding(folder, entry))]
    closed = layout.is_closed(folder)
    if closed:
        findings += bag_findings(folder)
    else:
        findings.append("the session was not closed: the bag has no manifest yet")
    named = {entry["file"] for entry in entries}
    found = {path.relative_to(folder).as_posix() for path in (folder / layout.FRAMES).glob("*")}
    return Verification(len(entries), closed, tuple(findings), tuple(sorted(found - named)))


def _frame_finding(folder: Path, entry: Entry) -> str:
    try:
        path = resolve_inside(folder, entry["file"])
    except LitrigError as error:
        return str(error)
    if not path.is_file():
        return f"{entry['file']}: in the journal, not on the disk"
    if sha256_of(path) != entry["sha256"]:
        return f"{entry['file']}: changed since it was captured"
    return ""
