"""The version that every file names as its maker."""

from importlib.metadata import PackageNotFoundError, version


def litrig_version() -> str:
    """Return the installed version, or "unknown" in a bare source tree."""
    try:
        return version("litrig")
    except PackageNotFoundError:
        return "unknown"
