"""Blocks of a report as markup, by their type."""

from collections.abc import Iterator, Sequence
from functools import singledispatch
from itertools import groupby
from typing import Final

from catseye.app.render.cells import cell_text, is_numeric
from catseye.app.render.labels import Label, Labels
from catseye.app.render.markup import Html, bullets, element, join, paragraphs, unbroken
from catseye.app.render.markup import section as html_section
from catseye.app.render.markup import table as html_table
from catseye.app.render.signs import SIGNS
from catseye.app.results.figures import Figure
from catseye.app.results.model import Block, Bullets, Entries, Listing, Paragraph, Section, Statement, Table

_LONG: Final = 10
"""A table of more rows may go on on the next printed page."""

_WIDE: Final = 4
"""A table of more columns is wider than a telephone."""


@singledispatch
def html_of(block: Block, _labels: Labels) -> Html:
    """Return a block as markup."""
    raise TypeError(type(block).__name__)


@html_of.register
def _(block: Statement, labels: Labels) -> Html:
    sign = element("span", SIGNS[block.sign].glyph, class_="sign")
    text = element("span", unbroken(block.text), _links(labels.find(block.see)))
    return element("li", sign, text, class_=block.sign)


def _links(labels: Sequence[Label]) -> Html:
    links = [element("a", label.text, href=f"#{label.anchor}") for label in labels]
    return join([" (", Html(", ".join(links)), ")"]) if links else Html()


@html_of.register
def _(block: Table, labels: Labels) -> Html:
    head = [f"{column.title} / {column.unit}" if column.unit else column.title for column in block.columns]
    rows = [
        [cell_text(cell, column) for cell, column in zip(row, block.columns, strict=True)]
        for row in block.rows
    ]
    label = labels.next()
    table = html_table(
        head, rows, [is_numeric(column) for column in block.columns], labelled_by=f"{label.anchor}-caption"
    )
    caption = element("p", *_caption(label, block.caption), class_="caption", id_=f"{label.anchor}-caption")
    kinds = [("table", True), ("long", len(rows) > _LONG), ("wide", len(head) > _WIDE)]
    classes = " ".join(name for name, applies in kinds if applies)
    return element("div", caption, _scrolling(table, label), class_=classes, id_=label.anchor)


def _caption(label: Label, text: str) -> tuple[Html, str]:
    return element("b", f"{label.text}."), f" {text}"


def _scrolling(inner: Html, label: Label) -> Html:
    """Return what scrolls by itself on a narrow screen, by keys too."""
    return element("div", inner, class_="scroll", tabindex="0", role="region", aria_label=label.text)


def picture_html(block: Figure) -> Html:
    """Return the drawing of a figure; a third of a second."""
    # Imported by whoever draws: a page is often put together where others draw its figures.
    from catseye.app.render.canvas import svg
    from catseye.app.render.mpl import drawn

    return Html(svg(drawn(block), block.key, block.label))


def _figure(block: Figure, picture: Html, labels: Labels) -> Html:
    label = labels.next()
    caption = element("figcaption", *_caption(label, block.caption))
    return element("figure", _scrolling(picture, label), caption, id_=label.anchor)


@html_of.register
def _(block: Paragraph, _labels: Labels) -> Html:
    return paragraphs(block.text)


@html_of.register
def _(block: Bullets, _labels: Labels) -> Html:
    return join([element("h3", block.title) if block.title else "", bullets(block.texts)])


@html_of.register
def _(block: Listing, _labels: Labels) -> Html:
    lines = (element("span", text, class_=kind) if kind else join([text]) for text, kind in block.lines)
    return element("pre", Html("\n".join(lines)))


@html_of.register
def _(block: Entries, _labels: Labels) -> Html:
    pairs = ((element("dt", label), element("dd", text)) for label, text in block.entries)
    return element("dl", *(part for pair in pairs for part in pair))


def section_html(section: Section, pictures: Iterator[Html], labels: Labels) -> Html:
    """Return a section, empty without blocks; neighbouring statements share a list.

    Args:
        pictures: drawn figures of this section and those behind it.
        labels: of their figures and tables.
    """
    parts: list[Html] = []
    for listed, blocks in groupby(section.blocks, key=lambda block: isinstance(block, Statement)):
        inner = [
            _figure(block, next(pictures), labels) if isinstance(block, Figure) else html_of(block, labels)
            for block in blocks
        ]
        parts.append(element("ul", *inner, class_="verdict") if listed else join(inner))
    return html_section(section.key, section.title, *parts)
