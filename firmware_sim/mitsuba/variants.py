"""Which of mitsuba's variants works on this machine.

`llvm_ad_rgb` compiles kernels and is many times faster than `scalar_rgb`, but with an unsuitable libLLVM it does not
raise: it aborts the process. So it is tried in a process of its own, on a small render, before anybody relies on it.
"""

import functools
import hashlib
import importlib
import importlib.metadata
import importlib.util
import os
import platform
import subprocess
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from platformdirs import user_cache_path

from firmware_sim.errors import SimError

FAST, SAFE = "llvm_ad_rgb", "scalar_rgb"
_PROBE_TIMEOUT_S = 120
_PROBE_PROGRAM = f"""
import mitsuba as mi
mi.set_variant({FAST!r})
scene = mi.load_dict({{"type": "scene", "light": {{"type": "constant"}}, "ball": {{"type": "sphere",
    "bsdf": {{"type": "roughconductor", "material": "Al"}}}}, "sensor": {{"type": "perspective",
    "to_world": mi.ScalarTransform4f().look_at([0, 0, 4], [0, 0, 0], [0, 1, 0]),
    "film": {{"type": "hdrfilm", "width": 8, "height": 8}}}}, "integrator": {{"type": "direct"}}}})
assert float(mi.render(scene, spp=1).array[0]) > 0
"""
PROBE = (sys.executable, "-c", _PROBE_PROGRAM)


class MitsubaMissingError(SimError):
    """mitsuba cannot be imported: install what the message names."""


class Budget(NamedTuple):
    """What a test or a table can afford with a variant.

    Attributes
    ----------
    side_px : side of a square picture
    samples : paths a pixel
    """

    side_px: int
    samples: int


def budget(variant: str) -> Budget:
    """Return fewer pixels and samples for the variant that interprets its scenes."""
    return Budget(96, 64) if variant == FAST else Budget(64, 48)


def best_variant() -> str:
    """Return the fastest variant that works here, `llvm_ad_rgb` or `scalar_rgb`.

    The answer is kept for the process, and in the user's cache folder for the same mitsuba and libLLVM.

    Raises
    ------
    MitsubaMissingError
        mitsuba is not installed.
    """
    require_mitsuba()
    return _remembered_variant()


@functools.cache
def _remembered_variant() -> str:
    return probe_once(user_cache_path("litrig") / "mitsuba", PROBE)


def require_mitsuba() -> None:
    """Raise `MitsubaMissingError` unless mitsuba is installed; nothing is imported."""
    if importlib.util.find_spec("mitsuba") is None:
        raise MitsubaMissingError("mitsuba is not installed; pip install 'litrig[sim]'")


def load_mitsuba(variant: str) -> Any:  # mitsuba's types differ from variant to variant
    """Return the module `mitsuba` with this variant set.

    Raises
    ------
    MitsubaMissingError
        mitsuba is not installed, or a library that it needs is missing.
    """
    require_mitsuba()
    with warnings.catch_warnings():
        # Its native modules lack attributes that newer Pythons ask for; that is not ours to mend.
        warnings.simplefilter("ignore", DeprecationWarning)
        try:
            mitsuba = importlib.import_module("mitsuba")
            if mitsuba.variant() != variant:
                mitsuba.set_variant(variant)
        except (ImportError, NameError) as error:  # a missing libatomic1 shows as a NameError
            raise MitsubaMissingError(
                f"mitsuba does not load ({error}); apt-get install libatomic1, or reinstall litrig[sim]"
            ) from error
    return mitsuba


def probe_once(cache: Path, command: Sequence[str]) -> str:
    """Return what the cache says of this mitsuba and libLLVM, or probe and write it there.

    A cache that cannot be written costs another probe next time, nothing else.
    """
    note = cache / f"variant-{fingerprint()}"
    try:
        known = note.read_text("utf-8").strip()
    except (OSError, UnicodeDecodeError):
        known = ""
    if known in (FAST, SAFE):
        return known
    variant = FAST if probe(command) else SAFE
    try:
        cache.mkdir(parents=True, exist_ok=True)
        note.write_text(variant + "\n", "utf-8")
    except OSError:
        return variant
    return variant


def probe(command: Sequence[str]) -> bool:
    """Tell whether a program ends well; an abort, an error and a hang are all a no."""
    try:
        return subprocess.run(command, capture_output=True, timeout=_PROBE_TIMEOUT_S, check=False).returncode == 0
    except (OSError, subprocess.TimeoutExpired):
        return False


def fingerprint() -> str:
    """Return a digest of all that the answer depends on: mitsuba, its compiler library, the machine."""
    parts = [importlib.metadata.version("mitsuba"), importlib.metadata.version("drjit"), platform.machine()]
    parts += [os.environ.get("DRJIT_LIBLLVM_PATH", ""), *_llvm_libraries()]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:16]


def _llvm_libraries() -> list[str]:
    folders = ["/usr/lib", "/usr/lib64", "/usr/local/lib", f"/usr/lib/{platform.machine()}-linux-gnu"]
    found = [path for folder in folders for path in Path(folder).glob("libLLVM*.so*")]
    found += Path("/usr/lib").glob("llvm-*/lib/libLLVM*.so*")
    return sorted(f"{path} {path.stat().st_size}" for path in found if path.is_file())
