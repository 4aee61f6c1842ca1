"""Keeping libraries quiet that write to the standard streams, by Python's print or from below it."""

import io
import os
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from threading import Lock

_STREAMS = (1, 2)
_ONE_AT_A_TIME = Lock()


@contextmanager
def quiet_library() -> Iterator[None]:
    """Send both standard streams of the process nowhere while the body runs.

    For short calls only: what other threads write meanwhile is lost too.
    """
    with _ONE_AT_A_TIME:
        kept = [os.dup(stream) for stream in _STREAMS]
        nowhere = os.open(os.devnull, os.O_WRONLY)
        try:
            for stream in _STREAMS:
                os.dup2(nowhere, stream)
            # What is printed through Python waits in its buffer, and would come out when the streams are back.
            with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
                yield
        finally:
            for stream, copy in zip(_STREAMS, kept, strict=True):
                os.dup2(copy, stream)
                os.close(copy)
            os.close(nowhere)
