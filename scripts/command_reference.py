"""Write the command reference from the parser itself, or check that the written one is up to date."""

import sys
from collections.abc import Iterator
from pathlib import Path

import click

from litrig.commands import cli

INTRODUCTION = """# Commands

This page is made from the commands' own help (`make docs`); `litrig COMMAND --help` prints the same.
"""


def sections(command: click.Command, name: str, parent: click.Context | None = None) -> Iterator[str]:
    """Yield a section for a command and for everything below it."""
    context = click.Context(command, info_name=name, parent=parent, terminal_width=100, max_content_width=100)
    title = context.command_path
    heading = "##" if parent is None or parent.parent is None else "###"
    yield f"{heading} {title}\n\n```text\n{command.get_help(context)}\n```\n"
    if isinstance(command, click.Group):
        for child in command.list_commands(context):
            yield from sections(command.commands[child], child, context)


def main() -> None:
    """Write or check, as the arguments say."""
    *options, path = sys.argv[1:]
    text = "\n".join([INTRODUCTION, *sections(cli, "litrig")])
    if "--check" not in options:
        Path(path).write_text(text, encoding="utf-8")
    elif not Path(path).is_file() or Path(path).read_text(encoding="utf-8") != text:
        sys.exit(f"{path} does not match the commands; run: make docs")


main()
