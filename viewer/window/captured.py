"""What libraries below Python say on standard error, kept for an error message of ours."""

import os
import tempfile
from types import TracebackType
from typing import Self


class CapturedErrors:
    """Standard error of the process goes into a file until it is let go; what was written can be asked for."""

    def __enter__(self) -> Self:
        self._file = tempfile.TemporaryFile()
        self._kept: int | None = os.dup(2)
        os.dup2(self._file.fileno(), 2)
        return self

    def let_go(self) -> None:
        """Let standard error be heard again; safe twice."""
        if self._kept is not None:
            os.dup2(self._kept, 2)
            os.close(self._kept)
            self._kept = None

    def lines(self) -> list[str]:
        """Return what was written meanwhile."""
        self._file.seek(0)
        return self._file.read().decode(errors="replace").splitlines()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.let_go()
        self._file.close()
