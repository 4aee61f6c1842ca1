"""Pages in a real browser."""

import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.pictures import read_codes

needs_browser = pytest.mark.skipif(shutil.which("chromium") is None, reason="needs Chromium")
OPTIONS = ("--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking")


def look_at(page: Path, folder: Path) -> NDArray[np.integer]:
    """Return what Chromium shows of a page, (H, W, 3); `folder` takes what it writes."""
    shot = folder / "page.png"
    subprocess.run(
        [
            "chromium",
            *OPTIONS,
            f"--user-data-dir={folder}",
            "--window-size=1280,2400",
            f"--screenshot={shot}",
            page.as_uri(),
        ],
        check=True,
        capture_output=True,
        timeout=120,
        env={**os.environ, "HOME": str(folder)},
    )
    return read_codes(shot)
