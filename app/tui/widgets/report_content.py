"""Parts of a report as content of widgets."""

from collections.abc import Iterable

from textual.content import Content

from catseye.app.render.signs import SIGNS
from catseye.app.render.text import block_lines
from catseye.app.results.model import Block, Section, Sign, Statement
from catseye.app.tui.widgets.static_text import lines


def sign_content(sign: Sign) -> Content:
    """Return a sign, one cell wide, in its colour."""
    look = SIGNS[sign]
    return Content.assemble((look.glyph, f"${look.theme}" if look.theme else ""))


def statement_content(statement: Statement) -> Content:
    """Return a statement behind its sign."""
    return Content.assemble(sign_content(statement.sign), " ", statement.text)


def section_content(section: Section) -> Content:
    """Return what stands in a section, a line each."""
    return blocks_content(section.blocks)


def blocks_content(blocks: Iterable[Block]) -> Content:
    """Return blocks as content, a line each."""
    return lines(*(line for block in blocks for line in _block_content(block)))


def _block_content(block: Block) -> list[Content]:
    if isinstance(block, Statement):
        return [statement_content(block)]
    return [Content(line) for line in block_lines(block)]
