"""Rendered pictures on disk, so that nothing is rendered twice.

A folder for what the pictures have in common (scene, renderer), one below for each picture size, and a file for each
pose, whose name is the pose. A file is a `.npy` of half floats with the SHA-256 of that at its end.
"""

import hashlib
import io
import os
import tempfile
from contextlib import suppress
from pathlib import Path

import numpy as np
import platformdirs

from firmware_sim.scene.pose import F32, Pose, Size

LIMIT_BYTES = 2_000_000_000
"""What all pictures together may take; those that were not used for longest go first."""
HEADER_BYTES, DIGEST_BYTES = 128, 32
BRIGHTEST = 65_504.0
"""The largest half float. Light of 1 fills a pixel in 10 ms, so no exposure that the camera has tells it from more."""


def default_root() -> Path:
    """Return the folder of all rendered pictures of this user."""
    return Path(platformdirs.user_cache_dir("litrig")) / "sim" / "frames"


class FrameCache:
    """The pictures of one scene.

    Parameters
    ----------
    root : folder of all scenes' pictures; made when the first one is stored
    scene : everything that the scene's appearance depends on, as text
    renderer : name and version of what renders it
    limit_bytes : cap on all that lies below `root`
    """

    def __init__(self, root: Path, scene: str, renderer: str, limit_bytes: int = LIMIT_BYTES) -> None:
        self._root = root
        self._folder = root / hashlib.sha256(f"{renderer}\n{scene}".encode()).hexdigest()[:32]
        self.limit_bytes = limit_bytes

    def load(self, pose: Pose, size: Size) -> F32 | None:
        """Return a picture (H, W, 3), or None if it is not there; a damaged one is removed, and is not there."""
        path = self.path(pose, size)
        try:
            if path.stat().st_size != file_bytes(size):
                raise ValueError("wrong length")  # noqa: TRY301  # damaged is damaged, however it shows
            frame = _decode(path.read_bytes(), size)
        except FileNotFoundError:
            return None
        except (ValueError, OSError):
            path.unlink(missing_ok=True)
            return None
        with suppress(OSError):
            os.utime(path)  # used just now
        return frame

    def store(self, pose: Pose, size: Size, frame: F32) -> None:
        """Keep a picture (H, W, 3): the file appears whole or not at all. What exceeds the cap goes."""
        path = self.path(pose, size)
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=".part")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(_encode(frame))
            Path(temporary).replace(path)
        finally:
            Path(temporary).unlink(missing_ok=True)
        self._trim()

    def poses(self, size: Size) -> list[Pose]:
        """Return the poses whose pictures are there, in that size."""
        with suppress(FileNotFoundError):
            names = (entry.name for entry in os.scandir(self.path(Pose(0, 0, 0, 1), size).parent))
            return [pose for name in names if (pose := _pose(name)) is not None]
        return []

    def path(self, pose: Pose, size: Size) -> Path:
        """Return the file of a picture, there or not. The pose is one that `standard` gives."""
        name = "_".join(f"{value:.3f}" for value in pose[:4])
        return self._folder / f"{size[1]}x{size[0]}" / f"{name}.npy"

    def _trim(self) -> None:
        files = []
        for path in self._root.glob("*/*/*.npy"):
            with suppress(FileNotFoundError):  # another simulator may trim, too
                files.append((path.stat().st_mtime_ns, path.stat().st_size, path))
        excess = sum(length for _, length, _ in files) - self.limit_bytes
        for _, length, path in sorted(files):
            if excess <= 0:
                break
            path.unlink(missing_ok=True)
            excess -= length


def file_bytes(size: Size) -> int:
    """Return the length of a picture's file."""
    return HEADER_BYTES + size[0] * size[1] * 3 * 2 + DIGEST_BYTES


def _encode(frame: F32) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, np.minimum(frame, BRIGHTEST).astype(np.float16), allow_pickle=False)
    content = buffer.getvalue()
    return content + hashlib.sha256(content).digest()


def _decode(stored: bytes, size: Size) -> F32:
    content, digest = stored[:-DIGEST_BYTES], stored[-DIGEST_BYTES:]
    if hashlib.sha256(content).digest() != digest:
        raise ValueError("damaged")
    frame = np.load(io.BytesIO(content), allow_pickle=False)
    if frame.shape != (*size, 3) or frame.dtype != np.float16:
        raise ValueError("not a picture of this size")
    return np.asarray(frame, np.float32)


def _pose(name: str) -> Pose | None:
    if not name.endswith(".npy"):
        return None
    try:
        turntable_deg, azimuth_deg, elevation_deg, lamp = map(float, name.removesuffix(".npy").split("_"))
    except ValueError:
        return None
    return Pose(turntable_deg, azimuth_deg, elevation_deg, lamp)
