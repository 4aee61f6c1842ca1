"""Ambient occlusion on disk, so that no mesh is cast twice.

A file for each mesh and each way of casting, named by the digest of both: float32 numbers with their SHA-256 at the
end.
"""

import hashlib
import math
import os
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import platformdirs
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.files import write_atomically
from processing.mesh.model import Mesh
from processing.mesh.occlusion import RAYS, ambient_occlusion

F32 = NDArray[np.float32]

LIMIT_BYTES = 256_000_000
"""What all files together may take; those that were not used for longest go first."""
_VERSION = "1"
"""Changes with what `ambient_occlusion` gives for the same arguments."""
_DIGEST_BYTES = 32


def default_folder() -> Path:
    """Return the folder of this user's ambient occlusion, as XDG_CACHE_HOME has it."""
    return Path(platformdirs.user_cache_dir("litrig")) / "occlusion"


def with_occlusion(mesh: Mesh, *, rays: int = RAYS, reach: float = math.inf, folder: Path | None = None) -> Mesh:
    """Return the mesh with its ambient occlusion, from the cache if it is there.

    Parameters
    ----------
    rays, reach : as `ambient_occlusion` takes them
    folder : of the cache; the user's by default. One that cannot be written is done without

    Raises
    ------
    InputError, MissingToolError
        As `ambient_occlusion`.
    """
    folder = folder or default_folder()
    path = folder / f"{_key(mesh, rays, reach)}.f32"
    found = _load(path, len(mesh.positions))
    if found is None:
        found = ambient_occlusion(mesh, rays=rays, reach=reach)
        with suppress(OSError, InputError):  # a full disk or a foreign folder costs time only
            _store(path, found)
    return replace(mesh, occlusion=found)


def _key(mesh: Mesh, rays: int, reach: float) -> str:
    digest = hashlib.sha256(f"{_VERSION} {rays} {reach!r} {len(mesh.positions)} {len(mesh.triangles)}".encode())
    for array, kind in ((mesh.positions, "<f4"), (mesh.normals, "<f4"), (mesh.triangles, "<i4")):
        digest.update(np.ascontiguousarray(array, kind).tobytes())
    return digest.hexdigest()


def _load(path: Path, count: int) -> F32 | None:
    """Return what a file holds; a damaged one is removed, and is not there."""
    try:
        if path.stat().st_size != count * 4 + _DIGEST_BYTES:
            raise ValueError("wrong length")  # noqa: TRY301  # damaged is damaged, however it shows
        stored = path.read_bytes()
        content, digest = stored[:-_DIGEST_BYTES], stored[-_DIGEST_BYTES:]
        if hashlib.sha256(content).digest() != digest:
            raise ValueError("damaged")  # noqa: TRY301
    except FileNotFoundError:
        return None
    except (ValueError, OSError):
        with suppress(OSError):
            path.unlink(missing_ok=True)
        return None
    with suppress(OSError):
        os.utime(path)  # used just now
    return np.frombuffer(content, "<f4").astype(np.float32)


def _store(path: Path, occlusion: F32) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    content = occlusion.astype("<f4").tobytes()
    write_atomically(path, content, hashlib.sha256(content).digest())
    _trim(path.parent)


def _trim(folder: Path) -> None:
    files = []
    for path in folder.glob("*.f32"):
        with suppress(FileNotFoundError):  # another litrig may trim, too
            files.append((path.stat().st_mtime_ns, path.stat().st_size, path))
    excess = sum(length for _, length, _ in files) - LIMIT_BYTES
    for _, length, path in sorted(files):
        if excess <= 0:
            break
        path.unlink(missing_ok=True)
        excess -= length
