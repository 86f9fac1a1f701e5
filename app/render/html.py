"""Blocks of a report as markup, by their type."""

from collections.abc import Iterator
from functools import singledispatch
from itertools import groupby

from catseye.app.render.cells import cell_text, is_numeric
from catseye.app.render.markup import Html, bullets, element, join, paragraphs, unbroken
from catseye.app.render.markup import section as html_section
from catseye.app.render.markup import table as html_table
from catseye.app.render.signs import SIGNS
from catseye.app.results.figures import Figure
from catseye.app.results.model import Block, Bullets, Entries, Listing, Paragraph, Section, Statement, Table


@singledispatch
def html_of(block: Block) -> Html:
    """Return a block as markup."""
    raise TypeError(type(block).__name__)


@html_of.register
def _(block: Statement) -> Html:
    sign = element("span", SIGNS[block.sign].glyph, class_="sign")
    return element("li", sign, element("span", unbroken(block.text)), class_=block.sign)


@html_of.register
def _(block: Table) -> Html:
    head = [f"{column.title} / {column.unit}" if column.unit else column.title for column in block.columns]
    rows = [
        [cell_text(cell, column) for cell, column in zip(row, block.columns, strict=True)]
        for row in block.rows
    ]
    return html_table(block.caption, head, rows, [is_numeric(column) for column in block.columns])


@html_of.register
def figure_html(block: Figure) -> Html:
    """Return a figure, drawn; a third of a second."""
    # Imported by whoever draws: a page is often put together where others draw its figures.
    from catseye.app.render.canvas import svg
    from catseye.app.render.mpl import drawn

    picture = element("div", Html(svg(drawn(block), block.key, block.label)), class_="scroll")
    return element("figure", picture, element("figcaption", block.caption), id_=f"figure-{block.key}")


@html_of.register
def _(block: Paragraph) -> Html:
    return paragraphs(block.text)


@html_of.register
def _(block: Bullets) -> Html:
    return join([element("h3", block.title) if block.title else "", bullets(block.texts)])


@html_of.register
def _(block: Listing) -> Html:
    lines = (element("span", text, class_=kind) if kind else join([text]) for text, kind in block.lines)
    return element("pre", Html("\n".join(lines)))


@html_of.register
def _(block: Entries) -> Html:
    pairs = ((element("dt", label), element("dd", text)) for label, text in block.entries)
    return element("dl", *(part for pair in pairs for part in pair))


def section_html(section: Section, figures: Iterator[Html]) -> Html:
    """Return a section, empty without blocks; neighbouring statements share a list.

    Args:
        figures: of this section and those behind it, drawn.
    """
    parts: list[Html] = []
    for listed, blocks in groupby(section.blocks, key=lambda block: isinstance(block, Statement)):
        inner = [next(figures) if isinstance(block, Figure) else html_of(block) for block in blocks]
        parts.append(element("ul", *inner, class_="verdict") if listed else join(inner))
    return html_section(section.key, section.title, *parts)
