"""Where things lie in a capture folder: a BagIt bag from its first second, its payload under `data/`."""

from pathlib import Path

JOURNAL = "data/journal.jsonl"
SESSION = "data/session.toml"
PLAN = "data/plan.jsonl"
CRATE = "data/ro-crate-metadata.json"
NOTES = "data/notes.md"
FRAMES = "data/frames"
THUMBS = "data/thumbs"

BAGIT = "bagit.txt"
BAG_INFO = "bag-info.txt"
MANIFEST = "manifest-sha256.txt"
TAG_MANIFEST = "tagmanifest-sha256.txt"

BAGIT_DECLARATION = "BagIt-Version: 1.0\nTag-File-Character-Encoding: UTF-8\n"


def is_capture_folder(folder: Path) -> bool:
    """Tell a capture folder from a plain folder of pictures."""
    return (folder / JOURNAL).is_file() or (folder / BAGIT).is_file()


def is_closed(folder: Path) -> bool:
    """Tell whether the bag is complete: its manifest stands."""
    return (folder / MANIFEST).is_file() and (folder / TAG_MANIFEST).is_file()
