"""Lines of G-code taken apart into words."""

import re
from collections.abc import Iterator
from typing import NamedTuple

from firmware_sim.grbl.errors import Code, GrblError

LONGEST_LINE = 79
"""Characters that fit the controller's line buffer, spaces and comments not counted."""

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)")


class Word(NamedTuple):
    """A letter and its number."""

    letter: str
    value: float


class LineFilter:
    """Collects the characters of a line: no spaces, no comments, all in upper case."""

    def __init__(self) -> None:
        self._text = ""
        self._comment = ""
        self._overflow = False

    def add(self, character: str) -> None:
        if self._comment or self._overflow:
            if character == ")" and self._comment == "(":
                self._comment = ""
        elif character in "(;":
            self._comment = character
        elif character > " " and character != "/":
            self._overflow = len(self._text) >= LONGEST_LINE
            self._text += "" if self._overflow else character.upper()

    def finish(self) -> str:
        """Return the line, and be ready for the next.

        Raises
        ------
        GrblError
            The line was longer than the buffer; nothing of it counts.
        """
        text, overflow = self._text, self._overflow
        self._text, self._comment, self._overflow = "", "", False
        if overflow:
            raise GrblError(Code.LINE_OVERFLOW)
        return text


def read_number(text: str, start: int) -> tuple[float, int]:
    """Read a number; return it and the place behind it. There is no exponent in G-code."""
    found = _NUMBER.match(text, start)
    if found is None:
        raise GrblError(Code.BAD_NUMBER_FORMAT)
    return float(found.group()), found.end()


def split_words(text: str) -> Iterator[Word]:
    """Take a filtered line apart."""
    place = 0
    while place < len(text):
        letter = text[place]
        if not ("A" <= letter <= "Z"):
            raise GrblError(Code.EXPECTED_COMMAND_LETTER)
        value, place = read_number(text, place + 1)
        yield Word(letter, value)
