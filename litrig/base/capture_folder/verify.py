"""Does a capture folder hold what its journal and its manifest say? All findings at once, nothing is touched."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from litrig.base.capture_folder import layout
from litrig.base.capture_folder.bag import bag_findings, sha256_of
from litrig.base.capture_folder.frame_line import check_frame_lines
from litrig.base.capture_folder.journal import Entry, known_harm, read_journal
from litrig.base.capture_folder.session_file import vouched_for
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
    harmed : frame files that are not as they were shot, as the journal says itself: they were shot again
    """

    frames: int
    closed: bool
    findings: tuple[str, ...]
    orphans: tuple[str, ...]
    harmed: tuple[str, ...] = ()


def verify_capture(folder: Path) -> Verification:
    """Check every file of a session against its journal, and the bag against its manifests.

    Raises
    ------
    InputError, FormatError
        It is not a capture folder, or its journal's lines are whole and do not say what they must.
    """
    if not layout.is_capture_folder(folder):
        raise InputError(f"{folder}: not a capture folder (no {layout.JOURNAL}); name the folder given to capture -o")
    wrong: dict[str, str] = {}
    try:
        journal = read_journal(folder / layout.JOURNAL)
    except LitrigError as error:
        journal, wrong[layout.JOURNAL] = [], str(error)
    check_frame_lines(journal, folder / layout.JOURNAL)
    entries = [entry for entry in journal if entry["ev"] == "frame"]
    harmed = known_harm(journal)
    sound = (entry for entry in entries if entry["file"] not in harmed)
    wrong |= {entry["file"]: finding for entry in sound if (finding := _frame_finding(folder, entry))}
    for file, digest in vouched_for(journal).items():
        if finding := _settings_finding(folder, file, digest):
            wrong[file] = finding
    findings = [f"{file}: {finding}" for file, finding in wrong.items()]
    findings += _tag_findings(folder) or bag_findings(folder, wrong)
    orphans = tuple(orphans_of(folder, entries))
    return Verification(len(entries), layout.is_closed(folder), tuple(findings), orphans, tuple(sorted(harmed)))


def orphans_of(folder: Path, entries: Iterable[Entry]) -> list[str]:
    """Name the frame files that no line of the journal speaks of: shot, but never acknowledged."""
    named = {entry["file"] for entry in entries if entry["ev"] == "frame"}
    there = {path.relative_to(folder).as_posix() for path in (folder / layout.FRAMES).glob("*")}
    return sorted(there - named)


def _frame_finding(folder: Path, entry: Entry) -> str:
    try:
        path = resolve_inside(folder, entry["file"])
    except LitrigError as error:
        return str(error)
    if not path.is_file():
        return "in the journal, not on the disk"
    return "" if sha256_of(path) == entry["sha256"] else "changed since it was captured"


def _settings_finding(folder: Path, file: str, digest: str) -> str:
    path = resolve_inside(folder, file)
    if not path.is_file():
        return "not on the disk"
    return "" if sha256_of(path) == digest else "changed since the session began"


def _tag_findings(folder: Path) -> list[str]:
    """Say what keeps the bag from being checked: the last files of a session, all of them or some."""
    tags = (layout.MANIFEST, layout.TAG_MANIFEST)
    missing = [name for name in tags if not (folder / name).is_file()]
    if len(missing) == len(tags):
        return ["the session was not closed: the bag has no manifest yet"]
    return [f"{name}: missing, so that the bag is not complete; restore it from a copy" for name in missing]
