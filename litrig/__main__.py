"""`python -m litrig` is the command."""

from litrig.cli import main

main()
