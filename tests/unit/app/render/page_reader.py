"""Reads a page as a browser would, strictly."""

from dataclasses import dataclass, field
from html.parser import HTMLParser

_VOID = {"meta", "br", "hr", "img", "link", "input"}


@dataclass
class Page:
    """What a page holds.

    Attributes:
        text: all text outside style, blanks joined.
        attributes: (tag, name, value) of each attribute.
        headings: texts of h2.
        rows: cells of each table row.
        tags: every opened tag.
    """

    text: str = ""
    attributes: list[tuple[str, str, str]] = field(default_factory=list)
    headings: list[str] = field(default_factory=list)
    rows: list[list[str]] = field(default_factory=list)
    tags: list[str] = field(default_factory=list)

    def row(self, name: str) -> list[str]:
        """Return the cells beside a row's name."""
        return next(row[1:] for row in self.rows if row[0] == name)

    def all_of(self, attribute: str) -> list[str]:
        """Return the values of an attribute wherever it stands."""
        return [value for _, name, value in self.attributes if name == attribute]


class _Reader(HTMLParser):
    def __init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.page = Page()
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_startendtag(tag, attrs)
        if tag not in _VOID:
            self.open.append(tag)
        if tag == "h2":
            self.page.headings.append("")
        elif tag == "tr":
            self.page.rows.append([])
        elif tag in {"td", "th"}:
            self.page.rows[-1].append("")

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.page.tags.append(tag)
        self.page.attributes += [(tag, name, value or "") for name, value in attrs]

    def handle_endtag(self, tag: str) -> None:
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop() == tag, f"</{tag}> is out of order"

    def handle_data(self, data: str) -> None:
        if "style" in self.open:
            return
        self.page.text += data.replace("\u00a0", " ")
        if "h2" in self.open:
            self.page.headings[-1] += data
        if "td" in self.open or "th" in self.open:
            self.page.rows[-1][-1] += data


def read_page(html: str) -> Page:
    """Return what a page holds; a tag left open or closed out of order fails the test."""
    reader = _Reader()
    reader.feed(html)
    reader.close()
    assert not reader.open, f"never closed: {reader.open}"
    return reader.page
