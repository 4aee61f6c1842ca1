"""The HTML page kit: plain pages that lie beside their pictures and need nothing from outside their folder."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined

from litrig.base.files import write_atomically
from litrig.base.version import litrig_version


@dataclass(frozen=True)
class Figure:
    """A picture, or a video that plays in a loop, with a caption.

    Attributes
    ----------
    file : path relative to the page; .mp4 is a video
    wide : takes the page's whole width
    size : width and height in pixels, so that the page does not jump while it loads
    """

    file: str
    caption: str
    wide: bool = False
    size: tuple[int, int] | None = None


@dataclass(frozen=True)
class Table:
    """Headings, or none, and rows of as many cells each; numbers are set flush right."""

    headings: Sequence[str]
    rows: Sequence[Sequence[str | float]]


@dataclass(frozen=True)
class Section:
    """A part of a page.

    Attributes
    ----------
    columns : figures a row; a wide one takes a row of its own
    folded : words to click on before the table is seen; empty if it is seen at once
    """

    title: str
    text: str = ""
    figures: Sequence[Figure] = field(default_factory=tuple)
    table: Table | None = None
    columns: int = 4
    folded: str = ""


def write_page(path: Path, title: str, lead: str, sections: Sequence[Section]) -> None:
    """Write a page; every text is escaped."""
    environment = Environment(
        loader=PackageLoader("litrig.base", "."), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    template = environment.get_template("page.html.j2")
    html = template.render(title=title, lead=lead, sections=sections, version=litrig_version())
    write_atomically(path, html.encode())
