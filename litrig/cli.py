"""The front door: it opens at once, and loads what is behind it where an interrupt is already one line."""

import signal
import sys

INTERRUPTED_STATUS = 130


def main() -> None:
    """Run the command."""
    try:
        from litrig.commands import run

        status = run()
    except KeyboardInterrupt:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        sys.stderr.write("litrig: interrupted\n")
        status = INTERRUPTED_STATUS
    sys.exit(status)
