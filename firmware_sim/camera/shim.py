"""The camera shim, compiled once for this machine and kept in the user's cache folder."""

import hashlib
import os
import shutil
import subprocess
import tempfile
from importlib.resources import files
from pathlib import Path

import platformdirs

from firmware_sim.camera.shared_frame import c_header
from firmware_sim.errors import SimToolError

INSTALL_HINT = "install one with: apt-get install gcc libc6-dev"


def source() -> str:
    """Return the C text of the shim, with the layout of the shared memory ahead of it."""
    return (
        "#define _GNU_SOURCE\n" + c_header() + files("firmware_sim.camera").joinpath("v4l2_shim.c").read_text("utf-8")
    )


def compiled_shim(cache: Path | None = None) -> Path:
    """Return the shared library to preload; compile it if this source has not been compiled yet.

    Parameters
    ----------
    cache : folder to keep it in, by default the user's cache folder for litrig

    Raises
    ------
    SimToolError
        There is no C compiler, or it fails.
    """
    text = source()
    folder = cache or Path(platformdirs.user_cache_dir("litrig")) / "sim"
    library = folder / f"v4l2_shim-{hashlib.sha256(text.encode()).hexdigest()[:16]}.so"
    if not library.exists():
        folder.mkdir(parents=True, exist_ok=True)
        _compile(text, library)
    return library


def _compile(text: str, library: Path) -> None:
    compiler = shutil.which(os.environ.get("CC", "cc"))
    if compiler is None:
        raise SimToolError(f"the simulated camera needs a C compiler and there is none; {INSTALL_HINT}")
    with tempfile.TemporaryDirectory(dir=library.parent) as folder:
        built = Path(folder) / "shim.so"
        options = ["-O2", "-fPIC", "-shared", "-x", "c", "-", "-o", str(built), "-ldl", "-lpthread"]
        result = subprocess.run([compiler, *options], input=text, capture_output=True, text=True, check=False)
        if result.returncode:
            last = (result.stderr.strip() or "no message").splitlines()[0]
            raise SimToolError(f"{compiler} cannot compile the simulated camera ({last}); {INSTALL_HINT}")
        built.replace(library)
